//! `PolyData` of VTK in XML, one file per frame: `NAME/STEP.vtp` and the list `NAME.pvd`.

use crate::trajectory_reader::TimedFrame;
use crate::{FileError, Manifest, atomic_file};
use domain::{Column, Quaternion, Vector};
use simulation::Frame;
use std::fmt::Write as _;
use std::io::{BufWriter, Result, Write};
use std::path::Path;

pub(super) fn write(
    list: (&Path, &Manifest),
    frames: &mut dyn Iterator<Item = TimedFrame>,
) -> std::result::Result<(), FileError> {
    write_pieces(list.0, list.1, &mut frames.map(|snapshot| Piece::of_frame(&snapshot)))
}

/// Writes each piece to a separate file, and the list of the files.
pub(super) fn write_pieces(
    list: &Path,
    run: &Manifest,
    pieces: &mut dyn Iterator<Item = Piece>,
) -> std::result::Result<(), FileError> {
    if list.extension().is_none_or(|extension| extension != "pvd") {
        return Err(FileError::write(list, &"the name of a list of VTP files needs to end in .pvd"));
    }
    let folder = list.with_extension("");
    run.make_folder(&folder)?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut entries = String::new();
    for piece in pieces {
        let file = format!("{}.vtp", piece.step);
        let path = folder.join(&file);
        run.enter(&path)?;
        atomic_file::write_with(&path, |out, _| piece.write(&mut BufWriter::new(out)))?;
        let (time, path) = (piece.time, escaped(&format!("{name}/{file}")));
        writeln!(entries, "    <DataSet timestep=\"{time:?}\" part=\"0\" file=\"{path}\"/>").expect("text grows");
    }
    let start = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
    atomic_file::replace(list, format!("{start}{entries}  </Collection>\n</VTKFile>\n").as_bytes())
}

/// Escapes a text for the value of an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

/// An array of the file: name, VTK type, numbers per point, and bytes.
pub(super) struct DataArray {
    name: String,
    kind: &'static str,
    width: usize,
    bytes: Vec<u8>,
}

impl DataArray {
    pub(super) fn reals(name: &str, width: usize, values: &[f64]) -> Self {
        let bytes = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        Self { name: name.to_owned(), kind: "Float64", width, bytes }
    }

    pub(super) fn integers(name: &str, values: impl Iterator<Item = i64>) -> Self {
        Self { name: name.to_owned(), kind: "Int64", width: 1, bytes: values.flat_map(i64::to_le_bytes).collect() }
    }

    fn declare(&self, out: &mut impl Write, place: &mut usize) -> Result<()> {
        let Self { name, kind, width, bytes } = self;
        let what = format!("type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{width}\"");
        writeln!(out, "<DataArray {what} format=\"appended\" offset=\"{place}\"/>")?;
        *place += 8 + bytes.len();
        Ok(())
    }
}

/// The axes of spheres with orientations, as vectors for glyphs; zero for those without.
fn axes(orientations: &Column) -> DataArray {
    let axes: Vec<Vector> = bytemuck::cast_slice(&orientations.values).iter().map(|q: &Quaternion| q.axis()).collect();
    DataArray::reals("axis", 3, bytemuck::cast_slice(&axes))
}

/// Content of a file: points, and vertices or lines.
pub(super) struct Piece {
    pub(super) step: u64,
    pub(super) time: f64,
    pub(super) lattice: [Vector; 3],
    /// Numbers of points and of vertices or lines, as attributes of the piece.
    pub(super) counts: String,
    /// Elements of the piece and their arrays.
    pub(super) groups: Vec<(&'static str, Vec<DataArray>)>,
}

impl Piece {
    /// A frame, in which each particle is a point and a vertex.
    fn of_frame(TimedFrame { step, time, frame: Frame { particles, cell, .. } }: &TimedFrame) -> Self {
        let count = particles.len() as i64;
        let points = vec![DataArray::reals("Points", 3, bytemuck::cast_slice(&particles.positions))];
        let mut data = vec![
            DataArray::integers("id", particles.ids.iter().map(|&id| id as i64)),
            DataArray::integers("species", particles.species.iter().map(|&species| i64::from(species))),
            DataArray::reals("radius", 1, &particles.radii),
        ];
        data.extend(
            particles.columns.iter().map(|column| DataArray::reals(&column.name, column.width, &column.values)),
        );
        data.extend(particles.columns.iter().filter(|column| column.name == "orientation").map(axes));
        let vertices = vec![DataArray::integers("connectivity", 0..count), DataArray::integers("offsets", 1..=count)];
        Self {
            step: *step,
            time: *time,
            lattice: cell.lattice_vectors(),
            counts: format!("NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\""),
            groups: vec![("Points", points), ("PointData", data), ("Verts", vertices)],
        }
    }

    /// Appends all arrays as raw data at the end of the file, each after its number of bytes.
    fn write(&self, out: &mut impl Write) -> Result<()> {
        let mut place = 0;
        writeln!(out, "<?xml version=\"1.0\"?>")?;
        writeln!(
            out,
            "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>"
        )?;
        self.write_field_data(out)?;
        writeln!(out, "<Piece {}>", self.counts)?;
        for (group, arrays) in &self.groups {
            writeln!(out, "<{group}>")?;
            arrays.iter().try_for_each(|array| array.declare(out, &mut place))?;
            writeln!(out, "</{group}>")?;
        }
        write!(out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
        for DataArray { bytes, .. } in self.groups.iter().flat_map(|(_, arrays)| arrays) {
            out.write_all(&(bytes.len() as u64).to_le_bytes())?;
            out.write_all(bytes)?;
        }
        writeln!(out, "\n</AppendedData>\n</VTKFile>")?;
        out.flush()
    }

    /// Writes the time and the lattice vectors of the box.
    fn write_field_data(&self, out: &mut impl Write) -> Result<()> {
        let (ascii, time) = ("format=\"ascii\"", self.time);
        writeln!(out, "<FieldData>")?;
        writeln!(
            out,
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" {ascii}>{time:?}</DataArray>"
        )?;
        write!(
            out,
            "<DataArray type=\"Float64\" Name=\"lattice\" NumberOfComponents=\"3\" NumberOfTuples=\"3\" {ascii}>"
        )?;
        self.lattice.iter().try_for_each(|v| write!(out, "{:?} {:?} {:?} ", v.x, v.y, v.z))?;
        writeln!(out, "</DataArray>\n</FieldData>")
    }
}
