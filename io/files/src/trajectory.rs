//! Trajectories in the H5MD format (de Buyl, Colberg & Höfling, Comput. Phys. Commun. 185, 1546, 2014).

use crate::frames::{Damage, Element, FileKind, Frames, NewValue};
use crate::origin::Origin;
use crate::scene_history::SceneHistory;
use crate::{FileError, Provenance, checksum, text};
use domain::{ById, Comm, Particles, PeriodicBox};
use hdf5::types::FixedAscii;
use simulation::Frame;
use std::path::Path;

/// A trajectory that is being written: positions inside the box, images, and those of the columns `velocity`,
/// `angular_velocity`, `stresslet` and `orientation` that the particles have, all in the order of the ids; radii,
/// species and the numbers of rigid bodies (-1 for none) do not change. If the run is killed, the file can be read up
/// to its last complete frame.
pub struct Trajectory {
    frames: Frames,
    description: TrajectoryDescription,
}

/// Particles distributed over the ranks, in the order of their ids, and which axes are periodic.
#[derive(Clone, Copy)]
pub struct ParticleRows<'a> {
    /// The particles.
    pub rows: &'a ById<'a>,
    /// Whether each axis is periodic.
    pub periodic: [bool; 3],
}

/// Data for a new file that the particles do not provide.
struct TrajectoryDescription {
    elements: Vec<Element>,
    periodic: [bool; 3],
    /// Number of frames at the end of the run.
    planned: u64,
    origin: Origin,
}

impl TrajectoryDescription {
    fn with_kind<R>(&self, rows: &ById, with: impl FnOnce(&FileKind) -> R) -> R {
        let fixed = |file: &hdf5::File| {
            self.origin.write(file)?;
            write_fixed(file, ParticleRows { rows, periodic: self.periodic })
        };
        with(&FileKind { elements: &self.elements, planned: self.planned, fixed: &fixed })
    }
}

/// Columns that are written, with their units.
const COLUMNS: [(&str, &str, &str); 4] = [
    ("velocity", "particles/all/velocity", "length/time"),
    ("angular_velocity", "particles/all/angular_velocity", "1/time"),
    ("stresslet", "particles/all/stresslet", "force*length"),
    ("orientation", "particles/all/orientation", ""),
];

impl Trajectory {
    /// A trajectory with `frames` frames at the end of the run. The first frame determines radii, species,
    /// periodic axes and columns.
    pub fn create(path: &Path, provenance: &Provenance, first: &Frame, frames: u64) -> Result<Self, FileError> {
        alone(&first.particles, |rows| {
            Self::create_for(path, provenance, ParticleRows { rows, periodic: first.periodic }, frames)
        })
    }

    /// Like [`Self::create`], with particles distributed over the ranks.
    pub fn create_for(
        path: &Path,
        provenance: &Provenance,
        first: ParticleRows,
        frames: u64,
    ) -> Result<Self, FileError> {
        Self::open(provenance, first, frames, |kind| Frames::create(path, kind))
    }

    /// Continues the trajectory of an earlier part of the run after step `last`: later frames are dropped. `frames`
    /// is the number of frames at the end of the run.
    pub fn resume(
        path: &Path,
        provenance: &Provenance,
        first: &Frame,
        last: u64,
        frames: u64,
    ) -> Result<Self, FileError> {
        alone(&first.particles, |rows| {
            Self::resume_for(path, provenance, ParticleRows { rows, periodic: first.periodic }, last, frames)
        })
    }

    /// Like [`Self::resume`], with particles distributed over the ranks.
    pub fn resume_for(
        path: &Path,
        provenance: &Provenance,
        first: ParticleRows,
        last: u64,
        frames: u64,
    ) -> Result<Self, FileError> {
        Self::open(provenance, first, frames, |kind| Frames::resume(path, kind, last))
    }

    fn open(
        provenance: &Provenance,
        ParticleRows { rows, periodic }: ParticleRows,
        planned: u64,
        open: impl FnOnce(&FileKind) -> Result<Frames, FileError>,
    ) -> Result<Self, FileError> {
        let elements = elements(rows.columns(), rows.count());
        let description = TrajectoryDescription { elements, periodic, planned, origin: Origin::new(provenance) };
        Ok(Self { frames: description.with_kind(rows, open)?, description })
    }

