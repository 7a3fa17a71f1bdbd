//! Relative motion of near pairs.

use crate::bodies;
use crate::evaluation::orders::ErrorEstimate;
use crate::flow::deformation::Deformation;
use crate::flow::periodic_cell::PeriodicCell;
use crate::model::Integrator;
use crate::neighbourhood::{PairsWithHalo, SeparatedPair};
use bytemuck::{Pod, Zeroable};
use domain::parallel::{MeasuredLoop, all_rows, change, copied, mapped, of_rows};
use domain::{Comm, DomainView, Particles, Partition, PeriodicBox, ToWall, Vector};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::AddAssign;

/// Largest centre distance of the pairs that are considered, over the largest radius.
pub const WATCHED: f64 = 3.0;

/// Distance of centres up to which an integrator considers pairs at each substep; `None` for one with fixed steps.
pub fn watched_range(integrator: &Integrator, largest_radius: f64) -> Option<f64> {
    let has_substeps = matches!(integrator, Integrator::Adaptive(_) | Integrator::Implicit(_));
    has_substeps.then_some(WATCHED * largest_radius)
}

/// Largest gap to a wall that is considered, over the radius.
const WATCHED_AT_WALLS: f64 = 1.0;

/// Number of pairs that one thread processes at a time.
const BATCH: usize = 1024;

/// Largest number of iterations in which pairs are moved apart.
pub const MOST_ROUNDS: usize = 100;

/// Relative tolerance of the gap of pairs that are moved apart.
pub const SLACK: f64 = 0.1;

/// Relative motion of near pairs, with `N` velocities of each: the present one and past ones.
pub struct RelativeMotion<const N: usize> {
    near: PairsWithHalo,
    pairs: Vec<MovingPair<N>>,
    at_walls: Vec<MovingAtWall<N>>,
    /// Numbers of the bodies of this rank's particles, if there are bodies.
    bodies: Option<Vec<f64>>,
    /// Deformation of separations by the flow, in addition.
    advection: Deformation,
}

struct MovingPair<const N: usize> {
    separation: Vector,
    velocities: [Vector; N],
    radii: [f64; 2],
}

/// A sphere, by its row, near a wall. Its velocities are along the axis, towards the wall, which is at rest.
struct MovingAtWall<const N: usize> {
    row: usize,
    to: ToWall,
    velocities: [f64; N],
    radius: f64,
}

impl<const N: usize> RelativeMotion<N> {
    /// Finds the near pairs of particles with velocities in the named columns. Collective.
    pub fn find(particles: &mut Particles, moving: &PeriodicCell, partition: &Partition, columns: [&str; N]) -> Self {
        let mut largest = [particles.radii.iter().copied().fold(0.0, f64::max)];
        partition.comm().max(&mut largest);
        let near = PairsWithHalo::find(particles, DomainView { cell: moving.cell(), partition }, WATCHED * largest[0]);
        Self::new(near, particles, moving, columns)
    }

    /// Relative motion of known near pairs, with velocities in the named columns. Collective.
    pub fn new(near: PairsWithHalo, particles: &mut Particles, moving: &PeriodicCell, columns: [&str; N]) -> Self {
        let velocities = columns.map(|name| copied(particles.vectors(name)));
        let at_walls = at_walls(particles, moving.cell(), velocities.each_ref());
        let pairs = near.map(&velocities, |SeparatedPair { separation, radii, steps }, velocities| {
            let image = moving.velocity_of_image(steps);
            MovingPair { separation, velocities: velocities.map(|velocity| velocity + image), radii }
        });
        let bodies = bodies::exist(particles).then(|| copied(bodies::numbers(particles)));
        Self { near, pairs, at_walls, bodies, advection: Deformation::NONE }
    }

    /// Lets the flow deform separations as well, after they changed by displacements.
    pub fn advected_by(&mut self, advection: Deformation) -> &Self {
        self.advection = advection;
        self
    }

