//! Motion of the disks: one pass over all of them corrects one step and predicts the next.

use super::flow::VelocityProfile;
use super::for_each_part;
use super::gear::{Coordinate, Corrector};
use super::stage::Law;
use super::state::{Body, CHUNK, DiskBlock, DiskState, LANES, LaneValues};
use super::sums::MotionSums;
use glam::DVec2;
use simd::vectorised;

/// Task of a pass over the disks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PassTask {
    /// Measures in the present state, with its forces.
    Measure,
    /// Predicts the first step.
    Predict,
    /// Corrects the last step.
    Correct,
    /// Corrects a step and predicts the next.
    Both,
}

/// Parameters of a pass, the same for all disks.
#[derive(Clone, Copy)]
struct StepPass {
    corrector: Corrector,
    profile: VelocityProfile,
    /// Time from the construction of the neighbour list to the predicted step.
    age: f64,
    dt: f64,
}

/// Disks that one thread processes.
struct DiskRows<'a> {
    bodies: &'a mut [Body],
    blocks: &'a mut [DiskBlock],
    forces: &'a mut [DVec2],
    sums: MotionSums<LaneValues>,
}

impl DiskState {
    /// Does a task. `age` is the number of steps from the construction of the neighbour list to the predicted step.
    /// On request, measures in the corrected state.
    pub(super) fn advance(&mut self, law: &Law, task: PassTask, age: u64, measure: bool) -> MotionSums {
        let pass = StepPass { corrector: law.corrector(), profile: law.profile, age: age as f64 * law.dt, dt: law.dt };
        let mut parts = self.parts();
        for_each_part(&mut parts, |rows| match (task, measure) {
            (PassTask::Measure, _) => rows.pass::<false, true, false>(&pass),
            (PassTask::Predict, _) => rows.vectorised_pass::<false, false, true>(&pass),
            (PassTask::Correct, false) => rows.vectorised_pass::<true, false, false>(&pass),
            (PassTask::Correct, true) => rows.vectorised_pass::<true, true, false>(&pass),
            (PassTask::Both, false) => rows.vectorised_pass::<true, false, true>(&pass),
            (PassTask::Both, true) => rows.vectorised_pass::<true, true, true>(&pass),
        });
        parts.iter().fold(MotionSums::default(), |sum, rows| sum + rows.sums.total())
    }

    fn parts(&mut self) -> Vec<DiskRows<'_>> {
        let bodies = self.bodies.chunks_mut(CHUNK).zip(self.forces.chunks_mut(CHUNK));
        let rows = bodies.zip(self.blocks.chunks_mut(CHUNK / LANES));
        rows.map(|((bodies, forces), blocks)| DiskRows { bodies, blocks, forces, sums: MotionSums::default() })
            .collect()
    }

    /// Sets the higher derivatives from the forces, which are cleared: the acceleration is exact, the next two
    /// derivatives are those of the drag.
    pub(super) fn start(&mut self, law: &Law, masses: impl Fn(f64) -> f64) {
        for row in 0..self.len() {
            let mut motion = self.motion(row);
            let (radius, force) = (self.identities[row].radius, std::mem::take(&mut self.forces[row]));
            let (y, v, mass) = (motion.body.position.y, motion.body.velocity, masses(radius));
            let rate = law.drag(radius) / mass;
            let along = |x: f64| DVec2::new(x, 0.0);
            let a = force / mass - (v - along(law.profile.speed(y))) * rate;
            let slope = law.profile.slope(y);
            let jerk = (a - along(slope * v.y)) * -rate;
            let snap = (jerk - along(slope * a.y + law.profile.curvature() * v.y * v.y)) * -rate;
            let snap = if law.gear.derivatives() > 2 { snap } else { DVec2::ZERO };
            let dt = law.dt;
            motion.higher = [a * (dt * dt / 2.0), jerk * (dt.powi(3) / 6.0), snap * (dt.powi(4) / 24.0)];
            self.set_motion(row, &motion);
        }
    }
}

impl DiskRows<'_> {
    fn vectorised_pass<const CORRECT: bool, const MEASURE: bool, const PREDICT: bool>(&mut self, pass: &StepPass) {
        vectorised(
            #[inline(always)]
            || self.pass::<CORRECT, MEASURE, PREDICT>(pass),
        );
    }

    #[inline(always)]
    fn pass<const CORRECT: bool, const MEASURE: bool, const PREDICT: bool>(&mut self, pass: &StepPass) {
        // Local copies tell the compiler that nothing else writes to them.
        let (pass, mut sums) = (*pass, MotionSums::default());
        let DiskRows { bodies, blocks, forces, .. } = self;
        let disks = bodies.as_chunks_mut::<LANES>().0.iter_mut().zip(forces.as_chunks_mut::<LANES>().0);
        for ((bodies, forces), block) in disks.zip(blocks.iter_mut()) {
            if MEASURE {
                pass.measure(bodies, block, forces, &mut sums);
            }
            pass.advance::<CORRECT, PREDICT>(bodies, block, forces, &mut sums);
            if CORRECT {
                forces.fill(DVec2::ZERO);
            }
        }
        self.sums = sums;
    }
}

