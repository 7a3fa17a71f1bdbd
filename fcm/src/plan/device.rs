//! Device that evaluates the far field.

pub(crate) mod card_costs;

use crate::envelope::Envelope;
use crate::pairs::table::{PairFunctions, PairTable};
use crate::plan::method::Method;
use crate::plan::problem::{Precision, Problem};
use crate::plan::{Plan, PlanError};
use domain::{Boundaries, Comm, Place, readable_bytes};
use gpu::{
    DIFFERENCE_BYTES, DeviceError, DeviceInfo, EvaluationSize, HISTORY_BYTES, NearSize, NumberFormat, SUBSTEP_BYTES,
    SolveKind, bytes_of_contacts,
};

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
}

/// Numbers on which the memory of a rank's card depends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CardCounts {
    /// Particles of the rank, and with those of other ranks that reach into its slab.
    pub owned: f64,
    pub present: f64,
    /// Ranks with a card each.
    pub ranks: usize,
}

/// Mean numbers of near pairs of a particle, and the tables of their lubrication.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct NearPairCounts {
    /// Stiff pairs.
    pub stiff: f64,
    /// Soft pairs.
    pub soft: f64,
    /// Bytes of the tables of lubrication on a card.
    pub tables: f64,
}

/// Steps of particles that move on a card, as far as its memory depends on them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CardSteps {
    /// Vectors of the basis of the square roots by which random motions are drawn; 0 without such motions.
    pub random_vectors: f64,
    /// Whether steps have several solves.
    pub has_substeps: bool,
    /// Whether steps have finite differences of random solutions.
    pub has_differences: bool,
    /// Contacts of a particle at most; 0 without contacts.
    pub slots: usize,
}

impl CardSteps {
    /// Bytes of a particle in the columns that steps keep, with the lists of contacts.
    fn bytes(&self) -> f64 {
        let of_substeps = if self.has_substeps { SUBSTEP_BYTES } else { 0.0 };
        let of_differences = if self.has_differences { DIFFERENCE_BYTES } else { 0.0 };
        let of_contacts = if self.slots > 0 { bytes_of_contacts(self.slots) } else { 0.0 };
        HISTORY_BYTES + of_substeps + of_differences + of_contacts
    }
}

/// Ranks whose cards are asked for.
#[derive(Clone, Copy)]
pub enum CardRanks<'a> {
    /// Ranks that are present.
    Present(&'a Comm),
    /// This many ranks on this machine.
    Asked(usize),
}

impl CardRanks<'_> {
    /// Number of ranks.
    pub fn count(&self) -> usize {
        match self {
            Self::Present(comm) => comm.size(),
            Self::Asked(count) => *count,
        }
    }
}

/// Number of the card of this rank: the ranks on a machine take its cards in turn. Collective.
pub(crate) fn number_of_card(comm: &Comm) -> Result<usize, DeviceError> {
    let place = comm.machine().rank();
    gpu::Cuda::count().map(|cards| place % cards)
}

/// Memory that evaluations take of a card.
#[derive(Debug, Clone, PartialEq)]
pub struct CardMemory {
    /// The card.
    pub card: DeviceInfo,
    /// Bytes that evaluations take for each rank.
    pub bytes: f64,
    /// Number of ranks.
    pub ranks: usize,
    /// Number of those that share the card.
    pub on_card: usize,
}

impl CardMemory {
    /// Memory of the card of this rank, or of the first if ranks are not present; the error if there is none.
    /// Collective.
    pub(crate) fn of(bytes: f64, ranks: CardRanks) -> Result<Self, PlanError> {
        let (card, on_card) = match ranks {
            CardRanks::Present(comm) => {
                let card = number_of_card(comm).and_then(gpu::Cuda::properties);
                // Also from ranks without a card, for which the others would wait.
                let own = card.as_ref().map_or([0; 16], |card| card.identity);
                let all = comm.all_gather(&[own]);
                (card, all.iter().filter(|&&identity| identity == own).count())
            }
            CardRanks::Asked(count) => {
                let on_card = gpu::Cuda::count().map_or(count, |cards| count.div_ceil(cards));
                (gpu::Cuda::properties(0), on_card)
            }
        };
        let card = card.map_err(|error| refused(&error.0))?;
        Ok(Self { card, bytes, ranks: ranks.count(), on_card })
    }

    /// Refuses evaluations that take more than is free.
    pub fn check(&self) -> Result<(), PlanError> {
        let bytes = self.bytes * self.on_card as f64;
        if bytes <= self.card.free_bytes {
            return Ok(());
        }
        let [needed, free, total] = [bytes, self.card.free_bytes, self.card.total_bytes].map(readable_bytes);
        let (name, on_card) = (&self.card.name, self.on_card);
        let of_ranks = if on_card > 1 { format!(" of {on_card} ranks") } else { String::new() };
        Err(refused(&format!("the solve takes {needed} of the card{of_ranks}, and {name} has {free} free of {total}")))
    }

    /// Card and memory in words.
    pub fn describe(&self) -> String {
        let [needed, free, total] = [self.bytes, self.card.free_bytes, self.card.total_bytes].map(readable_bytes);
        let card = format!("{}, {free} free of {total}", self.card.name);
        match (self.ranks, self.on_card) {
            (1, _) => format!("{card}; the solve takes about {needed}"),
            (ranks, 1) => format!("{card}; {ranks} ranks have a card each, of which the solve takes about {needed}"),
            (ranks, on_card) => {
                format!("{card}; {on_card} of {ranks} ranks share it, and the solve takes about {needed} for each")
            }
        }
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
    /// Refuses more ranks than a device serves: they divide the grid along z alone.
    pub fn check_ranks(&self, ranks: usize) -> Result<(), PlanError> {
        let [_, ny, nz] = self.grid;
        if self.device == ComputeDevice::Cpu || Place::of(ranks, 0, [ny, nz]).table()[0] == 1 {
            return Ok(());
        }
        let most = (1..ranks).rev().find(|&fewer| Place::of(fewer, 0, [ny, nz]).table()[0] == 1).unwrap_or(1);
        Err(refused(&format!("there are {ranks} ranks, and {most} GPUs at most share a grid of {nz} planes")))
    }

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

    /// Bytes of a solve with near pairs on a card, besides those of evaluations, and of the solutions that a run keeps.
    pub(crate) fn near_bytes(&self, particles: f64, pairs: NearPairCounts, steps: &CardSteps) -> f64 {
        let [stiff, soft] = [pairs.stiff, pairs.soft].map(|of_one| particles * of_one);
        let at_walls = self.boundaries.walls() > 0;
        let size = NearSize { numbers: self.numbers(), particles, stiff, soft, tables: pairs.tables, at_walls };
        size.bytes() + steps.bytes() * particles
    }

    /// Size of evaluations on a card, for particles with some neighbours within the cutoff each.
    pub(crate) fn size_on_card(&self, counts: CardCounts, neighbours: f64) -> EvaluationSize {
        let CardCounts { owned: particles, present, ranks } = counts;
        EvaluationSize {
            numbers: self.numbers(),
            grid: self.grid,
            devices: ranks,
            particles: present,
            classes: self.radii.len() as f64,
            neighbours: particles * neighbours,
            intervals: self.table_intervals().unwrap_or_default() as f64,
            solve: match self.boundaries {
                Boundaries::Periodic => SolveKind::Periodic,
                Boundaries::Open => SolveKind::Unbounded,
                _ => SolveKind::Channel,
            },
            images: self.images(particles * ranks as f64) * particles,
            random_vectors: 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
