//! Forces of the user that are registered with a suspension.

use crate::support::model_of;
use domain::{Comm, DomainView, Failure, Particles, Scalars, Vector};
use simulation::{Simulation, State};
use suspension::{
    Acting, Configuration, Force, Instant, Loads, Model, PairKind, PairLaw, PairwiseForce, Radii, Suspension,
    SuspensionRun, VELOCITY,
};

const SCENE: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 2.0
particles = { initial = "positions", positions = [[4.0, 6.0, 6.0], [7.0, 6.0, 6.0]] }
time = { step = 0.1, steps = 4 }
[[species]]
radius = 1.0
count = 2
"#;

/// A uniform motion of the fluid around the particles.
struct Wind(Vector);

impl Force for Wind {
    fn name(&self) -> &'static str {
        "wind"
    }

    fn add_present_loads(&self, _: &Configuration, _: &mut Loads) {}

    fn add_loads(&mut self, at: &mut Instant, acting: &mut Acting) -> Result<(), Failure> {
        acting.ambient.velocities = vec![self.0; at.particles.len()];
        Ok(())
    }
}

/// Ambient motions carry spheres along, where neither loads nor lubrication act on these two.
#[test]
fn spheres_go_with_ambient_motions() {
    let wind = Vector::new(0.3, -0.2, 0.1);
    for integrator in ["adams-bashforth", "implicit"] {
        let keys = [format!("time.integrator=\"{integrator}\"")];
        let model = model_of(SCENE, &keys.each_ref().map(String::as_str));
        for ranks in [1, 3] {
            let found = Comm::threads(ranks, |comm| {
                let mut suspension = Suspension::start(&model, &comm).unwrap();
                suspension.add_force(Box::new(Wind(wind))).unwrap();
                (0..4).for_each(|_| suspension.step().unwrap());
                suspension.gathered(Some(&[VELOCITY])).vectors(VELOCITY).to_vec()
            });
            assert!(found[0].iter().all(|&v| (v - wind).length() < 1e-12), "{keys:?}: {:?}", found[0]);
            assert_eq!(found[0].len(), 2);
        }
    }
}

/// A force across the line of centres.
struct Sideways;

impl PairLaw for Sideways {
    fn name(&self) -> &'static str {
        "sideways"
    }

    fn reach(&self, _: PairKind) -> f64 {
        4.0
    }

    fn force(&self, separation: Vector, _: PairKind) -> Vector {
        if separation.length() < 4.0 { Vector::Z.cross(separation) } else { Vector::ZERO }
    }

    fn is_central(&self) -> bool {
        false
    }
}

/// The force along y across faces normal to x is `r_x F_y / V`, and that along x across faces normal to y is none.
#[test]
fn a_stress_that_is_not_symmetric_has_nine_components() {
    let model = model_of(SCENE, &["flow={kind='shear',rate=0.5}"]);
    let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    run.add_force(Box::new(PairwiseForce::new(Sideways))).unwrap();
    let place = run.quantities().iter().position(|quantity| quantity.name == "stress_sideways").unwrap();
    let (columns, row) = (run.quantities()[place].columns(), run.observe()[place].clone());
    assert_eq!(columns.len(), 9);
    for (column, number) in columns.iter().zip(row) {
        let expected = if column.starts_with("stress_sideways_yx") { 3.0 * 3.0 / 12.0_f64.powi(3) } else { 0.0 };
        assert!((number - expected).abs() < 1e-15, "{column}: {number}");
    }
}

/// A repulsion that stiffens with the overlap of shells.
struct Shells;

impl PairLaw for Shells {
    fn name(&self) -> &'static str {
        "shells"
    }

    fn reach(&self, between: PairKind) -> f64 {
        between.contact() + 1.0
    }

    fn force(&self, separation: Vector, between: PairKind) -> Vector {
        let distance = separation.length();
        separation * (-50.0 * (self.reach(between) - distance).max(0.0) / distance)
    }

    fn is_implicit(&self) -> bool {
        true
    }

    fn stiffness(&self, gap: f64, _: PairKind) -> f64 {
        if gap < 1.0 { 50.0 } else { 0.0 }
    }
}

/// Under a given stress, the stress of the suspension with that of the force is the given one, within the tolerances of
/// the steps and of the search for the rate.
#[test]
fn its_stress_drives_a_flow() {
    let keys = [
        "flow={kind='shear',control='stress',stress=0.02}",
        "hydrodynamics.lubrication=true",
        "particles={initial='positions',positions=[[4.0,6.0,6.0],[6.2,6.8,6.3]]}",
        "time.integrator='implicit'",
    ];
    let mut run = SuspensionRun::start(&model_of(SCENE, &keys), None, &Comm::alone()).unwrap();
    run.add_force(Box::new(PairwiseForce::new(Shells))).unwrap();
    (0..4).for_each(|step| run.advance(step + 1).unwrap());
    let place = |name: &str| run.quantities().iter().position(|quantity| quantity.name == name).unwrap();
    let [shells, driving] = ["stress_shells", "shear_stress"].map(place);
    let row = run.observe();
    assert!(row[shells][1].abs() > 0.001, "{:?}", row[shells]);
    assert!((row[driving][0] - 0.02).abs() < 0.0004, "{:?}", row[driving]);
}

