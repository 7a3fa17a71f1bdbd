//! The answer to a case.

use super::is_hdf5;
use crate::{FileError, atomic_file, atomic_hdf5};
use hdf5::File;
use hdf5::types::VarLenUnicode;
use serde::Serialize;
use std::path::Path;

/// The answer to a [`Case`](scene::Case); fields that were not computed are absent.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CaseAnswer {
    /// Velocities at the centres, relative to the background flow.
    pub velocities: Vec<[f64; 3]>,
    /// Angular velocities relative to the background flow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub angular_velocities: Option<Vec<[f64; 3]>>,
    /// Rates of strain of the disturbance flow (xx, xy, xz, yy, yz).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strain_rates: Option<Vec<[f64; 5]>>,
    /// Stresslets (xx, xy, xz, yy, yz); with lubrication, the total hydrodynamic stresslets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresslets: Option<Vec<[f64; 5]>>,
    /// With lubrication, the part of the stresslets that acts on the far field.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stresslets_far: Option<Vec<[f64; 5]>>,
    /// Velocities of the centres of rigid bodies, relative to the background flow there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body_velocities: Option<Vec<[f64; 3]>>,
    /// Angular velocities of rigid bodies, relative to the background flow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body_angular_velocities: Option<Vec<[f64; 3]>>,
    /// Random velocities, one list for each draw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Random angular velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_angular_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Random rates of strain (xx, xy, xz, yy, yz) of particles that are not rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise_strain_rates: Option<Vec<Vec<[f64; 5]>>>,
    /// Velocities of the random part of the drift at a thermal energy of 1, one list for each draw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Angular velocities of the random part of the drift.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_angular_velocities: Option<Vec<Vec<[f64; 3]>>>,
    /// Stresslets (xx, xy, xz, yy, yz) of the random part of the drift.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_stresslets: Option<Vec<Vec<[f64; 5]>>>,
    /// Iterations of the solve for stresslets and lubrication.
    pub iterations: usize,
    /// Relative residual of that solve.
    pub residual: f64,
    /// Wall-clock time of the evaluation in seconds.
    pub seconds: f64,
    /// Plan of the evaluation.
    pub plan: String,
}

impl CaseAnswer {
    /// Writes the answer to a file, HDF5 if its name ends in `.h5` or `.hdf5`, else JSON.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        if is_hdf5(path) {
            return atomic_hdf5::write(path, |file| self.fill(file));
        }
        atomic_file::replace(path, self.to_json().as_bytes())
    }

    /// The answer as JSON.
    pub fn to_json(&self) -> String {
        let mut text = serde_json::to_string(self).expect("numbers and text can be written as JSON");
        text.push('\n');
        text
    }

    fn fill(&self, file: &File) -> hdf5::Result<()> {
        let table = |name: &str, width: usize, values: Vec<f64>| -> hdf5::Result<()> {
            let rows = values.len() / width;
            let values = ndarray::Array2::from_shape_vec((rows, width), values).expect("whole rows");
            file.new_dataset_builder().with_data(&values).create(name).map(|_| ())
        };
        table("velocities", 3, self.velocities.concat())?;
        if let Some(list) = &self.angular_velocities {
            table("angular_velocities", 3, list.concat())?;
        }
        if let Some(list) = &self.strain_rates {
            table("strain_rates", 5, list.concat())?;
        }
        if let Some(list) = &self.stresslets {
            table("stresslets", 5, list.concat())?;
        }
        if let Some(list) = &self.stresslets_far {
            table("stresslets_far", 5, list.concat())?;
        }
        if let Some(list) = &self.body_velocities {
            table("body_velocities", 3, list.concat())?;
        }
        if let Some(list) = &self.body_angular_velocities {
            table("body_angular_velocities", 3, list.concat())?;
        }
        draws(file, "noise_velocities", self.noise_velocities.as_deref())?;
        draws(file, "noise_angular_velocities", self.noise_angular_velocities.as_deref())?;
        draws(file, "noise_strain_rates", self.noise_strain_rates.as_deref())?;
        draws(file, "drift_velocities", self.drift_velocities.as_deref())?;
        draws(file, "drift_angular_velocities", self.drift_angular_velocities.as_deref())?;
        draws(file, "drift_stresslets", self.drift_stresslets.as_deref())?;
        file.new_dataset::<u64>().create("iterations")?.write_scalar(&(self.iterations as u64))?;
        file.new_dataset::<f64>().create("residual")?.write_scalar(&self.residual)?;
        file.new_dataset::<f64>().create("seconds")?.write_scalar(&self.seconds)?;
        let plan: VarLenUnicode = self.plan.parse().map_err(|_| "the plan has a zero byte")?;
        file.new_dataset::<VarLenUnicode>().create("plan")?.write_scalar(&plan)
    }
}

/// Writes lists of draws with the shape `(draws, N, W)`.
fn draws<const W: usize>(file: &File, name: &str, lists: Option<&[Vec<[f64; W]>]>) -> hdf5::Result<()> {
    let Some(lists) = lists else { return Ok(()) };
    let shape = (lists.len(), lists.first().map_or(0, Vec::len), W);
    let values = ndarray::Array3::from_shape_vec(shape, lists.concat().concat()).expect("lists of one length");
    file.new_dataset_builder().with_data(&values).create(name).map(|_| ())
}
