//! Trajectories in the H5MD format (de Buyl, Colberg & Höfling, Comput. Phys. Commun. 185, 1546, 2014).

use crate::frames::{Damage, Element, Frames, Kind, Values};
use crate::{FileError, Provenance, checksum, text};
use domain::Particles;
use hdf5::types::FixedAscii;
use simulation::Frame;
use std::path::Path;

/// A trajectory that is being written: positions inside the box, images, and those of the columns `velocity`,
/// `angular_velocity` and `stresslet` that the particles have, all in the order of the ids. If the run is killed, the
/// file can be read up to its last complete frame.
pub struct Trajectory {
    frames: Frames,
    elements: Vec<Element>,
}

/// The columns that are written, with their units.
const COLUMNS: [(&str, &str, &str); 3] = [
    ("velocity", "particles/all/velocity", "length/time"),
    ("angular_velocity", "particles/all/angular_velocity", "1/time"),
    ("stresslet", "particles/all/stresslet", "force*length"),
];

impl Trajectory {
    /// A trajectory of up to `frames` frames, like the first frame given: radii, species and periodic axes are those
    /// that it has, and the columns are those that it has.
    pub fn create(path: &Path, provenance: &Provenance, first: &Frame, frames: u64) -> Result<Self, FileError> {
        Self::open(provenance, first, frames, |kind| Frames::create(path, kind))
    }

    /// Continues the trajectory of a former run after step `last`: later frames are dropped. `frames` is the number of
    /// frames at the end of the run.
    pub fn resume(
        path: &Path,
        provenance: &Provenance,
        first: &Frame,
        (last, frames): (u64, u64),
    ) -> Result<Self, FileError> {
        Self::open(provenance, first, frames, |kind| Frames::resume(path, kind, last))
    }

    fn open(
        provenance: &Provenance,
        first: &Frame,
        capacity: u64,
        open: impl FnOnce(&Kind) -> Result<Frames, FileError>,
    ) -> Result<Self, FileError> {
        let elements = elements(&first.particles);
        let fixed = |file: &hdf5::File| {
            provenance.write(file)?;
            write_fixed(file, first)
        };
        Ok(Self { frames: open(&Kind { elements: &elements, capacity, fixed: &fixed })?, elements })
    }

    /// The frames of the former run that are not as they were written.
    pub fn damage(&self) -> &[Damage] {
        self.frames.damage()
    }

    /// Bytes of a frame like this one.
    pub fn frame_bytes(frame: &Frame) -> usize {
        elements(&frame.particles).iter().map(Element::bytes).sum()
    }

    /// Waits until all frames so far are on the disk.
    pub fn sync(&self) -> Result<(), FileError> {
        self.frames.sync()
    }

    /// Adds a frame.
    pub fn append(&mut self, clock: (u64, f64), Frame { cell, particles, .. }: &Frame) -> Result<(), FileError> {
        let lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| cell.lattice(steps).to_array());
        let mut values: Vec<Values> = vec![
            bytemuck::cast_slice::<_, f64>(&particles.positions).into(),
            bytemuck::cast_slice::<_, i32>(&particles.steps).into(),
            lattice.as_flattened().into(),
            // A lattice is told by its vectors alone.
            if cell.axes().is_none() { cell.strain() } else { 0.0 }.into(),
        ];
        for element in &self.elements[values.len()..] {
            let named = COLUMNS.iter().find(|(_, path, _)| *path == element.path);
            let column = particles.columns.iter().find(|c| named.is_some_and(|(name, ..)| c.name == *name));
            values.push(column.expect("the columns of the first frame").values.as_slice().into());
        }
        self.frames.append(clock, &values)
    }
}

fn elements(particles: &Particles) -> Vec<Element> {
    let count = particles.len();
    let element = |path: &str, shape, unit| Element { path: path.into(), shape, whole: false, unit };
    let mut elements = vec![
        element("particles/all/position", Some([count, 3]), "length"),
        Element { whole: true, ..element("particles/all/image", Some([count, 3]), "") },
        element("particles/all/box/edges", Some([3, 3]), "length"),
        element("particles/all/box/strain", None, ""),
    ];
    for (name, path, unit) in COLUMNS {
        if let Some(column) = particles.columns.iter().find(|c| c.name == name) {
            elements.push(element(path, Some([count, column.width]), unit));
        }
    }
    elements
}

/// What no frame changes.
fn write_fixed(file: &hdf5::File, Frame { particles, periodic, .. }: &Frame) -> hdf5::Result<()> {
    let group = file.group("particles/all")?;
    checksum::write(&group, "id", &particles.ids)?;
    checksum::write(&group, "species", &particles.species)?;
    let radii = checksum::write(&group, "radius", &particles.radii)?;
    text::write_dimensions(&radii, "length")?;
    let cell = group.group("box")?;
    cell.new_attr::<i32>().create("dimension")?.write_scalar(&3)?;
    let boundary = periodic.map(|yes| text::fixed(if yes { "periodic" } else { "none" }));
    let boundary = boundary.into_iter().collect::<hdf5::Result<Vec<_>>>()?;
    cell.new_attr::<FixedAscii<64>>().shape(3).create("boundary")?.write(&boundary)
}
