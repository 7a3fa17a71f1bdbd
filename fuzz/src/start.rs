//! Files of all formats with known positions of spheres.

use hdf5::types::VarLenUnicode;
use hdf5::{File, H5Type};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

/// Edges of the box.
pub const EDGE: f64 = 10.0;
/// Radii of the two species, the second of which has one sphere.
pub const RADII: [f64; 2] = [1.0, 1.5];

/// Spheres, and the style in which they are written.
#[derive(Debug, Clone)]
pub struct WrittenSpheres {
    /// Positions, far enough apart.
    pub positions: Vec<[f64; 3]>,
    /// Index of the sphere of the second species.
    pub large: usize,
    /// Number of frames before the wanted one.
    pub before: usize,
    /// Whether the file's box is twice as large as that of the scene.
    pub other_box: bool,
    /// Optional styles: a byte order mark, capitals, quotes, decimal commas.
    pub style: [bool; 4],
}

/// Any start of four to six spheres.
pub fn any_start() -> impl Strategy<Value = WrittenSpheres> {
    let places = (4..=6usize).prop_flat_map(|count| prop::collection::vec(prop::array::uniform3(-0.2..0.2), count));
    let rest = (0..4usize, 0..3usize, prop::bool::weighted(0.2), any::<[bool; 4]>());
    (places, rest).prop_map(|(shifts, (large, before, other_box, style))| {
        let site = |n: usize| [2.0 + 3.0 * (n % 2) as f64, 2.0 + 3.0 * (n / 2 % 2) as f64, 2.0 + 3.0 * (n / 4) as f64];
        let place = |(n, shift): (usize, &[f64; 3])| std::array::from_fn(|axis| site(n)[axis] + shift[axis]);
        let positions = shifts.iter().enumerate().map(place).map(|p: [f64; 3]| p.map(rounded)).collect();
        WrittenSpheres { positions, large, before, other_box, style }
    })
}

fn rounded(number: f64) -> f64 {
    (number * 1e6).round() / 1e6
}

impl WrittenSpheres {
    fn species(&self, sphere: usize) -> usize {
        usize::from(sphere == self.large)
    }

    fn edge(&self) -> f64 {
        if self.other_box { 2.0 * EDGE } else { EDGE }
    }

    /// All frames; the positions of earlier frames are shifted.
    fn frames(&self) -> Vec<Vec<[f64; 3]>> {
        let shifted = |by: usize| self.positions.iter().map(|p| [p[0] + 0.3 * by as f64, p[1], p[2]]).collect();
        (0..=self.before).rev().map(shifted).collect()
    }

    /// The last frame as a table.
    pub fn csv(&self) -> String {
        let [mark, capitals, quotes, commas] = self.style;
        let separator = if commas { ";" } else { "," };
        let name = |name: &str| if capitals { name.to_uppercase() } else { name.to_owned() };
        let names = ["x", "y", "z", "species"].map(name).map(|name| if quotes { format!("\"{name}\"") } else { name });
        let mut text = if mark { "\u{feff}".to_owned() } else { String::new() };
        text += &(names.join(separator) + "\n");
        for (n, position) in self.positions.iter().enumerate() {
            let cells = position.map(|number| format!("{number:.6}").replace('.', if commas { "," } else { "." }));
            let _ = writeln!(text, "{}{separator}{}", cells.join(separator), ["a", "b"][self.species(n)]);
        }
        text
    }

    /// The frames in extended XYZ.
    pub fn xyz(&self) -> String {
        let (mut text, edge) = (String::new(), self.edge());
        for frame in self.frames() {
            let _ = writeln!(text, "{}", frame.len());
            let _ =
                writeln!(text, "Lattice=\"{edge} 0 0 0 {edge} 0 0 0 {edge}\" Properties=id:I:1:species:S:1:pos:R:3");
            for (n, [x, y, z]) in frame.iter().enumerate().rev() {
                let _ = writeln!(text, "{} {} {x:.6} {y:.6} {z:.6}", n + 1, ["a", "b"][self.species(n)]);
            }
        }
        text
    }

    /// The frames as a LAMMPS dump.
    pub fn dump(&self) -> String {
        let (mut text, edge) = (String::new(), self.edge());
        for (number, frame) in self.frames().iter().enumerate() {
            let _ = writeln!(text, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}", 10 * number, frame.len());
            let _ = writeln!(text, "ITEM: BOX BOUNDS pp pp pp\n0.0 {edge}\n0.0 {edge}\n0.0 {edge}");
            let _ = writeln!(text, "ITEM: ATOMS type id z y x");
            for (n, [x, y, z]) in frame.iter().enumerate().rev() {
                let _ = writeln!(text, "{} {} {z:.6} {y:.6} {x:.6}", self.species(n) + 1, n + 1);
            }
        }
        text
    }

    /// The frames in H5MD, with a list of steps or with a fixed step.
    pub fn h5md(&self, path: &Path) -> hdf5::Result<()> {
        let file = File::create(path)?;
        let group = file.create_group("particles")?.create_group("all")?;
        let (frames, count) = (self.frames(), self.positions.len());
        let shape = vec![frames.len(), count, 3];
        let position = group.create_group("position")?;
        write(&position, "value", &shape, frames.into_iter().flatten().flatten().collect())?;
        if self.style[0] {
            position.new_dataset::<i64>().create("step")?.write_scalar(&5)?;
        } else {
            write(&position, "step", &[shape[0]], (0..shape[0] as i64).map(|number| 10 * number).collect())?;
        }
        write(&group, "species", &[count], (0..count).map(|n| self.species(n) as i64).collect())?;
        write(&group.create_group("box")?, "edges", &[3], vec![self.edge(); 3])
    }

