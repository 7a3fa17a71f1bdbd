//! Velocity fields on the grid, and the XDMF file by which `ParaView` opens them.

use crate::{FileError, Provenance, checksum, durable, text, whole};
use domain::{PeriodicBox, Vector};
use hdf5::File;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The velocity on a grid at one time.
#[derive(Debug)]
pub struct VelocityField<'a> {
    /// Steps taken.
    pub step: u64,
    /// The time.
    pub time: f64,
    /// The box.
    pub cell: PeriodicBox,
    /// Grid points along x, y and z.
    pub points: [usize; 3],
    /// Velocities in the order `[z][y][x]`, x fastest.
    pub values: &'a [Vector],
    /// What kind of velocity it is, in words.
    pub note: &'a str,
}

impl VelocityField<'_> {
    /// Writes the field to `fields/` in a folder, and makes `fields.xdmf` there name it with those of the steps before.
    pub fn write(&self, folder: &Path, provenance: &Provenance) -> Result<(), FileError> {
        let fields = folder.join("fields");
        std::fs::create_dir_all(&fields).map_err(|e| FileError::write(&fields, &e))?;
        let path = fields.join(format!("velocity-{:010}.h5", self.step));
        whole::write(&path, |file| self.fill(file, provenance))?;
        index_fields(folder)
    }

    fn fill(&self, file: &File, provenance: &Provenance) -> hdf5::Result<()> {
        provenance.write(file)?;
        let [nx, ny, nz] = self.points;
        let dataset = file.new_dataset::<f64>().shape((nz, ny, nx, 3)).create("velocity")?;
        dataset.write_raw(bytemuck::cast_slice::<_, f64>(self.values))?;
        checksum::attach(&dataset, checksum::of(self.values))?;
        text::write_attribute(&dataset, "unit", "length/time")?;
        text::write_attribute(&dataset, "note", self.note)?;
        let root = file.as_group()?;
        root.new_attr::<u64>().create("step")?.write_scalar(&self.step)?;
        root.new_attr::<f64>().create("time")?.write_scalar(&self.time)?;
        root.new_attr::<f64>().create("strain")?.write_scalar(&self.cell.strain())?;
        let edges = ndarray::arr1(&self.cell.edges().to_array());
        root.new_attr::<f64>().shape(3).create("edges")?.write(&edges)?;
        if self.cell.strain() != 0.0 {
            let places: Vec<f64> = self.places().flat_map(|place| place.to_array()).collect();
            let dataset = file.new_dataset::<f64>().shape((nz, ny, nx, 3)).create("position")?;
            dataset.write_raw(&places)?;
            checksum::attach(&dataset, checksum::of(&places))?;
        }
        Ok(())
    }

    /// Where the grid's points are, in the order of the values.
    fn places(&self) -> impl Iterator<Item = Vector> + '_ {
        let [nx, ny, nz] = self.points;
        let spacing = self.cell.edges() / Vector::new(nx as f64, ny as f64, nz as f64);
        let place = move |[x, y, z]: [usize; 3]| {
            let lattice = Vector::new(x as f64, y as f64, z as f64) * spacing;
            lattice + Vector::X * (self.cell.strain() * lattice.y)
        };
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z]))).map(place)
    }
}

/// Drops the fields of a former run after step `last`.
pub fn drop_fields_after(folder: &Path, last: u64) -> Result<(), FileError> {
    let late = format!("velocity-{last:010}.h5");
    for path in field_files(folder)? {
        if path.file_name().is_some_and(|name| *name > *late) {
            std::fs::remove_file(&path).map_err(|e| FileError::write(&path, &e))?;
        }
    }
    if folder.join("fields.xdmf").exists() { index_fields(folder) } else { Ok(()) }
}

/// The files of fields, oldest first.
fn field_files(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let fields = folder.join("fields");
    if !fields.is_dir() {
        return Ok(Vec::new());
    }
    let entries = std::fs::read_dir(&fields).map_err(|e| FileError::read(&fields, &e))?;
    let is_field = |path: &PathBuf| path.extension().is_some_and(|e| e == "h5");
    let mut files: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_field).collect();
    files.sort();
    Ok(files)
}

