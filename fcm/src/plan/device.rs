//! Device that evaluates the far field.

pub(crate) mod card_costs;

use crate::envelope::Envelope;
use crate::pairs::table::{PairFunctions, PairTable};
use crate::plan::method::Method;
use crate::plan::problem::{Precision, Problem};
use crate::plan::{Plan, PlanError};
use domain::{Boundaries, readable_bytes};
use gpu::{DeviceInfo, EvaluationSize, NearSize, NumberFormat, SolveKind};

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

    /// Whether the device is there, with the reason if it is not.
    pub fn check_present(self) -> Result<(), String> {
        match self {
            Self::Cpu => Ok(()),
            Self::Gpu => gpu::Cuda::check().map_err(|reason| reason.0),
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

/// Mean numbers of near pairs of a particle, and the tables of their lubrication.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearPairCounts {
    /// Stiff pairs.
    pub stiff: f64,
    /// Soft pairs.
    pub soft: f64,
    /// Bytes of the tables of lubrication on a card.
    pub tables: f64,
}

/// Memory that evaluations take of a card.
#[derive(Debug, Clone, PartialEq)]
pub struct CardMemory {
    /// The card.
    pub card: DeviceInfo,
    /// Bytes that evaluations take.
    pub bytes: f64,
}

impl CardMemory {
    /// Memory of the first card; the error if there is none.
    pub(crate) fn of_first(bytes: f64) -> Result<Self, PlanError> {
        let card = gpu::Cuda::first().map_err(|error| refused(&error.0))?;
        Ok(Self { card, bytes })
    }

    /// Refuses evaluations that take more than is free.
    pub fn check(&self) -> Result<(), PlanError> {
        if self.bytes <= self.card.free_bytes {
            return Ok(());
        }
        let [needed, free, total] = [self.bytes, self.card.free_bytes, self.card.total_bytes].map(readable_bytes);
        let name = &self.card.name;
        Err(refused(&format!("the solve takes {needed} of the card, and {name} has {free} free of {total}")))
    }

    /// Card and memory in words.
    pub fn describe(&self) -> String {
        let [needed, free, total] = [self.bytes, self.card.free_bytes, self.card.total_bytes].map(readable_bytes);
        format!("{}, {free} free of {total}; the solve takes about {needed}", self.card.name)
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
        plans.retain(|plan| plan.table_intervals().is_some());
        if plans.is_empty() {
            return Err(refused("the spheres are so far apart that the pair corrections reach beyond any table"));
        }
        Ok(())
    }
}

impl Plan {
    /// Number of intervals of all tables of the pair functions; `None` if one of them has too many.
    fn table_intervals(&self) -> Option<usize> {
        let own = self.in_units(&self.units());
        let common = own.common()?;
        let envelopes: Vec<Envelope> = own.radii.iter().map(|&radius| Envelope::of_sphere(radius)).collect();
        let pairs = envelopes.iter().flat_map(|&i| envelopes.iter().map(move |&j| PairFunctions::new(i, j, common)));
        pairs.map(|pair| PairTable::<f64>::intervals(&pair, own.cutoff(), own.table_tolerance())).sum()
    }

    fn numbers(&self) -> NumberFormat {
        match self.precision {
            Precision::Single => NumberFormat::Single,
            Precision::Double => NumberFormat::Double,
        }
    }

    /// Bytes of a solve with near pairs on a card, besides those of evaluations.
    pub(crate) fn near_bytes(&self, particles: f64, pairs: NearPairCounts) -> f64 {
        let [stiff, soft] = [pairs.stiff, pairs.soft].map(|of_one| particles * of_one);
        NearSize { numbers: self.numbers(), particles, stiff, soft, tables: pairs.tables }.bytes()
    }

    /// Size of evaluations on a card, for particles with some neighbours within the cutoff each.
    pub(crate) fn size_on_card(&self, particles: f64, neighbours: f64) -> EvaluationSize {
        EvaluationSize {
            numbers: self.numbers(),
            grid: self.grid,
            particles,
            classes: self.radii.len() as f64,
            neighbours: particles * neighbours,
            intervals: self.table_intervals().unwrap_or_default() as f64,
            solve: match self.boundaries {
                Boundaries::Periodic => SolveKind::Periodic,
                Boundaries::Open => SolveKind::Unbounded,
                _ => SolveKind::Channel,
            },
            images: self.images(particles) * particles,
        }
    }
}

#[cfg(test)]
mod tests;
