//! An implicit substep of rough spheres.

use super::{CountedCase, STEP, STEPS_BEFORE, STRAIN, VELOCITY, advance, extrapolated};
use domain::{ColumnValues, Particles, PeriodicBox, RemoteList, Tensor};
use fcm::{
    DisplacementOrders, DisplacementWeights, HeldVelocities, Loads, MovingFlow, SeparationLimits, SolutionColumns,
};
use hydrodynamics::{CoupledSolver, HeldContacts, HeldForces, HeldPrediction, SolveInput, StrainRate, TooManyContacts};
use lubrication::{Contact, Elasticity, LubricationRange};
use solver::BackgroundFlow;
use std::collections::VecDeque;
use std::error::Error;
use std::rc::Rc;

/// Column of predicted velocities.
pub const EXPECTED: &str = "expected velocity";

/// Column of the states of contacts, their slots, and the numbers of one.
const CONTACTS: &str = "contacts";
const SLOTS: usize = 15;
const NUMBERS: usize = 10;

/// Law of the contacts.
const LAW: Contact = Contact {
    friction: 0.5,
    roughness: 0.05,
    stiffness: 2e3,
    tangential_ratio: 0.4,
    rolling_friction: 0.0,
    critical_load: 0.0,
    elasticity: Elasticity::Linear,
};

/// Separation of spheres, as in runs, with the distance of centres up to which substeps consider pairs.
const LIMITS: SeparationLimits =
    SeparationLimits { closest: LubricationRange::MINIMUM_GAP, slack: 0.1, rounds: 100, reach: 3.0 * 1.4 };

/// Message of an error, which would be a mistake in this program.
const ELSEWHERE: &str = "the card moves no particles";

impl CountedCase {
    /// Takes an implicit substep of rough spheres, at the last strain. Returns the number of iterations.
    pub fn substep(
        &self,
        on_card: &mut CoupledSolver,
        moving: &mut Particles,
        past: &mut VecDeque<SolutionColumns>,
    ) -> Result<usize, Box<dyn Error>> {
        let (cell, flow) = (self.cell(STRAIN + STEPS_BEFORE as f64 * STEP)?, BackgroundFlow::shear(1.0));
        let displacement = MeasuredMove { cell: &cell, flow: &flow, columns: [VELOCITY, VELOCITY], step: STEP };
        displacement.take(on_card, moving)?;
        let expected = held(on_card, moving, EXPECTED)?;
        let (previous, none) = (history(moving), Loads::default());
        let contacts = HeldContacts {
            law: &LAW,
            slots: SLOTS,
            times: [STEP; 2],
            expected: Some(&expected),
            history: previous.as_ref(),
            previous: None,
            flow: MovingFlow::carrying(flow),
        };
        let loads = on_card
            .contact_loads(&cell, moving, &contacts)
            .map_err(|TooManyContacts { id }| format!("sphere {id} has more than {SLOTS} contacts"))?;
        let prediction = Some(HeldPrediction { time: STEP, velocities: expected.clone() });
        let forces = HeldForces { prediction, contacts: Some(loads) };
        let shear = SolveInput::new(&none, StrainRate::uniform(flow.strain_rate()));
        let input = SolveInput {
            keeps_columns: true,
            moving_in: Some(MovingFlow::carrying(flow)),
            held_forces: Some(&forces),
            ..shear
        };
        let solution = on_card.solve(&cell, moving, &input, extrapolated(past.make_contiguous()))?;
        let columns = solution.kept.ok_or("the card keeps no solutions")?.columns;
        let [.., velocity, rotation] = &columns.guessed;
        let motions = [velocity, rotation].map(|values| values.remote_list().expect(ELSEWHERE));
        let found = on_card.contact_ends(motions, &contacts);
        moving.set_column(CONTACTS, NUMBERS * SLOTS, found);
        if let Some([velocities, _]) = &columns.moving {
            moving.set_column(VELOCITY, 3, velocities.clone());
        }
        MeasuredMove { columns: [VELOCITY, EXPECTED], ..displacement }.take(on_card, moving)?;
        Ok(solution.iterations)
    }
}

/// State of the contacts, if they are known.
fn history(moving: &Particles) -> Option<RemoteList> {
    let known = moving.columns.iter().find(|column| column.name == CONTACTS);
    known.and_then(|column| column.values.remote_list()).cloned()
}

/// A column on the card.
fn held(on_card: &CoupledSolver, moving: &mut Particles, name: &str) -> Result<RemoteList, Box<dyn Error>> {
    Ok(moving.held_column(name, 3, on_card.holder().ok_or(ELSEWHERE)?))
}

/// A displacement by the first column of velocities, which is predicted if both are the same, or by the difference from
/// the second one.
struct MeasuredMove<'a> {
    cell: &'a PeriodicBox,
    flow: &'a BackgroundFlow,
    columns: [&'static str; 2],
    step: f64,
}

impl MeasuredMove<'_> {
    /// Measures the displacement, displaces the particles, and wraps them into the box.
    fn take(&self, on_card: &mut CoupledSolver, moving: &mut Particles) -> Result<(), Box<dyn Error>> {
        let &MeasuredMove { cell, flow, columns, step } = self;
        on_card.mobility().follow(cell, moving);
        let (steps, is_predicted) = (Rc::clone(on_card.steps().ok_or(ELSEWHERE)?), columns[0] == columns[1]);
        let positions = moving.positions.remote_list().ok_or(ELSEWHERE)?.clone();
        let lists = [held(on_card, moving, columns[0])?, held(on_card, moving, columns[1])?];
        let deformation = Tensor::IDENTITY;
        let velocities = HeldVelocities { positions: &positions, columns: &lists, flow, deformation };
        let weights: DisplacementWeights = [step, if is_predicted { 0.0 } else { -step }, 0.0, 0.0];
        let orders = [weights, [0.0; 4]];
        let orders = DisplacementOrders::Two(&orders);
        steps.gap_changes(&velocities, &orders, [LubricationRange::MINIMUM_GAP, 1e-4], LIMITS.reach);
        steps.moved_apart(&velocities, &weights, &LIMITS);
        if is_predicted {
            let expected = steps.combined(&[(lists[0].clone(), 1.0)]);
            moving.set_column(EXPECTED, 3, ColumnValues::remote(expected));
        } else {
            steps.displacement_error(&lists, &orders);
        }
        moving.displace_by(columns, [weights[0], weights[1]]);
        advance(on_card, moving, cell);
        Ok(())
    }
}
