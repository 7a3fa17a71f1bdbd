//! Reader of trajectories.

use crate::frames::FrameChecksums;
use crate::missing_steps::MissingSteps;
use crate::scene_history::{self, SceneHistory};
use crate::{FileError, Provenance, checksum, claimed_size, self_contained};
use domain::{BoxError, Column, Particles, PeriodicBox, Vector};
use hdf5::types::FixedAscii;
use hdf5::{Group, H5Type, Hyperslab};
use scene::SceneChange;
use simulation::Frame;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// A trajectory of this program, read frame by frame.
pub struct TrajectoryReader {
    path: PathBuf,
    group: Group,
    fixed: Particles,
    times: Vec<f64>,
    steps: Vec<u64>,
    sums: Option<FrameChecksums>,
    provenance: Provenance,
    scenes: SceneHistory,
}

/// A frame with its step and time.
pub struct TimedFrame {
    /// Step.
    pub step: u64,
    /// Time.
    pub time: f64,
    /// The box and the particles.
    pub frame: Frame,
}

/// Optional columns of a frame, and their widths.
const COLUMNS: [(&str, usize); 4] = [("velocity", 3), ("angular_velocity", 3), ("stresslet", 5), ("orientation", 4)];

impl TrajectoryReader {
    /// Opens a trajectory.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        if !path.is_file() {
            return Err(FileError::read(
                path,
                &"there is no such file; a run writes it if output.trajectory_every is set",
            ));
        }
        Self::try_open(path).map_err(|e| FileError::damaged(path, &e))
    }

    fn try_open(path: &Path) -> hdf5::Result<Self> {
        let file = self_contained::open(path)?;
        let group = file.group("particles/all")?;
        let ids: Vec<u64> = checksum::read(&group.dataset("id")?)?;
        let count = ids.len();
        let mut fixed = Particles {
            ids,
            positions: vec![Vector::ZERO; count].into(),
            steps: vec![[0; 3]; count].into(),
            radii: checksum::read(&group.dataset("radius")?)?,
            species: checksum::read(&group.dataset("species")?)?,
            ..Particles::default()
        };
        if group.link_exists("body") {
            let numbers: Vec<i64> = checksum::read(&group.dataset("body")?)?;
            let values = numbers.into_iter().map(|number| number as f64).collect();
            fixed.columns.push(Column { name: "body".to_owned(), width: 1, values });
        }
        let mut times: Vec<f64> = claimed_size::read(&group, "position/time")?;
        // Times are written before steps, so there may be one more.
        let steps: Vec<u64> = claimed_size::read(&group, "position/step")?;
        times.truncate(steps.len());
        let (sums, provenance) = (FrameChecksums::open(&file)?, Provenance::read(&file)?);
        let scenes = SceneHistory { first: provenance.scene.clone(), changes: scene_history::changes(&file)? };
        Ok(Self { path: path.to_owned(), group, fixed, times, steps, sums, provenance, scenes })
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Provenance of the file.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    /// Times of the frames.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Steps of the frames.
    pub fn steps(&self) -> &[u64] {
        &self.steps
    }

    /// Largest common divisor of the intervals in steps between some frames; 0 if there are none.
    pub fn common_interval(&self, frames: &[usize]) -> u64 {
        let steps = frames.iter().map(|&frame| self.steps[frame]);
        steps
            .clone()
            .zip(steps.skip(1))
            .fold(0, |common, (before, after)| common_divisor(common, after.abs_diff(before)))
    }

    /// Steps of a span, including both ends, at which a frame was due and is missing in the file.
    pub fn missing_steps(&self, span: &RangeInclusive<u64>) -> MissingSteps {
        MissingSteps::of(&self.scenes.periods(), &self.steps, span)
    }

    /// Keys of the scene that have changed in the course of the run.
    pub fn changes(&self) -> &[SceneChange] {
        &self.scenes.changes
    }

    /// Whether a frame's step and time match their checksum.
    pub fn has_clock(&self, frame: usize) -> bool {
        self.sums.as_ref().is_none_or(|sums| sums.has_clock(frame))
    }

    /// Radii of the particles, in the order of their ids.
    pub fn radii(&self) -> &[f64] {
        &self.fixed.radii
    }

    /// Species of the particles, in the order of their ids.
    pub fn species(&self) -> &[u32] {
        &self.fixed.species
    }

    /// A frame with its step and time. Errors as for [`Self::frame`].
    pub fn snapshot(&self, frame: usize) -> Result<TimedFrame, FileError> {
        let (cell, particles) = self.frame(frame)?;
        let periodic = periodic(&self.group).map_err(|e| FileError::damaged(&self.path, &e))?;
        let (step, time) = (self.steps[frame], self.times[frame]);
        Ok(TimedFrame { step, time, frame: Frame { particles, cell, periodic } })
    }

    /// A frame: the box, and all particles in the order of their ids with the columns that the file
    /// has. `Err` if it is damaged.
    pub fn frame(&self, frame: usize) -> Result<(PeriodicBox, Particles), FileError> {
        self.try_frame(frame).map_err(|e| FileError::damaged(&self.path, &e))
    }

    fn try_frame(&self, frame: usize) -> hdf5::Result<(PeriodicBox, Particles)> {
        if let Some(damage) = self.sums.as_ref().and_then(|sums| sums.damage(frame)) {
            return Err(damage.to_string().into());
        }
        let edges: Vec<f64> = self.value("box/edges", frame)?;
        let strains: Vec<f64> = claimed_size::read(&self.group, "box/strain/value")?;
        let vectors: [f64; 9] = edges
            .try_into()
            .map_err(|edges: Vec<f64>| format!("its box/edges have {} numbers a frame instead of 9", edges.len()))?;
        let strain = *strains.get(frame).ok_or_else(|| format!("its box/strain has {} frames", strains.len()))?;
        let cell = cell(&vectors, strain).map_err(|e| e.to_string())?;
        let mut particles = self.fixed.clone();
        let positions: Vec<f64> = self.value("position", frame)?;
        particles.positions = positions.chunks_exact(3).map(Vector::from_slice).collect();
        let images: Vec<i32> = self.value("image", frame)?;
        particles.steps = images.chunks_exact(3).map(|steps| [steps[0], steps[1], steps[2]]).collect();
        for (name, width) in COLUMNS {
            if self.group.link_exists(name) {
                let values = self.value(name, frame)?;
                particles.columns.push(Column { name: name.to_owned(), width, values: values.into() });
            }
        }
        particles.check().map_err(|e| e.to_string())?;
        let cell = around(cell, &particles, periodic(&self.group)?);
        numbers(&particles).map_err(|reason| format!("frame {frame}: {reason}"))?;
        Ok((cell, particles))
    }

    fn value<T: H5Type + Clone>(&self, name: &str, frame: usize) -> hdf5::Result<Vec<T>> {
        let slice = Hyperslab::from((frame, .., ..));
        let dataset = claimed_size::dataset(&self.group, &format!("{name}/value"))?;
        Ok(dataset.read_slice_2d::<T, _>(slice)?.into_raw_vec_and_offset().0)
    }
}