    /// Datasets of a case, with the positions in the given shape.
    pub fn datasets(&self, path: &Path, shape: PositionsShape) -> hdf5::Result<()> {
        let (file, count) = (File::create(path)?, self.positions.len());
        let rows = self.positions.iter();
        let (dimensions, numbers): (Vec<usize>, Vec<f64>) = match shape {
            PositionsShape::Rows => (vec![count, 3], rows.flatten().copied().collect()),
            PositionsShape::Columns => {
                (vec![3, count], (0..3).flat_map(|axis| rows.clone().map(move |p| p[axis])).collect())
            }
            PositionsShape::Four => (vec![count, 4], rows.flat_map(|p| [p[0], p[1], p[2], 0.0]).collect()),
            PositionsShape::Two => (vec![count, 2], rows.flat_map(|p| [p[0], p[1]]).collect()),
            PositionsShape::Flat => (vec![3 * count], rows.flatten().copied().collect()),
            PositionsShape::Deep => (vec![1, count, 3], rows.flatten().copied().collect()),
        };
        write(&file, "positions", &dimensions, numbers)?;
        let names: Vec<VarLenUnicode> = (0..count).filter_map(|n| ["a", "b"][self.species(n)].parse().ok()).collect();
        write(&file, "species", &[count], names)
    }

    /// Difference between the start and the first frame of a trajectory, for any order of its spheres.
    pub fn differs(&self, trajectory: &Path) -> hdf5::Result<Option<String>> {
        let group = File::open(trajectory)?.group("particles/all")?;
        let count = self.positions.len();
        let radii = group.dataset("radius")?.read_raw::<f64>()?;
        let positions = group.dataset("position/value")?.read_raw::<f64>()?;
        if radii.len() != count || positions.len() < 3 * count {
            return Ok(Some(format!("{} spheres became {}", count, radii.len())));
        }
        let is_here = |n: usize, row: usize| {
            let periodic = |axis: usize| {
                let distance = positions[3 * row + axis] - self.positions[n][axis];
                (distance - EDGE * (distance / EDGE).round()).abs() < 2e-6
            };
            (0..3).all(periodic) && (radii[row] - RADII[self.species(n)]).abs() < 1e-9
        };
        let lost = (0..count).find(|&n| !(0..count).any(|row| is_here(n, row)));
        Ok(lost.map(|n| format!("sphere {n} at {:?} is nowhere in the first frame", self.positions[n])))
    }
}

/// Shapes of a dataset of positions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionsShape {
    /// (N, 3).
    Rows,
    /// (3, N).
    Columns,
    /// (N, 4).
    Four,
    /// (N, 2).
    Two,
    /// (3 N).
    Flat,
    /// (1, N, 3).
    Deep,
}

fn write<T: H5Type>(group: &hdf5::Group, name: &str, shape: &[usize], numbers: Vec<T>) -> hdf5::Result<()> {
    let values =
        ndarray::ArrayD::from_shape_vec(shape.to_vec(), numbers).map_err(|e| hdf5::Error::from(e.to_string()))?;
    group.new_dataset_builder().with_data(&values).create(name).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    fn start() -> WrittenSpheres {
        any_start().new_tree(&mut TestRunner::deterministic()).unwrap().current()
    }

    /// Difference that is found in a trajectory of one frame with these positions.
    fn found(start: &WrittenSpheres, positions: &[[f64; 3]], swapped: bool) -> Option<String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        let group = file.create_group("particles").unwrap().create_group("all").unwrap();
        let radius = |n: usize| RADII[start.species(n) ^ usize::from(swapped)];
        write(&group, "radius", &[positions.len()], (0..positions.len()).map(radius).collect()).unwrap();
        let numbers = positions.iter().flatten().copied().collect();
        let position = group.create_group("position").unwrap();
        write(&position, "value", &[1, positions.len(), 3], numbers).unwrap();
        file.close().unwrap();
        start.differs(&path).unwrap()
    }

    #[test]
    fn spheres_that_move_or_change_are_found() {
        let start = start();
        assert_eq!(found(&start, &start.positions, false), None);
        let image: Vec<[f64; 3]> = start.positions.iter().map(|p| [p[0] - EDGE, p[1], p[2] + EDGE]).collect();
        assert_eq!(found(&start, &image, false), None);
        assert!(found(&start, &start.positions, true).unwrap().contains("nowhere"));
        let mut moved = start.positions.clone();
        moved[1][2] += 1e-3;
        assert!(found(&start, &moved, false).unwrap().contains("sphere 1"));
        assert!(found(&start, &start.positions[1..], false).unwrap().contains("became"));
    }

    #[test]
    fn the_last_frame_is_the_one_that_is_meant() {
        let start = WrittenSpheres { before: 2, ..start() };
        let frames = start.frames();
        assert_eq!((frames.len(), frames.last()), (3, Some(&start.positions)));
        assert!(start.xyz().lines().filter(|line| line.contains("Lattice")).count() == 3);
        assert!(start.dump().matches("ITEM: ATOMS").count() == 3);
    }
}
