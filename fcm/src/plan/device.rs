//! Device that evaluates the far field.

use crate::envelope::Envelope;
use crate::pairs::table::{PairFunctions, PairTable};
use crate::plan::method::Method;
use crate::plan::problem::Problem;
use crate::plan::{Plan, PlanError};
use domain::Boundaries;

/// Largest number of radii of which a device has tables for all pairs.
const MOST_RADII: usize = 32;

/// Device that evaluates the far field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ComputeDevice {
    /// The processors of the host.
    #[default]
    Cpu,
    /// A graphics card.
    Gpu,
}

impl ComputeDevice {
    /// Name of the device in scenes and descriptions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }

    /// Whether the device has this method.
    pub(crate) fn allows(self, method: Method) -> bool {
        self == Self::Cpu || method == Method::Split
    }

    /// Refuses more ranks than the device serves.
    pub fn check_ranks(self, ranks: usize) -> Result<(), PlanError> {
        if self == Self::Gpu && ranks > 1 {
            return Err(refused(&format!("there are {ranks} ranks, and a GPU serves one")));
        }
        Ok(())
    }
}

fn refused(reason: &str) -> PlanError {
    PlanError::Fixed(format!("hydrodynamics.device is \"gpu\", but {reason}; leave it out, or write \"cpu\""))
}

impl Problem {
    /// Refuses problems that the device can't solve, and a device that is not there.
    pub(crate) fn check_device(&self) -> Result<(), PlanError> {
        if self.fixed.device == ComputeDevice::Cpu {
            return Ok(());
        }
        self.check_for_gpu()?;
        gpu::Cuda::check().map_err(|error| refused(&error.0))
    }

    /// Refuses problems that are not evaluated on a card.
    fn check_for_gpu(&self) -> Result<(), PlanError> {
        if let Some(method) = self.fixed.method.filter(|&method| method != Method::Split) {
            return Err(refused(&format!("hydrodynamics.method is \"{}\", which a GPU does not have", method.name())));
        }
        if self.boundaries != Boundaries::Periodic {
            return Err(refused("the box has walls or open faces, and a GPU evaluates periodic boxes alone"));
        }
        if self.is_reduced() {
            return Err(refused("the box is more than sixteen times as long as it is wide across the flow"));
        }
        self.fixed.device.check_ranks(self.ranks)?;
        let radii = self.summed_up().radii.len();
        if radii > MOST_RADII {
            let reason = format!("there are {radii} different radii, and a GPU has tables for {MOST_RADII}");
            return Err(refused(&reason));
        }
        Ok(())
    }

    /// Refuses plans without one that the device can evaluate.
    pub(crate) fn keep_evaluable(&self, plans: &mut Vec<Plan>) -> Result<(), PlanError> {
        if self.fixed.device == ComputeDevice::Cpu {
            return Ok(());
        }
        plans.retain(Plan::has_tables);
        if plans.is_empty() {
            return Err(refused("the spheres are so far apart that the pair corrections reach beyond any table"));
        }
        Ok(())
    }
}

impl Plan {
    /// Whether there are tables of the pair functions up to the cutoff.
    fn has_tables(&self) -> bool {
        let own = self.in_units(&self.units());
        let Some(common) = own.common() else { return false };
        let envelopes: Vec<Envelope> = own.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect();
        let has_table = |&i: &Envelope, &j: &Envelope| {
            let functions = PairFunctions::new(i, j, common);
            PairTable::<f64>::bytes(&functions, own.cutoff(), own.table_tolerance()).is_some()
        };
        envelopes.iter().all(|i| envelopes.iter().all(|j| has_table(i, j)))
    }
}

#[cfg(test)]
mod tests;
