//! Forces of pairs by a law: of two particles, or of a particle and a wall.

use super::acting::{Acting, Configuration, Instant, Prediction};
use super::force::{Force, StressName};
use crate::neighbourhood::{PairsWithHalo, SeparatedPair};
use domain::{DomainView, Failure, Particles, PeriodicBox, Tensor, ToWall, Vector};
use fcm::Loads;
use lubrication::PairKind;
use std::ops::AddAssign;
use std::sync::Arc;

/// Law of a force between two particles, or between a particle and a wall.
pub trait PairLaw: Send + Sync + 'static {
    /// Name, also of its contribution to the stress.
    fn name(&self) -> &'static str;

    /// Distance of the centres, or of the centre from a wall, up to which it acts.
    fn reach(&self, between: PairKind) -> f64;

    /// Force on the first particle; `separation` points from its centre to that of the second one, or to the nearest
    /// point of a wall. The force on the second particle is opposite. Zero beyond the reach.
    fn force(&self, separation: Vector, between: PairKind) -> Vector;

    /// Whether the force is along the line of centres. The stress of another force need not be symmetric.
    fn is_central(&self) -> bool {
        true
    }

    /// Whether implicit steps take the force at their end, reduced by its [stiffness](Self::stiffness) times the
    /// separation. Other forces are explicit.
    fn is_implicit(&self) -> bool {
        false
    }

    /// Decrease of a repulsion with the distance, `-dF/dr`, at a gap between the surfaces; 0 where it is negative.
    fn stiffness(&self, _gap: f64, _between: PairKind) -> f64 {
        0.0
    }
}

/// Forces of all near pairs by laws of one type, which are added pair by pair.
pub struct PairwiseForce<L> {
    name: &'static str,
    laws: Arc<[L]>,
    /// Whether the solver adds the forces of pairs to the loads of solves.
    is_solved: bool,
}

impl<L: PairLaw> PairwiseForce<L> {
    /// The force of a law.
    pub fn new(law: L) -> Self {
        Self::of_laws(law.name(), vec![law])
    }

    /// The force of several laws.
    pub fn of_laws(name: &'static str, laws: Vec<L>) -> Self {
        Self { name, laws: laws.into(), is_solved: false }
    }

    /// The laws.
    pub fn laws(&self) -> &[L] {
        &self.laws
    }

    /// Leaves the forces of pairs in the loads of solves to the solver; those at walls remain.
    pub fn leave_to_solver(&mut self) {
        self.is_solved = true;
    }

    /// Whether the forces of pairs are left to the solver.
    pub fn is_left_to_solver(&self) -> bool {
        self.is_solved
    }

    /// Distance up to which any law acts; `None` without laws.
    pub fn reach(&self, between: PairKind) -> Option<f64> {
        self.laws.iter().map(|law| law.reach(between)).reduce(f64::max)
    }

    fn force(&self, separation: Vector, between: PairKind) -> Vector {
        self.laws.iter().map(|law| law.force(separation, between)).reduce(|sum, force| sum + force).unwrap_or_default()
    }

    /// Adds the loads of pairs and at walls, with a prediction those of [`predicted`] and [`predicted_at_wall`].
    fn add(&self, at: &Configuration, prediction: Option<&Prediction>, loads: &mut Loads) {
        let prediction = prediction.filter(|_| self.laws.iter().any(L::is_implicit));
        if let Some(near) = at.near.filter(|_| !self.laws.is_empty()) {
            self.add_of_pairs(near, prediction, loads);
            self.add_at_walls(at, prediction, loads);
        }
    }

    fn add_of_pairs(&self, near: &PairsWithHalo, prediction: Option<&Prediction>, loads: &mut Loads) {
        loads.forces.resize(near.owned(), Vector::ZERO);
        let added = prediction.map(|prediction| predicted(&self.laws, near, prediction)).unwrap_or_default();
        let on_pair = |(k, pair): (usize, SeparatedPair)| {
            let force = self.force(pair.separation, pair.radii.into());
            let force = force + added.get(k).copied().unwrap_or_default();
            [force, -force]
        };
        let sums = near.summed(near.pairs().enumerate().map(on_pair));
        loads.forces.iter_mut().zip(sums).for_each(|(force, sum)| *force += sum);
    }

    fn add_at_walls(&self, at: &Configuration, prediction: Option<&Prediction>, loads: &mut Loads) {
        let Configuration { particles, domain: DomainView { cell, .. }, .. } = at;
        if cell.boundaries().walls() == 0 {
            return;
        }
        loads.forces.resize(particles.len(), Vector::ZERO);
        let at_wall = |row, to: ToWall, radius| {
            let added = prediction.map(|prediction| predicted_at_wall(&self.laws, prediction, row, to, radius));
            self.force(to.axis * to.distance, PairKind::Wall(radius)) + added.unwrap_or_default()
        };
        add_at_walls(&mut loads.forces, particles, cell, at_wall);
    }
}