    /// Change of gaps by the displacements `sum of weights[k] * velocity k`, with the errors relative to the second
    /// weights. Losses are relative to gaps of at least `least[0]` mean radii, errors to gaps of at least `least[1]`:
    /// smaller gaps count as that large. If `least[0]` is zero, overlapping spheres are ignored. Collective.
    pub fn after(&self, both: [[f64; N]; 2], least: [f64; 2], comm: &Comm) -> Change {
        let judge = |[after, lower]: [f64; 2]| (after, ErrorEstimate { error: (after - lower).abs(), roughness: 0.0 });
        self.changes(both, judge, least, comm)
    }

    /// [`Self::after`] with the weights of four orders, the highest first; the second one moves the spheres, and the
    /// error is that of [`ErrorEstimate`]. Collective.
    pub fn after_orders(&self, orders: [[f64; N]; 4], least: [f64; 2], comm: &Comm) -> Change {
        let judge = |gaps: [f64; 4]| {
            (gaps[1], ErrorEstimate::of(std::array::from_fn(|order| (gaps[order] - gaps[order + 1]).abs())))
        };
        self.changes(orders, judge, least, comm)
    }

    /// Change of gaps. `judge` returns the final gap and its error from the gaps after displacements with each of the
    /// weights. Collective.
    fn changes<const M: usize>(
        &self,
        weights: [[f64; N]; M],
        judge: impl Fn([f64; M]) -> (f64, ErrorEstimate) + Sync,
        least: [f64; 2],
        comm: &Comm,
    ) -> Change {
        let advection = self.advection;
        let of_pairs = |pairs: &[MovingPair<N>]| {
            let mut change = Change::NONE;
            for pair in pairs {
                let (after, estimate) = judge(weights.map(|weights| pair.gap_after(weights, advection)));
                change.note(pair.gap(), after, estimate, least.map(|least| least * pair.mean_radius()));
            }
            change
        };
        let mut change = self.pairs.par_chunks(BATCH).map(of_pairs).measured().reduce(|| Change::NONE, Change::worse);
        for sphere in &self.at_walls {
            let (after, estimate) = judge(weights.map(|weights| sphere.gap_after(weights)));
            change.note(sphere.gap(), after, estimate, least.map(|least| least * sphere.radius));
        }
        let mut least = [change.gap, -change.loss, -change.error, -change.roughness];
        comm.min(&mut least);
        Change { gap: least[0], loss: -least[1], error: -least[2], roughness: -least[3] }
    }

    /// Displacements, in addition to `sum of weights[k] * velocity k`, that give every pair a gap of at least `closest`
    /// mean radii, up to a tenth of that. Iteratively, pairs that are closer are moved apart along their lines of
    /// centres, the smaller sphere farther; a sphere of several such pairs, or a rigid body, moves by their mean.
    /// `None` if the iteration does not converge. Collective.
    pub fn apart(&self, weights: [f64; N], closest: f64, comm: &Comm) -> Option<Vec<Vector>> {
        let (displacements, is_done) = self.pushed(weights, closest, comm);
        is_done.then_some(displacements)
    }

    /// [`Self::apart`] as far as the iteration comes, and whether it converged. Collective.
    pub fn pushed(&self, weights: [f64; N], closest: f64, comm: &Comm) -> (Vec<Vector>, bool) {
        let (pairs, advection) = (&self.pairs, self.advection);
        let separations = mapped(pairs, |pair| pair.separation_after(weights, advection));
        let mut displacements = of_rows(self.near.owned(), |_| Vector::ZERO);
        for _ in 0..MOST_ROUNDS {
            let between = self.near.differences(&displacements);
            let pushes = of_rows(pairs.len(), |k| pairs[k].push(separations[k] + between[k], closest));
            let by_walls: Vec<(usize, Push)> =
                self.at_walls.iter().filter_map(|sphere| sphere.push(weights, &displacements, closest)).collect();
            let are_apart = by_walls.is_empty() && all_rows(pushes.len(), |k| pushes[k][0].pairs == 0.0);
            if !comm.any(!are_apart) {
                return (displacements, true);
            }
            let mut sums = self.near.summed(pushes.into_iter());
            for (row, push) in by_walls {
                sums[row] += push;
            }
            self.share(&mut sums, comm);
            change(&mut displacements, &sums, |displacement, push| {
                if push.pairs > 0.0 {
                    *displacement += push.displacement / push.pairs;
                }
            });
        }
        (displacements, false)
    }

