//! Export of contact forces: a table, or the lines of force chains.

use super::vtp::{DataArray, Piece, write_pieces};
use crate::{FileError, Manifest, atomic_file};
use domain::Vector;
use simulation::{ContactForce, ContactForces};
use std::io::{BufWriter, Result, Write};
use std::path::Path;

/// Output format of contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactFormat {
    /// A CSV table with a row for each contact of each step.
    Csv,
    /// `PolyData` of VTK with a line from centre to centre for each contact, one file per step, and a
    /// `.pvd` file that lists them.
    Vtp,
}

impl ContactFormat {
    /// Extension of the file name; for VTP that of the list.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Vtp => "pvd",
        }
    }
}

const HEAD: &str = "step,time,first,second,x,y,z,dx,dy,dz,normal_force,tangential_force_x,tangential_force_y,\
                    tangential_force_z,state";

/// Writes the contacts of some steps to a file, which is entered in the manifest if it is in the manifest's folder.
/// The file appears under its name when it is complete.
pub fn export_contacts(
    steps: &mut dyn Iterator<Item = ContactForces>,
    format: ContactFormat,
    path: &Path,
    run: &Manifest,
) -> std::result::Result<(), FileError> {
    if path.exists() && !path.is_file() {
        return Err(FileError::write(path, &"it is no file"));
    }
    run.enter(path)?;
    match format {
        ContactFormat::Csv => atomic_file::write_with(path, |file, _| table(&mut BufWriter::new(file), steps)),
        ContactFormat::Vtp => write_pieces(path, run, &mut steps.map(|contacts| lines(&contacts))),
    }
}

fn table(out: &mut impl Write, steps: &mut dyn Iterator<Item = ContactForces>) -> Result<()> {
    writeln!(out, "{HEAD}")?;
    for ContactForces { step, time, list, .. } in steps {
        for ContactForce { ids: [first, second], position: place, separation, normal, tangential, state } in list {
            write!(out, "{step},{time:?},{first},{second}")?;
            let numbers = [place.to_array(), separation.to_array(), [normal, tangential.x, tangential.y]];
            numbers.as_flattened().iter().try_for_each(|number| write!(out, ",{number:?}"))?;
            writeln!(out, ",{:?},{}", tangential.z, state.name())?;
        }
    }
    out.flush()
}

/// Lines with two separate points each, which both have the normal force: tubes take their radii from points.
fn lines(contacts: &ContactForces) -> Piece {
    let list = &contacts.list;
    let (count, points) = (list.len() as i64, 2 * list.len() as i64);
    let ends: Vec<Vector> = list.iter().flat_map(|c| [c.position, c.position + c.separation]).collect();
    let of_each = |of_one: &dyn Fn(&ContactForce) -> f64| list.iter().map(of_one).collect::<Vec<_>>();
    let normal = of_each(&|contact| contact.normal);
    let of_ends: Vec<f64> = normal.iter().flat_map(|&force| [force; 2]).collect();
    let tangential: Vec<Vector> = list.iter().map(|contact| contact.tangential).collect();
    let id = |k: usize| DataArray::integers(["first", "second"][k], list.iter().map(move |c| c.ids[k] as i64));
    let data = vec![
        id(0),
        id(1),
        DataArray::reals("normal_force", 1, &normal),
        DataArray::reals("tangential_force", 3, bytemuck::cast_slice(&tangential)),
        DataArray::integers("state", list.iter().map(|contact| i64::from(contact.state.number()))),
    ];
    let connected = vec![
        DataArray::integers("connectivity", 0..points),
        DataArray::integers("offsets", (1..=count).map(|k| 2 * k)),
    ];
    Piece {
        step: contacts.step,
        time: contacts.time,
        lattice: contacts.lattice,
        counts: format!("NumberOfPoints=\"{points}\" NumberOfLines=\"{count}\""),
        groups: vec![
            ("Points", vec![DataArray::reals("Points", 3, bytemuck::cast_slice(&ends))]),
            ("PointData", vec![DataArray::reals("normal_force", 1, &of_ends)]),
            ("CellData", data),
            ("Lines", connected),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use simulation::ContactState;

    fn contacts(step: u64) -> ContactForces {
        let one = ContactForce {
            ids: [3, 8],
            position: Vector::new(0.1, 2.0, 3.0),
            separation: Vector::new(2.0, 0.0, -0.5),
            normal: 1.0 / 3.0,
            tangential: Vector::new(0.0, 0.25, 1e-9),
            state: ContactState::Sliding,
        };
        let lattice = [Vector::X * 9.0, Vector::Y * 8.0, Vector::Z * 7.0];
        ContactForces { step, time: 0.5 * step as f64, lattice, list: vec![one; step as usize] }
    }

    fn exported(format: ContactFormat) -> (tempfile::TempDir, String) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("contacts").with_extension(format.extension());
        let none = Manifest::none(folder.path());
        export_contacts(&mut (0..3).map(contacts), format, &path, &none).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        (folder, text)
    }

    #[test]
    fn a_table_has_a_row_for_each_contact_of_each_step() {
        let (_folder, text) = exported(ContactFormat::Csv);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!((lines.len(), lines[0]), (4, HEAD));
        assert_eq!(lines[1], "1,0.5,3,8,0.1,2.0,3.0,2.0,0.0,-0.5,0.3333333333333333,0.0,0.25,1e-9,sliding");
        assert_eq!(lines[0].split(',').count(), lines[1].split(',').count());
    }

    #[test]
    fn lines_go_from_centre_to_centre() {
        let (folder, list) = exported(ContactFormat::Vtp);
        assert!(list.contains("<DataSet timestep=\"1.0\" part=\"0\" file=\"contacts/2.vtp\"/>"), "{list}");
        let piece = std::fs::read(folder.path().join("contacts/1.vtp")).unwrap();
        let start = piece.windows(2).position(|bytes| bytes == b"\n_").unwrap() + 2;
        let header = String::from_utf8_lossy(&piece[..start]);
        assert!(header.contains("<Piece NumberOfPoints=\"2\" NumberOfLines=\"1\">"), "{header}");
        let ends: Vec<f64> =
            piece[start + 8..start + 56].chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
        assert_eq!(ends, [0.1, 2.0, 3.0, 2.1, 2.0, 2.5]);
        let empty = std::fs::read(folder.path().join("contacts/0.vtp")).unwrap();
        assert!(String::from_utf8_lossy(&empty).contains("NumberOfLines=\"0\""), "a step without contacts");
    }
}
