//! `PolyData` of VTK in XML, a file for each frame: `NAME/STEP.vtp` beside the list `NAME.pvd`.

use crate::trajectory_reader::Snapshot;
use crate::{FileError, atomic_file};
use simulation::Frame;
use std::fmt::Write as _;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

pub(super) fn write(list: &Path, frames: &mut dyn Iterator<Item = Snapshot>) -> std::result::Result<(), FileError> {
    if list.extension().is_none_or(|extension| extension != "pvd") {
        return Err(FileError::write(list, &"the name of a list of VTP files needs to end in .pvd"));
    }
    let folder = list.with_extension("");
    std::fs::create_dir_all(&folder).map_err(|e| FileError::write(&folder, &e))?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut entries = String::new();
    for snapshot in frames {
        let file = format!("{}.vtp", snapshot.step);
        atomic_file::put(&folder.join(&file), |out, _| piece(&mut BufWriter::new(out), &snapshot))?;
        let (time, path) = (snapshot.time, escaped(&format!("{name}/{file}")));
        writeln!(entries, "    <DataSet timestep=\"{time:?}\" part=\"0\" file=\"{path}\"/>").expect("text grows");
    }
    let start = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    atomic_file::replace(list, format!("{start}{entries}  </Collection>\n</VTKFile>\n").as_bytes())
}

/// A text as the value of an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// An array of the file: name, VTK's type, numbers a point, and its bytes.
struct Array {
    name: String,
    kind: &'static str,
    width: usize,
    bytes: Vec<u8>,
}

impl Array {
    fn reals(name: &str, width: usize, values: &[f64]) -> Self {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { name: name.to_owned(), kind: "Float64", width, bytes }
    }

    fn integers(name: &str, values: impl Iterator<Item = i64>) -> Self {
        Self { name: name.to_owned(), kind: "Int64", width: 1, bytes: values.flat_map(i64::to_le_bytes).collect() }
    }
}

/// A frame, in which each particle is a point and a vertex. All arrays stand at the end of the file as they are in
/// memory, each after its number of bytes.
fn piece(out: &mut impl Write, snapshot: &Snapshot) -> Result<()> {
    let (points, data, vertices) = arrays(&snapshot.frame);
    let count = snapshot.frame.particles.len();
    let mut place = 0;
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>"
    )?;
    field_data(out, snapshot)?;
    writeln!(out, "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\">")?;
    for (group, arrays) in [("Points", &points), ("PointData", &data), ("Verts", &vertices)] {
        writeln!(out, "<{group}>")?;
        arrays.iter().try_for_each(|array| declare(out, array, &mut place))?;
        writeln!(out, "</{group}>")?;
    }
    write!(out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    for Array { bytes, .. } in points.iter().chain(&data).chain(&vertices) {
        out.write_all(&(bytes.len() as u64).to_le_bytes())?;
        out.write_all(bytes)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")?;
    out.flush()
}

/// Points, what they have, and vertices.
fn arrays(Frame { particles, .. }: &Frame) -> (Vec<Array>, Vec<Array>, Vec<Array>) {
    let count = particles.len() as i64;
    let points = vec![Array::reals("Points", 3, bytemuck::cast_slice(&particles.positions))];
    let mut data = vec![
        Array::integers("id", particles.ids.iter().map(|&id| id as i64)),
        Array::integers("species", particles.species.iter().map(|&species| i64::from(species))),
        Array::reals("radius", 1, &particles.radii),
    ];
    data.extend(particles.columns.iter().map(|column| Array::reals(&column.name, column.width, &column.values)));
    (points, data, vec![Array::integers("connectivity", 0..count), Array::integers("offsets", 1..=count)])
}

/// The time, and the lattice vectors of the box.
fn field_data(out: &mut impl Write, Snapshot { time, frame, .. }: &Snapshot) -> Result<()> {
    let [a, b, c] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| frame.cell.lattice(steps));
    let ascii = "format=\"ascii\"";
    writeln!(out, "<FieldData>")?;
    writeln!(out, "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" {ascii}>{time:?}</DataArray>")?;
    write!(out, "<DataArray type=\"Float64\" Name=\"lattice\" NumberOfComponents=\"3\" NumberOfTuples=\"3\" {ascii}>")?;
    [a, b, c].iter().try_for_each(|v| write!(out, "{:?} {:?} {:?} ", v.x, v.y, v.z))?;
    writeln!(out, "</DataArray>\n</FieldData>")
}

fn declare(out: &mut impl Write, Array { name, kind, width, bytes }: &Array, place: &mut usize) -> Result<()> {
    let what = format!("type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\"");
    writeln!(out, "<DataArray {what} format=\"appended\" offset=\"{place}\"/>")?;
    *place += 8 + bytes.len();
    Ok(())
}