    /// Gives all spheres of a rigid body the sum of their pushes. Collective.
    fn share(&self, pushes: &mut [Push], comm: &Comm) {
        let Some(bodies) = &self.bodies else { return };
        let own = bodies.iter().zip(&*pushes).filter(|(body, push)| **body >= 0.0 && push.pairs > 0.0);
        let own: Vec<OfBody> = own.map(|(&body, &push)| OfBody { body, push }).collect();
        let mut sums: BTreeMap<u64, Push> = BTreeMap::new();
        for OfBody { body, push } in comm.all_gather(&own) {
            *sums.entry(body as u64).or_default() += push;
        }
        for (&body, push) in bodies.iter().zip(pushes).filter(|(body, _)| **body >= 0.0) {
            *push = sums.get(&(body as u64)).copied().unwrap_or_default();
        }
    }
}

/// Change of gaps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Smallest gap before.
    pub gap: f64,
    /// Largest relative loss of a gap.
    pub loss: f64,
    /// Largest relative error of a gap.
    pub error: f64,
    /// Largest relative roughness of a gap, see [`ErrorEstimate::roughness`].
    pub roughness: f64,
}

impl Change {
    /// Change without any gaps.
    const NONE: Self = Self { gap: f64::INFINITY, loss: 0.0, error: 0.0, roughness: 0.0 };

    /// The worse of two changes.
    fn worse(self, other: Self) -> Self {
        Self {
            gap: self.gap.min(other.gap),
            loss: self.loss.max(other.loss),
            error: self.error.max(other.error),
            roughness: self.roughness.max(other.roughness),
        }
    }

    /// Takes a gap before and after and its error into account, relative to gaps of at least `least`.
    fn note(&mut self, gap: f64, after: f64, estimate: ErrorEstimate, least: [f64; 2]) {
        self.gap = self.gap.min(gap);
        let sizes = least.map(|least| gap.max(least));
        if sizes[0] > 0.0 {
            self.loss = self.loss.max((gap - after) / sizes[0]);
            self.error = self.error.max(estimate.error / sizes[1]);
            self.roughness = self.roughness.max(estimate.roughness / sizes[1]);
        }
    }
}

/// Displacement of a sphere away from others: sum of the displacements that its pairs demand, and their number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Push {
    displacement: Vector,
    pairs: f64,
}

/// Push of a sphere of a body.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct OfBody {
    body: f64,
    push: Push,
}

impl AddAssign for Push {
    fn add_assign(&mut self, other: Self) {
        self.displacement += other.displacement;
        self.pairs += other.pairs;
    }
}

/// Spheres near walls.
fn at_walls<const N: usize>(
    particles: &Particles,
    cell: &PeriodicBox,
    velocities: [&Vec<Vector>; N],
) -> Vec<MovingAtWall<N>> {
    if cell.boundaries().walls() == 0 {
        return Vec::new();
    }
    let of_row = |(row, (&place, &radius)): (usize, (&Vector, &f64))| {
        let (own, watched) = (velocities.map(|of| of[row]), (1.0 + WATCHED_AT_WALLS) * radius);
        let near = cell.to_walls(place).filter(move |to| to.distance < watched);
        near.map(move |to| MovingAtWall { row, to, velocities: own.map(|v| v.dot(to.axis)), radius })
    };
    particles.positions.iter().zip(&particles.radii).enumerate().flat_map(of_row).collect()
}

impl<const N: usize> MovingAtWall<N> {
    fn gap(&self) -> f64 {
        self.to.distance - self.radius
    }

    fn gap_after(&self, weights: [f64; N]) -> f64 {
        self.gap() - self.velocities.iter().zip(weights).map(|(v, w)| v * w).sum::<f64>()
    }

    /// [`MovingPair::push`] for a wall, given the displacements so far.
    fn push(&self, weights: [f64; N], displacements: &[Vector], closest: f64) -> Option<(usize, Push)> {
        let gap = self.gap_after(weights) - displacements[self.row].dot(self.to.axis);
        let wanted = closest * self.radius;
        let missing = wanted - gap;
        (missing > SLACK * wanted).then(|| (self.row, Push { displacement: -self.to.axis * missing, pairs: 1.0 }))
    }
}

