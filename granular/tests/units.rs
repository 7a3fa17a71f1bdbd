//! Answers do not depend on the units of length, time and mass: not by a bit for powers of two, and only by round-off
//! for powers of ten. Runs are short, as granular flows are chaotic.

use granular::disks::{DiskModel, DiskParameters, DiskSpecies, Disks, LengthUnit, Sizes};
use granular::kinetic_theory;
use granular::shear_cell::{CellModel, CellParameters, CollisionDetection, Sampling, ShearCell, Side, Top};

/// Factors of length, time and mass.
#[derive(Debug, Clone, Copy)]
struct Units {
    length: f64,
    time: f64,
    mass: f64,
}

const SI: Units = Units { length: 1.0, time: 1.0, mass: 1.0 };

impl Units {
    fn speed(&self) -> f64 {
        self.length / self.time
    }

    fn stress(&self) -> f64 {
        self.mass / self.length / self.time / self.time
    }

    fn density(&self) -> f64 {
        self.mass / self.length / self.length / self.length
    }

    fn powers_of_two() -> Vec<Self> {
        let powers = [[10, 0, 0], [0, -7, 0], [0, 0, 99], [-99, 99, 99], [99, -99, -99], [98, 97, -3], [-1, -1, 1]];
        let of = |[length, time, mass]: [i32; 3]| [length, time, mass].map(|power| 2_f64.powi(power));
        powers.into_iter().map(of).map(|[length, time, mass]| Self { length, time, mass }).collect()
    }

    fn powers_of_ten() -> Vec<Self> {
        let powers = [
            ["1e30", "1", "1"],
            ["1e-30", "1", "1"],
            ["1", "1e30", "1"],
            ["1", "1e-30", "1"],
            ["1", "1", "1e30"],
            ["1", "1", "1e-30"],
            ["1e30", "1e-30", "1e30"],
            ["1e-30", "1e30", "1e-30"],
            ["1e30", "1e30", "1e-30"],
            ["1e-30", "1e-30", "1e-30"],
            ["1e3", "1e6", "1e9"],
            ["1e6", "1e3", "1e12"],
            ["1e9", "1e9", "1e-3"],
        ];
        let of = |[length, time, mass]: [&str; 3]| [length, time, mass].map(|text| text.parse().unwrap());
        powers.into_iter().map(of).map(|[length, time, mass]| Self { length, time, mass }).collect()
    }
}

