//! Memory of a card that solves take, which an emulator counts, beside the forecast of `check`.

use super::device_pairs::lubrication_of;
use super::device_walls::{at_walls, of_channel};
use super::on_device::{Suspension, emulator, lubricated};
use super::*;
use crate::pairs::device_tables;
use domain::Boundaries;
use gpu::{Counted, NearSize, NumberFormat};

/// A solve of some spheres with short-range interactions in a flow.
struct Forecast {
    suspension: Suspension,
    short_range: ShortRange,
    flow: StrainRate,
}

impl Forecast {
    /// Compares the forecast with what a solve allocates after an evaluation. Returns the forecast.
    fn holds(&self) -> NearSize {
        let Suspension { cell, particles, .. } = &self.suspension;
        let (device, counts) = Counted::new(emulator(5));
        let mut solver = self.suspension.with_range(Box::new(device), self.short_range);
        let (along, none) = (vec![Vector::X; particles.len()], vec![Traceless::ZERO; particles.len()]);
        let loads = Loads { forces: along.clone(), torques: along, stresslets: none.clone() };
        solver.mobility().follow(cell, particles);
        solver.mobility().apply(&loads, fcm::Output::All);
        let before = counts.borrow().memory[1];
        let ambient = Motion { strain_rates: none, ..Motion::default() };
        let input = SolveInput { keeps_columns: true, ambient: &ambient, ..SolveInput::new(&loads, self.flow) };
        let _kept = solver.solve(cell, particles, &input, Guess::default()).unwrap();
        let found = (counts.borrow().memory[1] - before) as f64;
        // Spheres that have not moved are arranged once: their neighbours are counted, then listed.
        assert_eq!(counts.borrow().runs["find_neighbours_f32"], 2);
        let size = self.size(&solver);
        // Sums of blocks and the resistances of single spheres are left out.
        assert!((size.bytes()..size.bytes() + 500.0).contains(&found), "{found} bytes, {} expected", size.bytes());
        size
    }

    fn size(&self, solver: &CoupledSolver) -> NearSize {
        let Suspension { particles, plan, .. } = &self.suspension;
        let is_lubricated = self.short_range.lubrication.is_some();
        let [stiff, soft] = if is_lubricated { self.suspension.pairs(solver).map(f64::from) } else { [0.0; 2] };
        let tables = if is_lubricated {
            lubrication_of(solver).tables(1.0, Vec::new())
        } else {
            device_tables::without_lubrication(&plan.radii, Vec::new())
        };
        let tables = size_of_val(&tables.kinds[..]) + size_of_val(&tables.series[..]);
        NearSize {
            numbers: NumberFormat::Single,
            particles: particles.len() as f64,
            stiff,
            soft,
            tables: tables as f64,
            at_walls: is_lubricated && plan.boundaries == Boundaries::Walls,
        }
    }
}

fn shear() -> StrainRate {
    StrainRate::uniform(Traceless([0.0, 0.5, 0.0, 0.0, 0.0]))
}

fn in_shear(short_range: ShortRange) -> Forecast {
    Forecast { suspension: Suspension::new(Precision::Single, 1e-2), short_range, flow: shear() }
}

#[test]
fn near_pairs_take_what_is_predicted() {
    let size = in_shear(lubricated()).holds();
    assert!(size.stiff > 0.0 && size.soft > 0.0);
}

#[test]
fn spheres_without_lubrication_take_what_is_predicted() {
    in_shear(ShortRange::default()).holds();
}

#[test]
fn lubrication_at_walls_takes_what_is_predicted() {
    let suspension = at_walls(Boundaries::Walls, Precision::Single, 1e-2);
    let flow = of_channel(&suspension);
    let size = Forecast { suspension, short_range: lubricated(), flow }.holds();
    assert!(size.at_walls);
}
