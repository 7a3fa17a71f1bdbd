//! Lattices, in which symmetry makes the errors of neighbours equal, and residuals orthogonal to whole directions.

use domain::{Bytes, Comm, PeriodicBox, Tensor, Vector};
use fcm::Loads;
use lubrication::LubricationRange;
use solver::BackgroundFlow;
use std::f64::consts::PI;
use suspension::{Mobility, MobilityParameters, Motions};

const SIMPLE: &[[f64; 3]] = &[[0.0; 3]];
const BODY_CENTRED: &[[f64; 3]] = &[[0.0; 3], [0.5; 3]];
const FACE_CENTRED: &[[f64; 3]] = &[[0.0; 3], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];

/// Spheres of radius 1 in a number of cubic cells along each axis.
struct Lattice {
    edge: f64,
    positions: Vec<Vector>,
}

impl Lattice {
    fn new(basis: &[[f64; 3]], fraction: f64, cells: usize) -> Self {
        let edge = (4.0 / 3.0 * PI * basis.len() as f64 / fraction).cbrt();
        let cell = |n: usize| Vector::new((n % cells) as f64, (n / cells % cells) as f64, (n / cells.pow(2)) as f64);
        let of_cell = |n: usize| basis.iter().map(move |&site| (cell(n) + Vector::from_array(site)) * edge);
        let positions = (0..cells.pow(3)).flat_map(of_cell).map(|x| x + Vector::splat(0.1)).collect();
        Self { edge: edge * cells as f64, positions }
    }

    /// The same with each sphere displaced by about a ten-millionth of its radius.
    fn moved(&self) -> Self {
        let shift =
            |k: usize| 1e-7 * Vector::new((k as f64).sin(), (2.0 * k as f64 + 1.0).cos(), (3.0 * k as f64).sin());
        let positions = self.positions.iter().enumerate().map(|(k, &x)| x + shift(k)).collect();
        Self { edge: self.edge, positions }
    }

    fn motions(&self, is_lubricated: bool, tolerance: f64, load: Load) -> Motions {
        let cell = PeriodicBox::new(Vector::splat(self.edge)).unwrap();
        let usual = MobilityParameters::new(cell, 1.0, vec![1.0; self.positions.len()]);
        let lubrication = is_lubricated.then(LubricationRange::default);
        let parameters = MobilityParameters { tolerance, lubrication, ..usual };
        let mut mobility = Mobility::new(parameters, Bytes::default(), &Comm::alone()).unwrap();
        mobility.place(&self.positions).unwrap();
        let each = |of: Vector| vec![of; self.positions.len()];
        let at_rest = BackgroundFlow::NONE;
        let (loads, flow) = match load {
            Load::Force => (Loads { forces: each(Vector::X), ..Loads::default() }, at_rest),
            Load::Torque => (Loads { torques: each(Vector::Y), ..Loads::default() }, at_rest),
            Load::Opposed => {
                let forces = (0..self.positions.len()).map(|k| if k % 2 == 0 { Vector::X } else { -Vector::X });
                (Loads { forces: forces.collect(), ..Loads::default() }, at_rest)
            }
            Load::Shear => {
                let gradient = Tensor::from_cols(Vector::ZERO, Vector::X, Vector::ZERO);
                (Loads::default(), BackgroundFlow::with_gradient(gradient).unwrap())
            }
        };
        mobility.apply(&loads, &flow).unwrap()
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Load {
    Force,
    Torque,
    Opposed,
    Shear,
}

/// The response that a load drives directly.
fn driven(load: Load, motions: &Motions) -> Vec<f64> {
    let of_vectors = |list: &[Vector]| list.iter().flat_map(Vector::to_array).collect();
    match load {
        Load::Force | Load::Opposed => of_vectors(&motions.motion.velocities),
        Load::Torque => of_vectors(&motions.motion.angular_velocities),
        Load::Shear => motions.stresslets.iter().flat_map(|s| s.0).collect(),
    }
}

fn relative_error(found: &[f64], exact: &[f64]) -> f64 {
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
    norm(&mut found.iter().zip(exact).map(|(a, b)| a - b)) / norm(&mut exact.iter().copied())
}

/// Lattices with volume fractions from dilute to nearly touching.
fn lattices() -> Vec<Lattice> {
    let all = [(SIMPLE, [0.2, 0.35, 0.5]), (BODY_CENTRED, [0.35, 0.45, 0.65]), (FACE_CENTRED, [0.4, 0.55, 0.7])];
    all.iter().flat_map(|(basis, fractions)| fractions.iter().map(|&f| Lattice::new(basis, f, 1))).collect()
}

/// A step of the iteration leaves a residual orthogonal to the only direction of a lattice, and the loads of stiff and
/// of soft pairs cancel: a norm of their sum would end the solve there, with an error of a thousandth at any tolerance.
#[test]
fn a_lattice_moves_as_the_same_one_that_is_not_exactly_symmetric() {
    let cells = Lattice::new(SIMPLE, 0.4, 3);
    for lattice in lattices().iter().chain([&cells]) {
        for load in [Load::Force, Load::Torque, Load::Opposed, Load::Shear] {
            // With one sphere per cell, opposed forces are the same as the first load.
            if load == Load::Opposed && lattice.positions.len() % 2 != 0 {
                continue;
            }
            let moved = driven(load, &lattice.moved().motions(true, 1e-8, load));
            for tolerance in [1e-2, 1e-4, 1e-6] {
                let found = driven(load, &lattice.motions(true, tolerance, load));
                let error = relative_error(&found, &moved);
                // Resistances change relatively by the displacement over the gap.
                assert!(
                    error < tolerance.max(5e-6),
                    "{} spheres in {}: {load:?}, {error:e} at {tolerance:e}",
                    lattice.positions.len(),
                    lattice.edge
                );
            }
        }
    }
}

/// With lubrication the resistance is larger than that of the far field alone.
#[test]
fn lubrication_slows_no_lattice_less_than_none() {
    for lattice in lattices() {
        let [without, with] =
            [false, true].map(|is_lubricated| lattice.motions(is_lubricated, 1e-6, Load::Force).motion.velocities[0].x);
        assert!(with <= without * (1.0 + 1e-6), "in {}: {with} with lubrication, {without} without", lattice.edge);
    }
}

/// The tolerance is relative to the hindered velocity, which is a tenth to a seventieth of that of a single sphere.
#[test]
fn velocities_of_lattices_under_equal_forces_keep_the_tolerance() {
    for lattice in lattices() {
        let exact = driven(Load::Force, &lattice.motions(false, 1e-10, Load::Force));
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
            let error = relative_error(&driven(Load::Force, &lattice.motions(false, tolerance, Load::Force)), &exact);
            assert!(error < tolerance, "in {}: {error:e} at {tolerance:e}", lattice.edge);
        }
    }
}

/// In a dilute lattice the distance of neighbours is close to the cutoff of pairs, and all pairs have the same error.
#[test]
fn velocities_of_a_dilute_lubricated_lattice_keep_the_tolerance() {
    for fraction in [0.16, 0.19, 0.2186, 0.24] {
        let lattice = Lattice::new(FACE_CENTRED, fraction, 1);
        let exact = driven(Load::Force, &lattice.motions(true, 1e-8, Load::Force));
        for tolerance in [1e-2, 1e-3] {
            let error = relative_error(&driven(Load::Force, &lattice.motions(true, tolerance, Load::Force)), &exact);
            assert!(error < tolerance, "{fraction}: {error:e} at {tolerance:e}");
        }
    }
}