/// A force that warns of steps longer than one.
struct Slow;

impl Force for Slow {
    fn name(&self) -> &'static str {
        "slow"
    }

    fn add_present_loads(&self, _: &Configuration, _: &mut Loads) {}

    fn warnings(&self, model: &Model, radii: &Radii) -> Vec<String> {
        let is_long = model.time_step > 1.0 && radii.largest() > 0.0;
        is_long.then(|| "time.step is long for the force \"slow\"".to_owned()).into_iter().collect()
    }
}

/// Warnings of a force follow those of the start, once it is registered.
#[test]
fn its_warnings_are_those_of_the_run() {
    for (step, warned) in [("0.5", false), ("2.0", true)] {
        let model = model_of(SCENE, &[&format!("time.step={step}")]);
        let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
        let before = run.start_warnings();
        run.add_force(Box::new(Slow)).unwrap();
        let after = run.start_warnings();
        assert_eq!((&after[..before.len()], after.len() > before.len()), (&before[..], warned), "{after:?}");
    }
}

/// Profiles between walls have the stress of a registered force.
#[test]
fn profiles_have_its_stress() {
    let model = model_of(SCENE, &["box.boundaries=['periodic','periodic','walls']", "statistics={every=1}"]);
    let mut run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    run.add_force(Box::new(PairwiseForce::new(Shells))).unwrap();
    run.sample();
    let tables = run.averages().unwrap().tables;
    let profile = tables.iter().find(|table| table.name == "profile").unwrap();
    assert!(profile.columns.iter().any(|(name, _)| name.starts_with("pair_stress")), "{:?}", profile.columns);
}

/// A force along x that halves with each step: the number of steps so far is a scalar of the state.
struct Fading;

const STEPS: &str = "steps of the fading force";

impl Force for Fading {
    fn name(&self) -> &'static str {
        "fading"
    }

    fn add_present_loads(&self, at: &Configuration, loads: &mut Loads) {
        let steps = at.particles.scalars.numbers(STEPS).map_or(0.0, |[steps]| steps);
        loads.forces.resize(at.particles.len(), Vector::ZERO);
        loads.forces.iter_mut().for_each(|force| force.x += 0.5_f64.powf(steps));
    }

    fn end_step(&mut self, particles: &mut Particles, _: DomainView) -> Result<(), Failure> {
        let [steps] = particles.scalars.numbers(STEPS).unwrap_or_default();
        particles.scalars.set(STEPS, &[steps + 1.0]);
        Ok(())
    }
}

/// A resumed run has the bits of one that was not interrupted: the scalar of a registered force and those of the
/// integrators are in the saved state, in which the latter are columns, as in versions before scalars.
#[test]
fn its_scalars_survive_a_resumption() {
    for (integrator, former) in [("adams-bashforth", 1), ("adaptive", 3), ("implicit", 3)] {
        let model = model_of(SCENE, &[&format!("time.integrator=\"{integrator}\"")]);
        for ranks in [1, 3] {
            let all = Comm::threads(ranks, |comm| {
                let go_on = |mut suspension: Suspension, steps: u64| {
                    suspension.add_force(Box::new(Fading)).unwrap();
                    (0..steps).for_each(|_| suspension.step().unwrap());
                    suspension
                };
                let mut straight = go_on(Suspension::start(&model, &comm).unwrap(), 4);
                let saved = go_on(Suspension::start(&model, &comm).unwrap(), 2).state();
                let names: Vec<&str> = saved.particles.columns.iter().map(|column| &column.name[..]).collect();
                assert!(
                    names[names.len() - former..].iter().all(|name| name.contains("past") || name.contains("next"))
                );
                assert_eq!(saved.particles.scalars.iter().count(), 1);
                // Only the first rank has to provide the scalars.
                let given = if comm.is_first() { saved.particles.scalars.clone() } else { Scalars::default() };
                let state = State { particles: Particles { scalars: given, ..saved.particles }, ..saved };
                let mut resumed = go_on(Suspension::resume(&model, Some(state), &comm).unwrap(), 2);
                assert_eq!(resumed.state().particles.scalars.numbers(STEPS), Some([4.0]));
                (straight.state(), resumed.state())
            });
            for (straight, resumed) in all {
                assert_eq!(straight, resumed, "{integrator} on {ranks} ranks");
            }
        }
    }
}
