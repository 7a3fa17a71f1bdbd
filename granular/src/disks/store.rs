//! Conversion to and from the particle store, from which a run continues bit for bit.

use super::stage::Law;
use super::state::{Body, Identity, Motion, State};
use super::verlet_list::List;
use super::{Disks, Model, Progress};
use crate::parameter::{ParameterError, refused, require};
use domain::{Particles, PeriodicBox, Vector};
use glam::DVec2;

/// Columns apart from velocity: `dt^k x^(k) / k!` for k = 2, 3, 4; and the data that determine the neighbour
/// list, as the time step has them, before wrapping: row, position, velocity, position when the list was
/// built, and lattice steps.
const GEAR: (&str, usize) = ("gear", 6);
const LIST: (&str, usize) = ("list", 9);

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
            particles.push(disk.id, wrapped.bodies[row].place.extend(0.0), disk.radius, disk.species);
        }
        let kept = |row: &usize| [wrapped.steps[*row][0], wrapped.steps[*row][1], 0];
        particles.steps = order.iter().map(kept).collect();
        let velocity = |&row: &usize| wrapped.bodies[row].velocity.extend(0.0).to_array();
        particles.column("velocity", 3).values = order.iter().flat_map(velocity).collect();
        let motions: Vec<Motion> = order.iter().map(|&row| state.motion(row)).collect();
        particles.column(GEAR.0, GEAR.1).values = motions.iter().flat_map(gear_row).collect();
        let list = order.iter().zip(&motions).flat_map(|(&row, motion)| list_row(row, motion));
        particles.column(LIST.0, LIST.1).values = list.collect();
        let touching = self.list.touching(self.step).collect();
        let (stage, step, list_made, tally) = (self.stage, self.step, self.list.born, self.tally);
        (particles, Progress { stage, step, list_made, tally, touching })
    }

    /// The state with all positions wrapped into the cell.
    pub(super) fn wrapped(&self) -> State {
        let mut state = self.state.clone();
        state.wrap(&self.cell(), &self.law, self.turns_since_list());
        state
    }

    /// Continues from a stored state. The parameters may differ from those of the stored run where
    /// that is physically sensible.
    pub fn resume(model: &Model, particles: &Particles, progress: &Progress) -> Result<Self, ParameterError> {
        let law = model.law(progress.stage);
        let mut state = State::stored(particles, model, (&model.cell(law.strain(progress.list_made)), law.dt))?;
        state.set_response(&law, model);
        let list = List::remake(&state, model, &law, progress);
        let (model, stage, step) = (model.clone(), progress.stage, progress.step);
        Ok(Self { model, stage, law, step, state, list, tally: progress.tally, lost: false })
    }
}

/// Refuses a reference position outside the box (up to round-off) or far from the disk.
fn check_place(motion: &Motion, cell: &PeriodicBox) -> Result<(), ParameterError> {
    let (edges, reference) = (cell.edges().truncate(), motion.reference);
    let inside = DVec2::new(reference.x - cell.strain() * reference.y, reference.y) / edges;
    let is_inside = inside.min_element() > -0.01 && inside.max_element() < 1.01;
    let is_near = (motion.body.place - reference).abs().max_element() < edges.min_element();
    require(is_inside && is_near, LIST.0, &reference, "a place in the box, and the disk near it")
}

/// Refuses a motion that carries a disk farther than the box in one step.
fn check_motion(motion: &Motion, cell: &PeriodicBox, dt: f64) -> Result<(), ParameterError> {
    let (shortest, [a, b, c], velocity) = (cell.edges().truncate().min_element(), motion.higher, motion.body.velocity);
    let is_less = |way: DVec2| way.abs().max_element() < shortest && way.is_finite();
    require(is_less(velocity * dt), LIST.0, &velocity, "a velocity with which a step is shorter than the box")?;
    let farthest = [a, b, c].into_iter().find(|&way| !is_less(way));
    require(farthest.is_none(), GEAR.0, &farthest.unwrap_or_default(), "ways of a step that are shorter than the box")
}