impl<const N: usize> MovingPair<N> {
    fn mean_radius(&self) -> f64 {
        0.5 * (self.radii[0] + self.radii[1])
    }

    fn gap(&self) -> f64 {
        self.separation.length() - 2.0 * self.mean_radius()
    }

    fn separation_after(&self, weights: [f64; N], advection: Deformation) -> Vector {
        let moved = self.separation + self.velocities.iter().zip(weights).map(|(&v, w)| v * w).sum::<Vector>();
        advection.of(moved)
    }

    fn gap_after(&self, weights: [f64; N], advection: Deformation) -> f64 {
        self.separation_after(weights, advection).length() - 2.0 * self.mean_radius()
    }

    /// Displacements that give the spheres a gap of `closest` mean radii, if it falls short of that by more than the
    /// tolerance.
    fn push(&self, separation: Vector, closest: f64) -> [Push; 2] {
        let (distance, gap) = (separation.length(), closest * self.mean_radius());
        let missing = gap + 2.0 * self.mean_radius() - distance;
        if missing <= SLACK * gap {
            return [Push::default(); 2];
        }
        let sum = self.radii[0] + self.radii[1];
        // Spheres with coincident centres are moved apart along x.
        let apart = if distance > 0.0 { separation * (missing / distance / sum) } else { Vector::X * (missing / sum) };
        [-apart * self.radii[1], apart * self.radii[0]].map(|displacement| Push { displacement, pairs: 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Protocol, ShearRates};
    use domain::PeriodicBox;
    use simulation::Clock;

    const VELOCITY: &str = "velocity";

    /// A chain of nearly touching spheres, compressed from both ends across a face of the box.
    fn chain() -> Particles {
        let mut particles = Particles::default();
        for (id, (x, radius, velocity)) in [(9.0, 1.0, 0.1), (0.5, 0.5, 0.0), (2.0, 1.0, -0.2)].into_iter().enumerate()
        {
            particles.push(id as u64, Vector::new(x, 5.0, 5.0), radius, 0);
            particles.vectors(VELOCITY)[id] = velocity * Vector::X;
        }
        particles
    }

    #[test]
    fn a_chain_that_is_pressed_keeps_its_gaps_on_any_ranks() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 2, 3, 13, 64] {
            let all = Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let mut particles = if comm.is_first() { chain() } else { Particles::default() };
                particles.vectors(VELOCITY);
                particles.migrate(&partition, &cell);
                let moving =
                    PeriodicCell::at(&Clock::at(0, 1.0), cell, ShearRates::new(0.0, Protocol::STEADY, 1.0), true);
                let approach = RelativeMotion::find(&mut particles, &moving, &partition, [VELOCITY]);
                let apart = approach.apart([1.0], 1e-3, &comm).expect("an end");
                let moved: Vec<Vector> = particles.vectors(VELOCITY).iter().zip(&apart).map(|(&v, &a)| v + a).collect();
                particles.vectors("moved").copy_from_slice(&moved);
                particles.gathered(&partition)
            });
            let mut all = all.into_iter().next().unwrap();
            let moved = all.vectors("moved").to_vec();
            let place = |i: usize| all.positions[i].x + moved[i].x;
            let gaps = [place(1) + 10.0 - place(0) - 1.5, place(2) - place(1) - 1.5];
            assert!(gaps.iter().all(|gap| (0.6e-3..1.2e-3).contains(gap)), "{gaps:?} on {ranks} ranks");
            assert!(moved.iter().all(|m| m.y == 0.0 && m.z == 0.0));
        }
    }

    #[test]
    fn what_keeps_its_gap_stays_where_it_is() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let moving = PeriodicCell::at(&Clock::at(0, 1.0), cell, ShearRates::new(0.0, Protocol::STEADY, 1.0), true);
        let mut particles = chain();
        let approach = RelativeMotion::find(&mut particles, &moving, &partition, [VELOCITY]);
        let apart = approach.apart([-1.0], 1e-3, &Comm::alone());
        assert_eq!(apart, Some(vec![Vector::ZERO; 3]));
    }
}