fn index_fields(folder: &Path) -> Result<(), FileError> {
    let mut grids = String::new();
    for path in field_files(folder)? {
        let name = format!("fields/{}", path.file_name().unwrap_or_default().to_string_lossy());
        grids += &grid(&path, &name).map_err(|e| FileError::damaged(&path, &e))?;
    }
    let xdmf = format!(
        "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n<Domain>\n<Grid Name=\"velocity\" GridType=\"Collection\" \
         CollectionType=\"Temporal\">\n{grids}</Grid>\n</Domain>\n</Xdmf>\n"
    );
    durable::replace(&folder.join("fields.xdmf"), xdmf.as_bytes())
}

/// One field in XDMF's words, which count z, y, x.
fn grid(path: &Path, name: &str) -> hdf5::Result<String> {
    let file = File::open(path)?;
    let time: f64 = file.attr("time")?.read_scalar()?;
    let strain: f64 = file.attr("strain")?.read_scalar()?;
    let edges: Vec<f64> = file.attr("edges")?.read_raw()?;
    let shape = file.dataset("velocity")?.shape();
    let counts = format!("{} {} {}", shape[0], shape[1], shape[2]);
    let item = |dataset: &str| {
        format!(
            "<DataItem Format=\"HDF\" NumberType=\"Float\" Precision=\"8\" Dimensions=\"{counts} 3\">{name}:/{dataset}</DataItem>"
        )
    };
    let mut grid = format!("<Grid Name=\"velocity\">\n<Time Value=\"{time}\"/>\n");
    let geometry = if strain == 0.0 {
        let spacing: Vec<String> = (0..3).map(|d| (edges[2 - d] / shape[d] as f64).to_string()).collect();
        let numbers = |text: &str| format!("<DataItem Format=\"XML\" Dimensions=\"3\">{text}</DataItem>");
        let geometry = numbers("0 0 0") + &numbers(&spacing.join(" "));
        format!(
            "<Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{counts}\"/>\n<Geometry GeometryType=\"ORIGIN_DXDYDZ\">{geometry}</Geometry>\n"
        )
    } else {
        let places = item("position");
        format!(
            "<Topology TopologyType=\"3DSMesh\" Dimensions=\"{counts}\"/>\n<Geometry GeometryType=\"XYZ\">{places}</Geometry>\n"
        )
    };
    grid += &geometry;
    writeln!(
        grid,
        "<Attribute Name=\"velocity\" AttributeType=\"Vector\" Center=\"Node\">{}</Attribute>",
        item("velocity")
    )
    .expect("text grows");
    Ok(grid + "</Grid>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_listed_and_late_ones_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let provenance =
            Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 };
        let values: Vec<Vector> = (0..24).map(|i| Vector::splat(f64::from(i))).collect();
        for (step, strain) in [(5, 0.0), (10, 0.2)] {
            let cell = PeriodicBox::sheared(Vector::new(4.0, 3.0, 2.0), strain).unwrap();
            let time = 0.1 * step as f64;
            let field = VelocityField { step, time, cell, points: [4, 3, 2], values: &values, note: "" };
            field.write(folder.path(), &provenance).unwrap();
        }
        let xdmf = std::fs::read_to_string(folder.path().join("fields.xdmf")).unwrap();
        assert!(
            xdmf.contains("<Time Value=\"0.5\"/>")
                && xdmf.contains("Dimensions=\"2 3 4 3\">fields/velocity-0000000005.h5:/velocity")
        );
        assert!(xdmf.contains("3DCoRectMesh") && xdmf.contains("3DSMesh"));
        let file = File::open(folder.path().join("fields/velocity-0000000010.h5")).unwrap();
        let places: ndarray::Array4<f64> = file.dataset("position").unwrap().read().unwrap();
        // The point (1, 2, 1) of the lattice: x = 1 + 0.2 * 2.
        assert!((places[[1, 2, 1, 0]] - 1.4).abs() < 1e-14 && (places[[1, 2, 1, 1]] - 2.0).abs() < 1e-14);
        drop_fields_after(folder.path(), 5).unwrap();
        let xdmf = std::fs::read_to_string(folder.path().join("fields.xdmf")).unwrap();
        assert_eq!(xdmf.matches("<Time").count(), 1);
    }
}