impl<L: PairLaw> Force for PairwiseForce<L> {
    fn name(&self) -> &'static str {
        self.name
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        self.add(at, None, loads);
    }

    /// With a prediction, the decrease of implicit forces at the predicted velocities is added back, so that the force
    /// minus resistance times velocity is exact at the predicted velocities and approximate at others.
    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        if self.is_solved {
            self.add_at_walls(&at.configuration(), None, &mut acting.loads);
            return Ok(());
        }
        self.add(&at.configuration(), at.prediction, &mut acting.loads);
        if let Some(prediction) = at.prediction.filter(|_| self.laws.iter().any(L::is_implicit)) {
            let (laws, time) = (self.laws.clone(), prediction.time);
            acting.resistances.add_pairs(Box::new(move |distance, between| resistance(&laws, time, distance, between)));
        }
        Ok(())
    }

    fn range(&self, largest_radius: f64) -> Option<f64> {
        self.reach([largest_radius; 2].into())
    }

    fn range_in_solves(&self, largest_radius: f64) -> Option<f64> {
        self.range(largest_radius).filter(|_| !self.is_solved)
    }

    fn stresses(&self) -> Vec<StressName> {
        self.laws.iter().map(|law| StressName { name: law.name(), is_symmetric: law.is_central() }).collect()
    }

    /// A pair at `x_i` and `x_j` with the force `F` on the first contributes `-(x_i - x_j) F / 2` to each; a sphere at
    /// a wall takes the whole moment, with the nearest point of the wall as `x_j`.
    fn moments(&self, at: &Configuration, beyond: Option<&Prediction>) -> Vec<Vec<Tensor>> {
        let Some(near) = at.near else { return Vec::new() };
        self.laws.iter().map(|law| moments(law, near, at, beyond.filter(|_| law.is_implicit()))).collect()
    }

    fn implicit_range(&self, largest_radius: f64) -> Option<f64> {
        let implicit = self.laws.iter().filter(|law| law.is_implicit());
        implicit.map(|law| law.reach([largest_radius; 2].into())).reduce(f64::max)
    }
}

/// First moments of one law, with the implicit change of its force `beyond` a prediction. Collective.
fn moments<L: PairLaw>(law: &L, near: &PairsWithHalo, at: &Configuration, beyond: Option<&Prediction>) -> Vec<Tensor> {
    let laws = std::slice::from_ref(law);
    let taken_back = beyond.map(|beyond| predicted(laws, near, beyond)).unwrap_or_default();
    let of_pair = |(k, SeparatedPair { separation, radii, .. }): (usize, SeparatedPair)| {
        let force = law.force(separation, radii.into()) - taken_back.get(k).copied().unwrap_or_default();
        let half = moment(law, separation, force) * 0.5;
        [half, half]
    };
    let mut moments = near.summed(near.pairs().enumerate().map(of_pair));
    let at_wall = |row, to: ToWall, radius| {
        let taken_back = beyond.map(|beyond| predicted_at_wall(laws, beyond, row, to, radius));
        let arm = to.axis * to.distance;
        let force = law.force(arm, PairKind::Wall(radius)) - taken_back.unwrap_or_default();
        moment(law, arm, force)
    };
    add_at_walls(&mut moments, at.particles, at.domain.cell, at_wall);
    moments
}

/// First moment of a force at an arm, see [`Force::moments`]; that of a central force is symmetric.
fn moment<L: PairLaw>(law: &L, arm: Vector, force: Vector) -> Tensor {
    let moment = Tensor::from_cols(arm * force.x, arm * force.y, arm * force.z);
    if law.is_central() { moment } else { moment.transpose() }
}

/// Decrease of the forces of a pair over a time in which it separates with unit velocity.
fn resistance<L: PairLaw>(laws: &[L], time: f64, distance: f64, between: PairKind) -> f64 {
    let gap = match between {
        PairKind::Spheres(radii) => distance - radii[0] - radii[1],
        PairKind::Wall(radius) => distance - radius,
    };
    let implicit = laws.iter().filter(|law| law.is_implicit());
    implicit.map(|law| time * law.stiffness(gap, between)).reduce(|sum, more| sum + more).unwrap_or(0.0)
}

/// For each pair, minus the change of the force on the first sphere by [`resistance`] at the predicted velocities.
/// Collective.
fn predicted<L: PairLaw>(laws: &[L], near: &PairsWithHalo, prediction: &Prediction) -> Vec<Vector> {
    let (relative, strain_rate) = (near.differences(prediction.velocities), prediction.strain_rate.tensor());
    let of_pair = |(SeparatedPair { separation, radii, .. }, velocity): (SeparatedPair, Vector)| {
        let distance = separation.length();
        let axis = separation / distance;
        axis * (-resistance(laws, prediction.time, distance, radii.into())
            * axis.dot(velocity + strain_rate * separation))
    };
    near.pairs().zip(relative).map(of_pair).collect()
}

/// [`predicted`] for a sphere and a wall; no flow has a velocity normal to the wall at the wall.
fn predicted_at_wall<L: PairLaw>(laws: &[L], prediction: &Prediction, row: usize, to: ToWall, radius: f64) -> Vector {
    let resistance = resistance(laws, prediction.time, to.distance, PairKind::Wall(radius));
    let velocity = prediction.velocities[row] - prediction.strain_rate.tensor() * (to.axis * to.distance);
    to.axis * (resistance * to.axis.dot(velocity))
}

/// Adds the contribution of each wall to each particle, as a function of its row, the wall and its radius.
fn add_at_walls<T: AddAssign>(
    sums: &mut [T],
    particles: &Particles,
    cell: &PeriodicBox,
    at_wall: impl Fn(usize, ToWall, f64) -> T,
) {
    if cell.boundaries().walls() == 0 {
        return;
    }
    for (row, sum) in sums.iter_mut().enumerate() {
        for to in cell.to_walls(particles.positions[row]) {
            *sum += at_wall(row, to, particles.radii[row]);
        }
    }
}
