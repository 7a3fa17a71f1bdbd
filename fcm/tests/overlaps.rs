//! Random motions of heavily overlapping spheres: on the grid alone the mobility has a square root, but the near
//! field of the split method may not.

use crate::common::Suspension;
use domain::{Comm, Partition, PeriodicBox, Random, Traceless, Vector};
use fcm::{
    DrawDiagnostics, Envelope, Fixed, Loads, Method, Mobility, Motion, Multipoles, Output, Plan, Problem, Stream,
};

/// 40 spheres at independent random positions, half of them of another radius: equal ones in a cube of edge 4 have
/// 2.6 times its volume, those of radii 1 and 2 in one of edge 6 more than 3 times.
fn random(ratio: f64, edge: f64) -> Suspension {
    let mut random = Random::new(3, 0);
    Suspension {
        cell: PeriodicBox::new(Vector::splat(edge)).unwrap(),
        viscosity: 1.3,
        positions: (0..40).map(|_| random.point() * edge).collect(),
        radii: (0..40).map(|i| if i % 2 == 0 { 1.0 } else { ratio }).collect(),
    }
}

const CASES: [(f64, f64); 2] = [(1.0, 4.0), (2.0, 6.0)];

fn mobility(suspension: &Suspension, multipoles: Multipoles, fixed: Fixed) -> Mobility {
    let plan = Plan::choose(&Problem { multipoles, fixed, ..suspension.problem(1e-3) }).unwrap();
    let mut mobility = Mobility::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    mobility.arrange(&suspension.cell, &suspension.particles());
    mobility
}

fn draw(mobility: &mut Mobility, number: u64) -> (Motion, DrawDiagnostics) {
    mobility.noise(&(0..40).collect::<Vec<_>>(), 1e-3, Stream::new(7, number))
}

/// Nothing is clipped, and along loads of any kind the variance is that of the mobility: within 4.5 standard errors
/// of 1500 draws, for all loads at once and for those of one sphere, with forces alone and with dipoles.
#[test]
fn on_the_grid_alone_draws_of_overlapping_spheres_have_the_covariance_of_the_mobility() {
    for ((ratio, edge), multipoles) in
        CASES.into_iter().flat_map(|c| [(c, Multipoles::Monopole), (c, Multipoles::Dipole)])
    {
        let suspension = random(ratio, edge);
        let fixed = Fixed { method: Some(Method::Direct), ..Fixed::default() };
        let mut mobility = mobility(&suspension, multipoles, fixed);
        let mut directions: Vec<Loads> = (0..8).map(|seed| suspension.loads(seed)).collect();
        for (sphere, loads) in directions.iter_mut().take(4).enumerate() {
            for other in (0..40).filter(|&other| other != sphere) {
                (loads.forces[other], loads.torques[other]) = (Vector::ZERO, Vector::ZERO);
                loads.stresslets[other] = Traceless::ZERO;
            }
        }
        if multipoles == Multipoles::Monopole {
            for loads in &mut directions {
                (loads.torques, loads.stresslets) = (Vec::new(), Vec::new());
            }
        }
        let wanted = if multipoles == Multipoles::Monopole { Output::Velocities } else { Output::All };
        let variances: Vec<f64> = directions.iter().map(|loads| mobility.apply(loads, wanted).power(loads)).collect();
        assert!(variances.iter().all(|variance| *variance > 0.0), "{variances:?}");
        let draws = 1500;
        let mut squares = vec![0.0; directions.len()];
        for number in 0..draws {
            let (motion, drawn) = draw(&mut mobility, number);
            assert_eq!(drawn, DrawDiagnostics::default(), "there is no near field");
            squares.iter_mut().zip(&directions).for_each(|(sum, loads)| *sum += motion.power(loads).powi(2));
        }
        let error = (2.0 / draws as f64).sqrt();
        for (square, variance) in squares.iter().zip(&variances) {
            let off = (square / draws as f64 / variance - 1.0) / error;
            assert!(off.abs() < 4.5, "{multipoles:?}, 1:{ratio}: {off} errors");
        }
    }
}

/// The split method, with a common Gaussian as wide as the widest envelope, clips the negative eigenvalues of the
/// near field, and reports it.
#[test]
#[ignore = "heavy"]
fn the_split_method_says_what_it_leaves_out() {
    for (ratio, edge) in CASES {
        let suspension = random(ratio, edge);
        let width = Some(Envelope::of_sphere(ratio).monopole);
        let fixed = Fixed { method: Some(Method::Split), width, ..Fixed::default() };
        let mut mobility = mobility(&suspension, Multipoles::Dipole, fixed);
        let clipped = (0..4).map(|number| draw(&mut mobility, number).1.clipped).fold(0.0, f64::max);
        println!("1:{ratio}: {clipped:.1e}");
        assert!(clipped > DrawDiagnostics::NEGLIGIBLE, "1:{ratio}: {clipped:e}");
    }
}