    /// Records the changes of the scene.
    pub fn note_scenes(&mut self, scenes: &SceneHistory) -> Result<(), FileError> {
        self.description.origin.note_scenes(scenes, &mut self.frames)
    }

    /// Steps of the frames.
    pub fn steps(&self) -> Result<Vec<u64>, FileError> {
        self.frames.steps_written()
    }

    /// Damaged frames of the earlier part of the run.
    pub fn damage(&self) -> &[Damage] {
        self.frames.damage()
    }

    /// Bytes of a frame like this one.
    pub fn frame_bytes(frame: &Frame) -> usize {
        let columns = frame.particles.columns.iter().map(|column| (column.name.as_str(), column.width));
        elements(columns, frame.particles.len()).iter().map(Element::bytes).sum()
    }

    /// Waits until all frames so far are on the disk.
    pub fn sync(&self) -> Result<(), FileError> {
        self.frames.sync()
    }

    /// Appends a frame.
    pub fn append(&mut self, clock: (u64, f64), Frame { cell, particles, .. }: &Frame) -> Result<(), FileError> {
        alone(particles, |rows| self.append_for(clock, rows, cell))
    }

    /// Appends a frame of particles distributed over the ranks.
    pub fn append_for(&mut self, clock: (u64, f64), rows: &ById, cell: &PeriodicBox) -> Result<(), FileError> {
        let lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| cell.lattice(steps).to_array());
        // A lattice is determined by its vectors alone.
        let strain = if cell.axes().is_none() { cell.strain() } else { 0.0 };
        let mut values = vec![
            NewValue::InBlocks(Box::new(|each| rows.positions(|x| each(&bytemuck::cast_slice::<_, f64>(x).into())))),
            NewValue::InBlocks(Box::new(|each| rows.steps(|steps| each(&steps.as_flattened().into())))),
            NewValue::Whole(lattice.as_flattened().into()),
            NewValue::Whole(strain.into()),
        ];
        for element in &self.description.elements[values.len()..] {
            let is_its =
                |(name, _): (&str, usize)| COLUMNS.iter().any(|&(n, path, _)| path == element.path && n == name);
            let place = rows.columns().position(is_its).expect("the columns of the first frame");
            values.push(NewValue::InBlocks(Box::new(move |each| rows.column(place, |values| each(&values.into())))));
        }
        self.description.with_kind(rows, |kind| self.frames.append_blocks(kind, clock, &values))
    }
}

/// Reads particles that are all on this rank.
fn alone<R>(particles: &Particles, read: impl FnOnce(&ById) -> R) -> R {
    particles.by_id(&Comm::alone(), read).expect("the only rank is the first")
}

fn elements<'a>(columns: impl Iterator<Item = (&'a str, usize)>, count: usize) -> Vec<Element> {
    let element = |path: &str, shape, unit| Element { path: path.into(), shape, whole: false, unit };
    let mut elements = vec![
        element("particles/all/position", Some([count, 3]), "length"),
        Element { whole: true, ..element("particles/all/image", Some([count, 3]), "") },
        element("particles/all/box/edges", Some([3, 3]), "length"),
        element("particles/all/box/strain", None, ""),
    ];
    let columns: Vec<_> = columns.collect();
    for (name, path, unit) in COLUMNS {
        if let Some((_, width)) = columns.iter().find(|column| column.0 == name) {
            elements.push(element(path, Some([count, *width]), unit));
        }
    }
    elements
}