fn common_divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

/// Box from consecutive lattice vectors; `strain` is that of a sheared box.
fn cell(vectors: &[f64; 9], strain: f64) -> Result<PeriodicBox, BoxError> {
    match *vectors {
        [xx, 0.0, 0.0, _, yy, 0.0, 0.0, 0.0, zz] => PeriodicBox::sheared(Vector::new(xx, yy, zz), strain),
        _ => PeriodicBox::of_lattice([0, 3, 6].map(|first| Vector::from_slice(&vectors[first..]))),
    }
}

/// The box at the position of the particles that it follows, which files do not store. Along an axis that is not
/// periodic it is centred at the particles: always in unbounded fluid, otherwise if centres are outside of it.
fn around(cell: PeriodicBox, particles: &Particles, periodic: [bool; 3]) -> PeriodicBox {
    let mut origin = Vector::ZERO;
    for axis in (0..3).filter(|&axis| !periodic[axis] && !particles.is_empty()) {
        let places = || particles.positions.iter().map(|x| x[axis]);
        let (lowest, highest) = (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
        if periodic == [false; 3] || lowest < 0.0 || highest > cell.edges()[axis] {
            origin[axis] = 0.5 * (lowest + highest - cell.edges()[axis]);
        }
    }
    if origin == Vector::ZERO { cell } else { cell.with_extent(origin, cell.edges()).unwrap_or(cell) }
}

/// Whether the box is periodic along each axis.
fn periodic(group: &Group) -> hdf5::Result<[bool; 3]> {
    let boundary = group.group("box")?.attr("boundary")?.read_raw::<FixedAscii<64>>()?;
    let periodic: Vec<bool> = boundary.iter().map(|axis| axis.as_str() == "periodic").collect();
    periodic.try_into().map_err(|axes: Vec<bool>| format!("its box has {} boundaries", axes.len()).into())
}

/// Refuses particles with invalid numbers.
fn numbers(particles: &Particles) -> Result<(), String> {
    if !particles.radii.iter().all(|&radius| radius > 0.0 && radius.is_finite()) {
        return Err("a radius is no finite number above 0".to_owned());
    }
    if !particles.positions.iter().all(|position| position.is_finite()) {
        return Err("a position is not finite".to_owned());
    }
    match particles.columns.iter().find(|column| !column.values.iter().all(|value| value.is_finite())) {
        Some(column) => Err(format!("a number of {} is not finite", column.name)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Provenance, Trajectory};
    use hdf5::File;

    /// Error message for a trajectory of one frame of one particle after a change.
    fn changed(change: impl FnOnce(&File) -> hdf5::Result<()>) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trajectory.h5");
        let provenance =
            Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 2 };
        let mut particles = Particles::default();
        particles.push(0, Vector::ONE, 1.0, 0);
        particles.vectors("velocity");
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let frame = Frame { particles, cell, periodic: [true; 3] };
        Trajectory::create(&path, &provenance, &frame, 1).unwrap().append((0, 0.0), &frame).unwrap();
        change(&File::open_rw(&path).unwrap()).unwrap();
        TrajectoryReader::open(&path)
            .and_then(|recorded| recorded.frame(0))
            .map_or_else(|e| e.to_string(), |_| String::new())
    }

    #[test]
    fn frames_that_mean_nothing_are_refused() {
        let put = |file: &File, name: &str, numbers: &[f64]| {
            let values = ndarray::Array3::from_shape_vec((1, 1, 3), numbers.to_vec()).unwrap();
            file.dataset(&format!("particles/all/{name}/value"))?.write(&values)
        };
        assert_eq!(changed(|_| Ok(())), "");
        assert_ne!(changed(|file| put(file, "position", &[1.0, f64::NAN, 1.0])), "");
        assert_ne!(changed(|file| put(file, "velocity", &[1.0, 1.0, f64::INFINITY])), "");
        assert_ne!(changed(|file| file.dataset("particles/all/radius")?.write(&ndarray::arr1(&[-1.0]))), "");
        let short = |file: &File, name: &str| {
            file.unlink(name)?;
            file.new_dataset_builder().with_data(&ndarray::Array3::<f64>::ones((1, 1, 3))).create(name).map(drop)
        };
        assert_ne!(changed(|file| short(file, "particles/all/box/edges/value")), "");
        assert_ne!(changed(|file| file.dataset("particles/all/box/strain/value")?.resize((0,))), "");
    }

    /// In unbounded fluid the box is always around the particles; along an open axis if they are outside of it.
    #[test]
    fn boxes_that_follow_particles_are_around_them() {
        let mut particles = Particles::default();
        particles.push(0, Vector::new(-7.0, 2.0, 103.0), 1.0, 0);
        particles.push(1, Vector::new(-3.0, 1.0, 100.0), 1.0, 0);
        let cell = PeriodicBox::new(Vector::new(6.0, 3.0, 4.0)).unwrap();
        let origin = |periodic| around(cell, &particles, periodic).origin();
        assert_eq!(origin([false; 3]), Vector::new(-8.0, 0.0, 99.5));
        assert_eq!(origin([true, true, false]), Vector::new(0.0, 0.0, 99.5));
        assert_eq!(origin([true, false, true]), Vector::ZERO);
        assert_eq!(around(cell, &Particles::default(), [false; 3]), cell);
        let parts = particles.positions.iter().map(|&x| around(cell, &particles, [false; 3]).fractional_coordinates(x));
        assert!(parts.into_iter().all(|part| part.min_element() > 0.0 && part.max_element() < 1.0));
    }

    #[test]
    fn lattices_are_told_by_their_vectors() {
        let vectors = [[2.0, 1.0, 0.0], [-1.0, 2.5, 0.0], [0.0, 0.0, 4.0]];
        let found = cell(&vectors.concat().try_into().unwrap(), 0.0).unwrap();
        for (found, given) in found.lattice_vectors().iter().zip(vectors) {
            assert!((*found - Vector::from_array(given)).length() < 1e-14, "{found} is not {given:?}");
        }
        let sheared = PeriodicBox::sheared(Vector::new(3.0, 4.0, 5.0), 0.3).unwrap();
        let written = sheared.lattice_vectors().map(|vector| vector.to_array()).concat();
        assert_eq!(cell(&written.try_into().unwrap(), 0.3).unwrap(), sheared);
    }

    #[test]
    fn frames_are_read_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("trajectory.h5");
        let provenance =
            Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "one".into(), ranks: 1, seed: 2 };
        let frame = |k: u32| {
            let mut particles = Particles::default();
            particles.push(0, Vector::new(0.1, 0.2, 0.3) * f64::from(k), 1.0, 0);
            particles.push(1, Vector::new(1.1, 1.2, 1.3), 7.125, 1);
            particles.steps[1] = [k as i32, -1, 0];
            particles.vectors("velocity")[0] = Vector::X * f64::from(k);
            let cell = PeriodicBox::sheared(Vector::new(3.0, 4.0, 5.0), 0.1 * f64::from(k)).unwrap();
            Frame { particles, cell, periodic: [true; 3] }
        };
        let mut trajectory = Trajectory::create(&path, &provenance, &frame(0), 3).unwrap();
        for k in 0..3 {
            trajectory.append((u64::from(k), 0.5 * f64::from(k)), &frame(k)).unwrap();
        }
        drop(trajectory);
        let recorded = TrajectoryReader::open(&path).unwrap();
        assert_eq!((recorded.provenance(), recorded.times()), (&provenance, &[0.0, 0.5, 1.0][..]));
        for k in 0..3 {
            let Frame { cell, particles, .. } = frame(k as u32);
            assert_eq!(recorded.frame(k).unwrap(), (cell, particles));
        }
        assert!(TrajectoryReader::open(&folder.path().join("none.h5")).is_err());
        drop(recorded);
        flip(&path, 2.0_f64 * 0.3);
        let recorded = TrajectoryReader::open(&path).unwrap();
        assert!(recorded.frame(1).is_ok());
        let error = recorded.frame(2).unwrap_err().to_string();
        assert!(error.contains("trajectory.h5 is damaged: frame 2 does not fit its checksums: particles/all/position"));
        let contents = crate::Contents::read(&path).unwrap();
        assert_eq!(contents.damage, ["frame 2 does not fit its checksums: particles/all/position"]);
        drop(recorded);
        flip(&path, 7.125);
        let error = TrajectoryReader::open(&path).err().unwrap().to_string();
        assert!(error.contains("trajectory.h5 is damaged: particles/all/radius does not fit its checksum"), "{error}");
    }

    /// Changes a bit of the first number with this value in a file.
    fn flip(path: &Path, number: f64) {
        let mut bytes = std::fs::read(path).unwrap();
        let place = bytes.windows(8).position(|b| b == number.to_le_bytes()).unwrap();
        bytes[place] ^= 1;
        std::fs::write(path, bytes).unwrap();
    }
}
