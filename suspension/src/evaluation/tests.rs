use super::*;
use crate::model::{Parameters, Species, Start};
use domain::Comm;
use domain::PeriodicBox;
use fcm::SolveError;
use std::error::Error;

/// A failed solve is explained by an overlap, or by another reason.
#[test]
fn spheres_that_overlap_are_named_where_no_flow_is_found() {
    let cell = PeriodicBox::new(Vector::splat(14.0)).unwrap();
    let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], 0.05, 6);
    let start = Start::Positions(vec![Vector::splat(3.0), Vector::new(6.5, 3.0, 3.0)]);
    let model = Model::new(Parameters { start, ..usual }).unwrap();
    let (dynamics, mut particles) = Dynamics::new(&model, Setup::start(&model, None, &Comm::alone()).unwrap()).unwrap();
    for (distance, said) in
        [(3.5, "step 7: the motion"), (1.5, "step 7: spheres overlap by 0.5 (0.5 of the smallest radius), and")]
    {
        particles.positions[1] = particles.positions[0] + Vector::X * distance;
        let error = dynamics.unsolved(SolveError::NotFinite, &mut particles, 7);
        let cause = error.source().map_or_else(String::new, |cause| format!(": {cause}"));
        let message = format!("{error}{cause}");
        assert!(message.starts_with(said), "{message}");
    }
}