/// Writes the data that are the same for all frames.
fn write_fixed(file: &hdf5::File, ParticleRows { rows, periodic }: ParticleRows) -> hdf5::Result<()> {
    let (group, count) = (file.group("particles/all")?, rows.count());
    checksum::write_blocks::<u64>(&group, "id", count, |each| rows.ids(each))?;
    checksum::write_blocks::<u32>(&group, "species", count, |each| rows.species(each))?;
    let radii = checksum::write_blocks::<f64>(&group, "radius", count, |each| rows.radii(each))?;
    text::write_dimensions(&radii, "length")?;
    if let Some(bodies) = rows.columns().position(|(name, _)| name == "body") {
        let whole = |numbers: &[f64]| numbers.iter().map(|&number| number as i64).collect::<Vec<_>>();
        checksum::write_blocks::<i64>(&group, "body", count, |each| {
            rows.column(bodies, |numbers| each(&whole(numbers)))
        })?;
    }
    let cell = group.group("box")?;
    cell.new_attr::<i32>().create("dimension")?.write_scalar(&3)?;
    let boundary = periodic.map(|yes| text::fixed(if yes { "periodic" } else { "none" }));
    let boundary = boundary.into_iter().collect::<hdf5::Result<Vec<_>>>()?;
    cell.new_attr::<FixedAscii<64>>().shape(3).create("boundary")?.write(&boundary)
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;

    /// Files have the same content for any distribution and order of the particles.
    #[test]
    fn ranks_write_one_file() {
        let cell = PeriodicBox::sheared(Vector::splat(4.0), 0.2).unwrap();
        let mut all = Particles::default();
        (0..23).for_each(|id| all.push(id, Vector::splat(0.1 * id as f64), 1.0 + id as f64, (id % 2) as u32));
        all.steps[3] = [1, -2, 3];
        all.column("stresslet", 5).values.iter_mut().enumerate().for_each(|(k, value)| *value = k as f64);
        all.column("orientation", 4).values.iter_mut().enumerate().for_each(|(k, value)| *value = 0.1 * k as f64);
        all.vectors("another").fill(Vector::ONE);
        all.vectors("velocity")[22] = Vector::new(-0.0, 1e-300, 1.0 / 3.0);
        let folder = tempfile::tempdir().unwrap();
        let provenance = Provenance {
            scene: "none".to_owned(),
            program: "a test".to_owned(),
            plan: "none".to_owned(),
            ranks: 1,
            seed: 1,
        };
        let files = [1, 2, 3, 7].map(|ranks| {
            let path = folder.path().join(format!("{ranks}.h5"));
            Comm::threads(ranks, |comm| {
                let rows: Vec<usize> = (0..23).rev().filter(|row| row % ranks == comm.rank()).collect();
                let own = all.selected(&rows);
                let axes = [true, true, false];
                let opened = own.by_id(&comm, |rows| {
                    Trajectory::create_for(&path, &provenance, ParticleRows { rows, periodic: axes }, 2)
                });
                let mut trajectory = opened.transpose().unwrap();
                for step in 0..2 {
                    let mut append = |rows: &ById| {
                        trajectory.as_mut().expect("on the first rank").append_for((step, 0.5), rows, &cell)
                    };
                    own.by_id(&comm, &mut append).transpose().unwrap();
                }
            });
            content(&path)
        });
        assert!(files[1..].iter().all(|file| *file == files[0]));
        let path = folder.path().join("whole.h5");
        let frame = Frame { particles: all.clone(), cell, periodic: [true, true, false] };
        let mut whole = Trajectory::create(&path, &provenance, &frame, 2).unwrap();
        (0..2).for_each(|step| whole.append((step, 0.5), &frame).unwrap());
        assert!(content(&path) == files[0]);
        let (_, read) = crate::TrajectoryReader::open(&path).unwrap().frame(1).unwrap();
        assert_eq!(read.columns.last().map(|column| &column.values), Some(&all.column("orientation", 4).values));
        assert_eq!((read.ids, read.positions, read.steps), (all.ids, all.positions, all.steps));
    }

    /// Data that do not change and the checksums of all frames, after checking that values match them.
    fn content(path: &Path) -> (Vec<u64>, Vec<f64>, Vec<u64>) {
        assert_eq!(crate::Contents::read(path).unwrap().damage, Vec::<String>::new());
        let file = hdf5::File::open(path).unwrap();
        let numbers = |name: &str| file.dataset(name).unwrap().read_raw::<u64>().unwrap();
        let radii = file.dataset("particles/all/radius").unwrap().read_raw().unwrap();
        (numbers("particles/all/id"), radii, numbers("parameters/checksums"))
    }
}
