//! A scene in numbers, before it is run.

use super::cautions::cautions;
use super::gap::Gap;
use super::plan::problem;
use super::setup::Setup;
use domain::{Comm, Number};
use fcm::Plan;
use io::SuspensionScene;
use std::fmt::{Display, Formatter};

/// Plans that are named beside the one that was chosen.
const RUNNERS_UP: usize = 3;

/// Bytes of a particle: 6 numbers for itself, 4 velocities, an angular velocity and 4 stresslets.
const BYTES_A_PARTICLE: u64 = 8 * (6 + 4 * 3 + 3 + 4 * 5);

/// What a run would be made of and what it would cost.
pub struct Outline {
    particles: usize,
    fraction: f64,
    /// None for a sphere alone.
    gap: Option<Gap>,
    steps: u64,
    end: f64,
    plan: Plan,
    /// Other plans, the fastest first.
    others: Vec<Plan>,
    ranks: usize,
    cautions: Vec<String>,
}

impl Outline {
    /// The outline of a scene on the ranks present. Collective.
    pub fn of(scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<Self> {
        let setup = Setup::start(scene, comm)?;
        let mut others = Plan::ranked(&problem(scene, &setup.radii))?;
        others.retain(|plan| *plan != setup.plan);
        let cautions = cautions(scene, &setup.radii);
        Ok(Self {
            particles: setup.radii.count(),
            fraction: setup.radii.volume() / scene.cell.volume(),
            gap: Some(setup.gap()).filter(|gap| gap.length.is_finite()),
            steps: scene.time.steps,
            end: scene.time.end(),
            plan: setup.plan,
            others,
            ranks: comm.size(),
            cautions,
        })
    }

    fn bytes_per_rank(&self) -> u64 {
        self.plan.grid_bytes_per_rank(self.ranks) + BYTES_A_PARTICLE * self.particles.div_ceil(self.ranks) as u64
    }
}

impl Display for Outline {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(f, "particles  {}, {:.4}% by volume", self.particles, Number(100.0 * self.fraction))?;
        self.gap.iter().try_for_each(|gap| write!(f, ", smallest gap {gap}"))?;
        writeln!(f)?;
        write!(f, "{}", self.plan.describe())?;
        writeln!(f, "steps      {}, until time {:.6}", self.steps, Number(self.end))?;
        writeln!(f, "memory     about {:.1} MB on each of {} rank(s)", self.bytes_per_rank() as f64 / 1e6, self.ranks)?;
        let seconds = self.plan.predicted_seconds;
        writeln!(
            f,
            "cost       about {seconds:.2e} s on one core for an evaluation; with dipoles a step takes several"
        )?;
        for (number, plan) in self.others.iter().take(RUNNERS_UP).enumerate() {
            let label = if number == 0 { "instead" } else { "" };
            writeln!(f, "{label:<10} {:.2e} s: {}", plan.predicted_seconds, plan.in_short())?;
        }
        self.cautions.iter().try_for_each(|caution| writeln!(f, "warning: {caution}"))
    }
}