fn same_bits(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Largest difference, relative to the largest value.
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// A small cell with a free top wall.
fn cell(units: &Units) -> CellParameters {
    let Units { length, time, mass } = *units;
    let p = CellParameters::default();
    CellParameters {
        length: 3.5e-3 * length,
        height: 3e-3 * length,
        width: 3.2e-3 * length,
        diameter: p.diameter * length,
        density: p.density * units.density(),
        speed: p.speed * units.speed(),
        top: Top::Free { pressure: 300.0 * units.stress(), mass_per_area: 0.2 * mass / length / length },
        gravity: p.gravity * units.speed() / time,
        circumference: p.circumference.map(|around| around * length),
        contact_time: p.contact_time * time,
        ..p
    }
}

/// Positions in units of length, velocities, and wall stresses after some windows, all in SI units: three lists.
fn flow(units: &Units, is_time_stepped: bool) -> [Vec<f64>; 3] {
    let model = CellModel::new(cell(units)).unwrap();
    let mut grains = model.pack(model.count(0.3).unwrap(), 5).unwrap();
    grains.set_velocities(&model, 0.07 * units.speed(), 5);
    let collisions = if is_time_stepped {
        CollisionDetection::TimeStepped { step: 5e-7 * units.time }
    } else {
        CollisionDetection::EventDriven
    };
    let sampling = Sampling { window: 5e-5 * units.time, every: 2, layers: 5, pixels: [3, 3] };
    let mut run = ShearCell::new(&model, &grains, collisions, sampling).unwrap();
    assert!(run.measure(4.0 * sampling.window, &|| true));
    let grains = run.engine().grains();
    let report = run.report();
    assert!(report.tally.collisions() > 10 && report.warnings.is_empty(), "{:?}", report.warnings);
    [
        grains.positions.iter().flat_map(|x| (*x / units.length).to_array()).collect(),
        grains.motions.iter().flat_map(|m| (m.velocity / units.speed()).to_array()).collect(),
        Side::ALL.iter().map(|&side| report.walls[side as usize].normal.mean / units.stress()).collect(),
    ]
}

fn compare_flows(is_time_stepped: bool) {
    let expected = flow(&SI, is_time_stepped);
    for units in Units::powers_of_two() {
        for (found, expected) in flow(&units, is_time_stepped).iter().zip(&expected) {
            assert!(same_bits(found, expected), "{units:?}");
        }
    }
    for units in Units::powers_of_ten() {
        for (found, expected) in flow(&units, is_time_stepped).iter().zip(&expected) {
            // Some collisions per grain, each of which multiplies round-off by about ten.
            let off = difference(found, expected);
            assert!(off < 1e-9, "{units:?}: {off:.1e}");
        }
    }
}

#[test]
fn rigid_grains_move_the_same_in_any_units() {
    compare_flows(false);
}

#[test]
fn grains_on_a_time_step_move_the_same_in_any_units() {
    compare_flows(true);
}

#[test]
fn the_continuum_is_the_same_in_any_units() {
    let solved = |units: &Units| {
        let mut p = kinetic_theory::ContinuumParameters::default();
        p.gap *= units.length;
        p.speed *= units.speed();
        p.pressure *= units.stress();
        p.grains.diameter *= units.length;
        p.grains.density *= units.density();
        p.wall.diameter *= units.length;
        let solution = kinetic_theory::ContinuumProblem::new(p).unwrap().solve().unwrap();
        let flow = |point: &kinetic_theory::FlowPoint| {
            let flux = units.stress() * units.speed();
            [
                point.velocity / units.speed(),
                point.solid_fraction,
                point.temperature / units.speed() / units.speed(),
                // Scaled to a magnitude like that of the others.
                point.energy_flux / flux * 1e-3,
            ]
        };
        let profile = solution.profile(9);
        let mut numbers: Vec<f64> = profile.iter().flat_map(flow).collect();
        numbers.extend([solution.mean_solid_fraction(), solution.shear_stress() / units.stress() * 1e-3]);
        numbers
    };
    let expected = solved(&SI);
    for units in Units::powers_of_two() {
        assert!(same_bits(&solved(&units), &expected), "{units:?}");
    }
    for units in Units::powers_of_ten() {
        // The solver's own residual is 1e-9 at most.
        let off = difference(&solved(&units), &expected);
        assert!(off < 1e-9, "{units:?}: {off:.1e}");
    }
}

/// The radii of disks are relative to each other, so that they alone have a unit.
#[test]
fn disks_are_the_same_whatever_the_unit_of_their_radii() {
    let species = |radii: [f64; 2]| {
        Sizes::DiskSpecies(vec![
            DiskSpecies { radius: radii[0], share: 1.0 },
            DiskSpecies { radius: radii[1], share: 0.2 },
        ])
    };
    let spread = |radii: [f64; 2]| Sizes::Spread { smallest: radii[0], largest: radii[1], exponent: -3.5 };
    let run = |sizes: Sizes| {
        let p =
            DiskParameters { edges: [25.0; 2], length_unit: LengthUnit::Smallest, sizes, ..DiskParameters::default() };
        let mut disks = Disks::prepared(&DiskModel::new(p).unwrap()).unwrap();
        disks.advance(50);
        disks.check().unwrap();
        disks.store().0.columns.iter().flat_map(|column| column.values.clone()).collect::<Vec<f64>>()
    };
    for sizes in [&species as &dyn Fn([f64; 2]) -> Sizes, &spread] {
        let expected = run(sizes([1.0, 2.5]));
        for digits in [["1e30", "2.5e30"], ["1e-30", "2.5e-30"], ["4e-7", "1e-6"], ["3", "7.5"], ["1e17", "2.5e17"]] {
            let radii = digits.map(|text| text.parse::<f64>().unwrap());
            assert!(same_bits(&run(sizes(radii)), &expected), "{digits:?}");
        }
        for power in [-99, -20, 1, 77] {
            assert!(same_bits(&run(sizes([1.0, 2.5].map(|r| r * 2_f64.powi(power)))), &expected), "2^{power}");
        }
    }
}