fn gear_row(motion: &Motion) -> [f64; GEAR.1] {
    let [a, b, c] = motion.higher;
    [a.x, a.y, b.x, b.y, c.x, c.y]
}

fn list_row(row: usize, motion: &Motion) -> [f64; LIST.1] {
    let (Body { place, velocity }, reference) = (motion.body, motion.reference);
    let [along, up] = motion.steps.map(f64::from);
    [row as f64, place.x, place.y, velocity.x, velocity.y, reference.x, reference.y, along, up]
}

fn motion_of(gear: &[f64], list: &[f64]) -> Motion {
    let pair = |row: &[f64], k: usize| DVec2::new(row[k], row[k + 1]);
    Motion {
        body: Body { place: pair(list, 1), velocity: pair(list, 3) },
        higher: [0, 2, 4].map(|k| pair(gear, k)),
        reference: pair(list, 5),
        steps: [list[7] as i32, list[8] as i32],
    }
}

impl State {
    /// Disks of a particle store that was not written by this driver, in its order. Without a column `velocity`
    /// they move with the liquid.
    pub(super) fn given(particles: &Particles, law: &Law, model: &Model) -> Result<Self, ParameterError> {
        let velocities = rows_of(particles, ("velocity", 3));
        let height = model.parameters().edges[1];
        let motion = |row: usize| {
            let place = particles.positions[row].truncate();
            let liquid = DVec2::new(law.profile.speed(place.y.rem_euclid(height)), 0.0);
            let velocity = velocities.as_ref().map_or(liquid, |rows| Vector::from_slice(rows[row]).truncate());
            let [along, up, _] = particles.steps[row];
            Motion { body: Body { place, velocity }, steps: [along, up], ..Motion::default() }
        };
        let motions: Vec<Motion> = (0..particles.len()).map(motion).collect();
        for Motion { body, .. } in &motions {
            require(body.place.is_finite(), "particles.position", &body.place, "finite numbers")?;
            require(body.velocity.is_finite(), "particles.velocity", &body.velocity, "finite numbers")?;
        }
        Ok(Self::new(identities(particles, model), &motions))
    }

    fn stored(particles: &Particles, model: &Model, (cell, dt): (&PeriodicBox, f64)) -> Result<Self, ParameterError> {
        let sizes = model.smallest()..=model.largest();
        let other = particles.radii.iter().find(|radius| !sizes.contains(radius));
        require(other.is_none(), "radius", other.unwrap_or(&0.0), "a radius that the scene has")?;
        let needed = |column: (&'static str, usize)| {
            let missing = "missing from the particles";
            rows_of(particles, column)
                .ok_or_else(|| refused(column.0, missing, "the columns that a checkpoint of disks has"))
        };
        let (gear, list) = (needed(GEAR)?, needed(LIST)?);
        let mut order: Vec<usize> = (0..particles.len()).collect();
        order.sort_by(|&a, &b| list[a][0].total_cmp(&list[b][0]));
        let motions: Vec<Motion> = order.iter().map(|&row| motion_of(gear[row], list[row])).collect();
        motions
            .iter()
            .try_for_each(|motion| check_place(motion, cell).and_then(|()| check_motion(motion, cell, dt)))?;
        Ok(Self::new(identities(&particles.selected(&order), model), &motions))
    }
}

fn identities(particles: &Particles, model: &Model) -> Vec<Identity> {
    let rows = particles.ids.iter().zip(&particles.species).zip(&particles.radii);
    Identity::all(rows.map(|((&id, &species), &radius)| (id, species, radius)), model)
}

/// Rows of the column of this name and width, if there is one.
fn rows_of<'a>(particles: &'a Particles, (name, width): (&str, usize)) -> Option<Vec<&'a [f64]>> {
    let column = particles.columns.iter().find(|c| c.name == name && c.width == width)?;
    (column.values.len() == width * particles.len()).then(|| column.values.chunks_exact(width).collect())
}
