//! Reader of the contacts of a run.

use super::files;
use crate::{FileError, checksum, self_contained};
use domain::Vector;
use hdf5::File;
use simulation::{ContactForce, ContactForces, ContactState};
use std::path::{Path, PathBuf};

/// The contacts that a run has written, step by step.
pub struct RecordedContacts {
    clocks: Vec<(u64, f64)>,
    paths: Vec<PathBuf>,
}

impl RecordedContacts {
    /// Contacts in the folder of a run; empty if it wrote none.
    pub fn of(folder: &Path) -> Result<Self, FileError> {
        let paths = files(folder)?;
        let clocks = paths.iter().map(|path| read(path, clock)).collect::<Result<_, _>>()?;
        Ok(Self { clocks, paths })
    }

    /// Steps and times at which contacts were written.
    pub fn clocks(&self) -> &[(u64, f64)] {
        &self.clocks
    }

    /// Contacts at an index of [`Self::clocks`]. `Err` if they are damaged.
    pub fn at(&self, place: usize) -> Result<ContactForces, FileError> {
        read(&self.paths[place], contents)
    }

    /// Contacts of a step, if they were written. Errors as for [`Self::at`].
    pub fn of_step(&self, step: u64) -> Option<Result<ContactForces, FileError>> {
        let place = self.clocks.iter().position(|clock| clock.0 == step)?;
        Some(self.at(place))
    }
}

fn read<T>(path: &Path, what: impl FnOnce(&File) -> hdf5::Result<T>) -> Result<T, FileError> {
    self_contained::open(path).and_then(|file| what(&file)).map_err(|e| FileError::damaged(path, &e))
}

fn clock(file: &File) -> hdf5::Result<(u64, f64)> {
    Ok((file.attr("step")?.read_scalar()?, file.attr("time")?.read_scalar()?))
}

fn contents(file: &File) -> hdf5::Result<ContactForces> {
    let (step, time) = clock(file)?;
    let vectors = |numbers: &[f64]| numbers.chunks_exact(3).map(Vector::from_slice).collect::<Vec<_>>();
    let lattice = vectors(&file.attr("lattice")?.read_raw::<f64>()?);
    let lattice = lattice.try_into().map_err(|_| "its lattice has not three vectors")?;
    let pairs: Vec<u64> = checksum::read(&file.dataset("pair")?)?;
    let reals = |name: &str| checksum::read::<f64>(&file.dataset(name)?);
    let (normal, states) = (reals("normal_force")?, checksum::read::<i32>(&file.dataset("state")?)?);
    let [places, separations, tangential] =
        ["position", "separation", "tangential_force"].map(|name| reals(name).map(|numbers| vectors(&numbers)));
    let (places, separations, tangential) = (places?, separations?, tangential?);
    let count = normal.len();
    if [pairs.len() / 2, states.len(), places.len(), separations.len(), tangential.len()] != [count; 5] {
        return Err("its columns have different lengths".into());
    }
    let one = |k: usize| {
        Some(ContactForce {
            ids: [pairs[2 * k], pairs[2 * k + 1]],
            position: places[k],
            separation: separations[k],
            normal: normal[k],
            tangential: tangential[k],
            state: *ContactState::ALL.get(usize::try_from(states[k]).ok()?)?,
        })
    };
    let list = (0..count).map(one).collect::<Option<_>>().ok_or("a state is none that there is")?;
    Ok(ContactForces { step, time, lattice, list })
}