impl StepPass {
    #[inline(always)]
    fn advance<const CORRECT: bool, const PREDICT: bool>(
        &self,
        bodies: &mut [Body; LANES],
        block: &mut DiskBlock,
        forces: &[DVec2; LANES],
        sums: &mut MotionSums<LaneValues>,
    ) {
        for k in 0..LANES {
            let Body { position, velocity } = bodies[k];
            let mut x =
                Coordinate { x: position.x, v: velocity.x, q: [block.qx[0][k], block.qx[1][k], block.qx[2][k]] };
            let mut y =
                Coordinate { x: position.y, v: velocity.y, q: [block.qy[0][k], block.qy[1][k], block.qy[2][k]] };
            if CORRECT {
                let (kick, drag) = (block.kick[k], block.drag[k]);
                let excess = x.v - self.profile.speed(y.x);
                let half_kick = [forces[k].x * kick - excess * drag, forces[k].y * kick - y.v * drag];
                self.corrector.correct(&mut x, half_kick[0]);
                self.corrector.correct(&mut y, half_kick[1]);
            }
            if PREDICT {
                self.corrector.predict(&mut x);
                self.corrector.predict(&mut y);
                let carried = self.profile.speed(block.y0[k]) * self.age;
                let drift = [x.x - block.x0[k] - carried, y.x - block.y0[k]];
                let squared = drift[0] * drift[0] + drift[1] * drift[1];
                sums.drift_squared[k] = if squared > sums.drift_squared[k] { squared } else { sums.drift_squared[k] };
            }
            bodies[k] = Body { position: DVec2::new(x.x, y.x), velocity: DVec2::new(x.v, y.v) };
            for d in 0..3 {
                (block.qx[d][k], block.qy[d][k]) = (x.q[d], y.q[d]);
            }
        }
    }

    #[inline(always)]
    fn measure(
        &self,
        bodies: &[Body; LANES],
        block: &DiskBlock,
        forces: &[DVec2; LANES],
        sums: &mut MotionSums<LaneValues>,
    ) {
        for k in 0..LANES {
            let Body { position, velocity } = bodies[k];
            let (liquid, slope) = (self.profile.speed(position.y), self.profile.slope(position.y));
            let excess = [velocity.x - liquid, velocity.y];
            let mass = 0.5 * self.dt * self.dt / block.kick[k];
            let square = excess[0] * excess[0] + excess[1] * excess[1];
            let terms = [
                0.5 * mass * square,
                mass * excess[0] * excess[0],
                mass * excess[0] * excess[1],
                mass * excess[1] * excess[1],
                square.sqrt(),
                block.drag[k] / block.kick[k] * square,
                mass * slope * excess[0] * excess[1] + forces[k].x * liquid,
            ];
            sums.terms.iter_mut().zip(terms).for_each(|(sum, term)| sum[k] += term);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        DiskFlow, Gear, SpringContact,
        state::{DiskMotion, Identity},
    };
    use super::*;
    use std::f64::consts::PI;

    /// `dv/dt = U(y(t)) - v` with `U = 4/5 y - 2/25 y^2` and `y = 5/2 + 1 - exp(-t)`: the
    /// derivatives at the start by hand.
    #[test]
    fn a_start_has_the_derivatives_of_a_disk_that_crosses_a_parabolic_flow() {
        let law = Law {
            contact: SpringContact::new(1.0, false),
            viscosity: 1.0 / (6.0 * PI),
            profile: DiskFlow::Poiseuille { peak: 2.0 }.profile(10.0),
            gear: Gear::FiveValue,
            start_strain: 0.0,
            dt: 1.0,
            steps: None,
        };
        let disk = Identity { id: 0, species: 0, radius: 1.0, rank: 0, is_large: false, inverse_mass: 1.0 };
        let body = Body { position: DVec2::new(0.0, 2.5), velocity: DVec2::new(0.0, 1.0) };
        let mut state = DiskState::new(vec![disk], &[DiskMotion { body, ..DiskMotion::default() }]);
        state.start(&law, |_| 1.0);
        let derivatives = [DVec2::new(1.5, -1.0), DVec2::new(-1.1, 1.0), DVec2::new(0.54, -1.0)];
        for ((found, derivative), factorial) in state.motion(0).higher.iter().zip(derivatives).zip([2.0, 6.0, 24.0]) {
            assert!((*found - derivative / factorial).length() < 1e-15, "{found} is not {derivative} / {factorial}");
        }
    }
}
