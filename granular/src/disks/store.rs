//! Conversion to and from the particle store, from which a run continues bit for bit.

use super::stage::Law;
use super::state::{Body, DiskMotion, DiskState, Identity};
use super::verlet_list::List;
use super::{DiskModel, Disks, Progress};
use crate::parameter::{Components, ParameterError, refused, require};
use domain::{Number, Particles, PeriodicBox, Vector};
use glam::DVec2;
use simulation::Clock;

/// Columns apart from velocity: `dt^k x^(k) / k!` for k = 2, 3, 4; and the data that determine the neighbour
/// list, as the time step has them, before wrapping: row, position, velocity, position when the list was
/// built, and lattice steps.
const GEAR: &str = "gear";
const LIST: &str = "list";

impl Disks {
    /// The state: particles in the order of their ids, positions inside the box, and the progress of the run.
    pub fn store(&self) -> (Particles, Progress) {
        let state = &self.state;
        let mut order: Vec<usize> = (0..state.len()).collect();
        order.sort_by_key(|&row| state.identities[row].id);
        let wrapped = self.wrapped();
        let mut particles = Particles::default();
        for &row in &order {
            let disk = &state.identities[row];
            particles.push(disk.id, wrapped.bodies[row].position.extend(0.0), disk.radius, disk.species);
        }
        let kept = |row: &usize| [wrapped.steps[*row][0], wrapped.steps[*row][1], 0];
        particles.steps = order.iter().map(kept).collect();
        let velocity = |&row: &usize| wrapped.bodies[row].velocity.extend(0.0).to_array();
        particles.column("velocity", 3).values = order.iter().flat_map(velocity).collect();
        let motions: Vec<DiskMotion> = order.iter().map(|&row| state.motion(row)).collect();
        let gear = |motion: &DiskMotion| bytemuck::cast::<_, [f64; 6]>(motion.higher);
        particles.column(GEAR, 6).values = motions.iter().flat_map(gear).collect();
        let list = order.iter().zip(&motions).flat_map(|(&row, motion)| list_row(row, motion));
        particles.column(LIST, 9).values = list.collect();
        let touching = self.list.touching(self.clock.step()).collect();
        let (stage, step, list_built, tally) = (self.stage, self.clock.step(), self.list.built_at_step, self.tally);
        (particles, Progress { stage, step, list_built, tally, touching })
    }

    /// The state with all positions wrapped into the cell.
    pub(super) fn wrapped(&self) -> DiskState {
        let mut state = self.state.clone();
        state.wrap(&self.cell(), &self.law, self.lattice_shifts_since_list());
        state
    }

    /// Continues from a stored state. The parameters may differ from those of the stored run where
    /// that is physically sensible.
    pub fn resume(model: &DiskModel, particles: &Particles, progress: &Progress) -> Result<Self, ParameterError> {
        let law = model.law(progress.stage);
        let mut state = DiskState::stored(particles, model, &model.cell(law.strain(progress.list_built)), law.dt)?;
        state.set_response(&law, model);
        let list = List::rebuild(&state, model, &law, progress);
        let (model, stage, clock) = (model.clone(), progress.stage, Clock::at(progress.step, law.dt));
        Ok(Self { model, stage, law, clock, state, list, tally: progress.tally, escaped: false })
    }
}

/// Refuses a reference position outside the box (up to round-off) or far from the disk.
fn check_position(motion: &DiskMotion, cell: &PeriodicBox) -> Result<(), ParameterError> {
    let (edges, reference) = (cell.edges().truncate(), motion.reference);
    let inside = DVec2::new(reference.x - cell.strain() * reference.y, reference.y) / edges;
    let is_inside = inside.min_element() > -0.01 && inside.max_element() < 1.01;
    let is_near = (motion.body.position - reference).abs().max_element() < edges.min_element();
    require(is_inside && is_near, LIST, Components(reference.to_array()), "a place in the box, and the disk near it")
}

