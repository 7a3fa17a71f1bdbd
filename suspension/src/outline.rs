//! A scene in numbers, before it is run.

use crate::cautions::cautions;
use crate::error::StartError;
use crate::gap::Gap;
use crate::memory::{self, Ranks};
use crate::model::Model;
use crate::plan::problem;
use crate::setup::{Planned, Setup};
use domain::{Comm, Need, Number, Placed, readable_bytes};
use fcm::Plan;
use std::fmt::{Display, Formatter};

/// Plans that are named beside the one that was chosen.
const RUNNERS_UP: usize = 3;

/// What a run would be made of and what it would cost.
pub struct Outline {
    particles: usize,
    fraction: f64,
    /// Whether there is memory to place the particles.
    placed: bool,
    /// None for a sphere alone, and for particles that are not placed.
    gap: Option<Gap>,
    steps: u64,
    end: f64,
    plan: Plan,
    /// Other plans, the fastest first.
    others: Vec<Plan>,
    memory: Memory,
    cautions: Vec<String>,
}

/// The ranks that a run is thought to have.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// They, and their threads.
    pub ranks: Ranks,
    /// Ranks that share a machine.
    pub on_a_machine: usize,
}

/// What each rank needs, and whether this machine has it.
struct Memory {
    needs: Vec<Need>,
    missing: Option<String>,
}

impl Outline {
    /// The outline of a scene on ranks that need not be present. Collective.
    pub fn of(model: &Model, placed: Option<Placed>, asked: Asked, comm: &Comm) -> Result<Self, StartError> {
        let planned = Planned::of_model(model)?;
        let fits = |planned: &Planned| comm.check_room(memory::placing(model, &planned.radii)).is_ok();
        let (planned, placed, gap) = match planned {
            Some(planned) if comm.any(!fits(&planned)) => (planned, false, None),
            planned => {
                let setup = Setup::placed(model, placed, planned, comm)?;
                let gap = Some(setup.gap()).filter(|gap| gap.length.is_finite());
                (Planned { radii: setup.radii, plan: setup.plan }, true, gap)
            }
        };
        let mut others = Plan::ranked(&problem(model, &planned.radii))?;
        others.retain(|plan| *plan != planned.plan);
        Ok(Self {
            particles: planned.radii.count(),
            fraction: planned.radii.volume() / model.cell.volume(),
            placed,
            gap,
            steps: model.steps,
            end: model.end(),
            memory: Memory::of(model, &planned, asked),
            cautions: cautions(model, &planned.radii),
            plan: planned.plan,
            others,
        })
    }
}

impl Memory {
    fn of(model: &Model, planned: &Planned, asked: Asked) -> Self {
        let needs = memory::needs(model, (&planned.radii, &planned.plan), asked.ranks);
        // The first ranks share a machine, and the first of them needs the most.
        let together = &needs[..asked.on_a_machine.min(needs.len())];
        let missing = Comm::check_room_of(together).err();
        let remedy = memory::remedy(model, &planned.radii);
        Self { missing: missing.map(|error| format!("{error}, and `run` would refuse it here; {remedy}")), needs }
    }
}

impl Display for Memory {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let bytes = |need: &Need| readable_bytes(need.resident);
        let others = self.needs.iter().skip(1).max_by(|a, b| a.resident.total_cmp(&b.resident));
        write!(f, "memory     about {} at most on ", self.needs.first().map(bytes).unwrap_or_default())?;
        match others {
            None => writeln!(f, "1 rank"),
            Some(others) => {
                writeln!(f, "the first of {} ranks, {} on each of the others", self.needs.len(), bytes(others))
            }
        }
    }
}

impl Display for Outline {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "particles  {}, {:.4}% by volume", self.particles, Number(100.0 * self.fraction))?;
        self.gap.iter().try_for_each(|gap| write!(f, ", smallest gap {gap}"))?;
        write!(f, "{}", if self.placed { "" } else { ", not placed for want of memory" })?;
        writeln!(f)?;
        write!(f, "{}", self.plan.describe())?;
        writeln!(f, "steps      {}, until time {:.6}", self.steps, Number(self.end))?;
        write!(f, "{}", self.memory)?;
        let seconds = self.plan.predicted_seconds;
        writeln!(
            f,
            "cost       about {seconds:.2e} s on one core for an evaluation; with dipoles a step takes several"
        )?;
        for (number, plan) in self.others.iter().take(RUNNERS_UP).enumerate() {
            let label = if number == 0 { "instead" } else { "" };
            writeln!(f, "{label:<10} {:.2e} s: {}", plan.predicted_seconds, plan.in_short())?;
        }
        let warnings = self.memory.missing.iter().chain(&self.cautions);
        warnings.into_iter().try_for_each(|warning| writeln!(f, "warning: {warning}"))
    }
}