/// Refuses a motion that carries a disk farther than the box in one step.
fn check_motion(motion: &DiskMotion, cell: &PeriodicBox, dt: f64) -> Result<(), ParameterError> {
    let (shortest, [a, b, c], velocity) = (cell.edges().truncate().min_element(), motion.higher, motion.body.velocity);
    let is_less = |way: DVec2| way.abs().max_element() < shortest && way.is_finite();
    let allowed = "a velocity with which a step is shorter than the box";
    require(is_less(velocity * dt), LIST, Components(velocity.to_array()), allowed)?;
    let farthest = [a, b, c].into_iter().find(|&way| !is_less(way));
    let found = Components(farthest.unwrap_or_default().to_array());
    require(farthest.is_none(), GEAR, found, "ways of a step that are shorter than the box")
}

fn list_row(row: usize, motion: &DiskMotion) -> [f64; 9] {
    let (Body { position, velocity }, reference) = (motion.body, motion.reference);
    let [along, up] = motion.steps.map(f64::from);
    [row as f64, position.x, position.y, velocity.x, velocity.y, reference.x, reference.y, along, up]
}

fn motion_of(gear: [f64; 6], list: [f64; 9]) -> DiskMotion {
    let [_, x, y, u, v, x0, y0, along, up] = list;
    DiskMotion {
        body: Body { position: DVec2::new(x, y), velocity: DVec2::new(u, v) },
        higher: bytemuck::cast(gear),
        reference: DVec2::new(x0, y0),
        steps: [along as i32, up as i32],
    }
}

impl DiskState {
    /// Disks of a particle store that was not written by this driver, in its order. Without a column `velocity`
    /// they move with the liquid.
    pub(super) fn given(particles: &Particles, law: &Law, model: &DiskModel) -> Result<Self, ParameterError> {
        let velocities = particles.rows::<3>("velocity");
        let height = model.parameters().edges[1];
        let motion = |row: usize| {
            let position = particles.positions[row].truncate();
            let liquid = DVec2::new(law.profile.speed(position.y.rem_euclid(height)), 0.0);
            let velocity = velocities.map_or(liquid, |rows| Vector::from_array(rows[row]).truncate());
            let [along, up, _] = particles.steps[row];
            DiskMotion { body: Body { position, velocity }, steps: [along, up], ..DiskMotion::default() }
        };
        let motions: Vec<DiskMotion> = (0..particles.len()).map(motion).collect();
        for DiskMotion { body, .. } in &motions {
            let [position, velocity] = [body.position, body.velocity].map(|vector| Components(vector.to_array()));
            require(body.position.is_finite(), "particles.position", position, "finite numbers")?;
            require(body.velocity.is_finite(), "particles.velocity", velocity, "finite numbers")?;
        }
        Ok(Self::new(Identity::all(particles, model), &motions))
    }

    fn stored(particles: &Particles, model: &DiskModel, cell: &PeriodicBox, dt: f64) -> Result<Self, ParameterError> {
        let sizes = model.smallest()..=model.largest();
        let other = particles.radii.iter().find(|radius| !sizes.contains(radius));
        require(other.is_none(), "radius", Number(*other.unwrap_or(&0.0)), "a radius that the scene has")?;
        let missing = |name| refused(name, "missing from the particles", "the columns that a checkpoint of disks has");
        let gear = particles.rows(GEAR).ok_or_else(|| missing(GEAR))?;
        let list = particles.rows(LIST).ok_or_else(|| missing(LIST))?;
        let mut order: Vec<usize> = (0..particles.len()).collect();
        order.sort_by(|&a, &b| list[a][0].total_cmp(&list[b][0]));
        let motions: Vec<DiskMotion> = order.iter().map(|&row| motion_of(gear[row], list[row])).collect();
        for motion in &motions {
            check_position(motion, cell)?;
            check_motion(motion, cell, dt)?;
        }
        Ok(Self::new(Identity::all(&particles.selected(&order), model), &motions))
    }
}
