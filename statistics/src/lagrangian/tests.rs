use super::*;
use crate::Diffusivity;
use domain::Random;

/// Paths of particles whose velocities are Ornstein-Uhlenbeck processes with variance `1` and correlation time `1`,
/// or constant, sampled every `dt`; displacements are integrated in many small steps.
fn ornstein_uhlenbeck(particles: u64, samples: usize, dt: f64) -> Vec<Vec<TrackedMotion>> {
    let substeps = 8;
    let decay = (-dt / f64::from(substeps)).exp();
    let noise = |random: &mut Random| {
        let radius = (-2.0 * (1.0 - random.uniform()).ln()).sqrt();
        let angle = std::f64::consts::TAU * random.uniform();
        (radius * angle.cos(), radius * angle.sin())
    };
    let mut randoms: Vec<Random> = (0..particles).map(|id| Random::new(11, id)).collect();
    let mut motions: Vec<TrackedMotion> = randoms
        .iter_mut()
        .map(|r| {
            let ((x, y), (z, _)) = (noise(r), noise(r));
            TrackedMotion { velocity: Vector::new(x, y, z), path: Vector::ZERO }
        })
        .collect();
    let mut all = Vec::new();
    for _ in 0..samples {
        all.push(motions.clone());
        for (motion, random) in motions.iter_mut().zip(&mut randoms) {
            for _ in 0..substeps {
                let before = motion.velocity;
                let ((x, y), (z, _)) = (noise(random), noise(random));
                motion.velocity = decay * before + (1.0 - decay * decay).sqrt() * Vector::new(x, y, z);
                motion.path += 0.5 * dt / f64::from(substeps) * (before + motion.velocity);
            }
        }
    }
    all
}

#[test]
fn an_ornstein_uhlenbeck_process_has_its_correlation_and_diffusivity() {
    let dt = 0.25;
    let samples = ornstein_uhlenbeck(200, 2000, dt);
    let mut lagrangian = Lagrangian::new(&vec![0; 200]);
    samples.iter().enumerate().for_each(|(k, motions)| lagrangian.add(k as f64 * dt, motions));
    for lag in lagrangian.sums().lags(Some(0)).iter().filter(|lag| lag.time <= 8.0) {
        let t = lag.time;
        for i in 0..3 {
            // 200 particles over 500 correlation times: 1/sqrt(50,000) = 0.0045.
            assert!((lag.correlation[i] - (-t).exp()).abs() < 0.025, "{lag:?}");
            assert!((lag.correlation_integral[i] - (1.0 - (-t).exp())).abs() < 0.05, "{lag:?}");
            assert!(
                (lag.mean_square_displacement[i] - 2.0 * (t - 1.0 + (-t).exp())).abs() < 0.03 * (1.0 + t),
                "{lag:?}"
            );
        }
    }
    let found = Diffusivity::of(&lagrangian.sums(), None, [6.0, 20.0]);
    for estimate in found.by_slope.iter().chain(&found.by_integral) {
        assert!((estimate.mean - 1.0).abs() < 4.0 * estimate.error && estimate.error < 0.05, "{estimate:?}");
    }
}

#[test]
fn ballistic_particles_do_not_diffuse() {
    let velocities = [Vector::X, -Vector::X, Vector::new(0.0, 3.0, 4.0), Vector::new(0.0, -3.0, -4.0)];
    let mut lagrangian = Lagrangian::new(&[0; 4]);
    for step in 0..100 {
        let time = 0.3 * f64::from(step);
        lagrangian.add(time, &velocities.map(|velocity| TrackedMotion { velocity, path: time * velocity }));
    }
    let lags = lagrangian.sums().lags(None);
    assert!(lags.last().unwrap().time > 15.0 && lags.is_sorted_by(|a, b| a.time < b.time));
    for lag in lags {
        let square = Vector::new(0.5, 4.5, 8.0);
        assert!((lag.correlation - square).length() < 1e-12);
        assert!((lag.mean_square_displacement - square * lag.time.powi(2)).length() < 1e-10 * (1.0 + lag.time.powi(2)));
        assert!((lag.correlation_integral - square * lag.time).length() < 1e-11 * (1.0 + lag.time));
    }
}

/// Each lag is compared with the sum over all starting times of its level, computed from all samples.
#[test]
fn a_stream_is_the_batch_at_every_lag_and_the_state_lasts() {
    let samples = ornstein_uhlenbeck(10, 300, 0.5);
    let species = [0, 1, 0, 1, 1, 0, 0, 0, 1, 0];
    let mut lagrangian = Lagrangian::new(&species);
    for (k, motions) in samples.iter().enumerate() {
        if k == 137 {
            let bytes = lagrangian.save();
            lagrangian = Lagrangian::new(&species);
            assert!(lagrangian.load(&bytes));
        }
        lagrangian.add(0.5 * k as f64, motions);
    }
    for lag in lagrangian.sums().lags(Some(1)) {
        let steps = (lag.time / 0.5).round() as usize;
        let stride = if steps < 16 { 1 } else { 1 << (steps / 8).ilog2() };
        let starts: Vec<usize> = (stride..=samples.len() - steps).step_by(stride).map(|n| n - 1).collect();
        let members: Vec<usize> = (0..10).filter(|&i| species[i] == 1).collect();
        let over = |number: &dyn Fn(&TrackedMotion, &TrackedMotion) -> f64| {
            let pairs = starts.iter().flat_map(|&s| members.iter().map(move |&i| (s, i)));
            let numbers: Vec<f64> = pairs.map(|(s, i)| number(&samples[s][i], &samples[s + steps][i])).collect();
            numbers.iter().sum::<f64>() / numbers.len() as f64
        };
        let product = over(&|a, b| a.velocity.y * b.velocity.y);
        let correlation = product - over(&|a, _| a.velocity.y) * over(&|_, b| b.velocity.y);
        assert!((lag.correlation.y - correlation).abs() < 1e-12, "lag {steps}");
        let square = over(&|a, b| (b.path.z - a.path.z).powi(2)) - over(&|a, b| b.path.z - a.path.z).powi(2);
        assert!((lag.mean_square_displacement.z - square).abs() < 1e-11 * (1.0 + square), "lag {steps}");
    }
}

/// Two particles with a relative velocity of 1 are displaced by the lag, whichever samples are missing: single ones,
/// many at the start, a long sequence, or all but a few.
#[test]
fn missing_samples_leave_lags_as_they_are() {
    let is_missing: [&dyn Fn(u64) -> bool; 5] =
        [&|k| k == 5, &|k| k % 3 == 1, &|k| (40..400).contains(&k), &|k| k < 7 || k.is_multiple_of(2), &|k| {
            ![3, 4, 260, 511].contains(&k)
        }];
    for is_missing in is_missing {
        let (mut lagrangian, mut next) = (Lagrangian::new(&[0; 2]), None);
        for k in (0..512).filter(|&k| !is_missing(k)) {
            lagrangian.skip_missing(next.map_or(0, |next| k - next));
            let time = 0.5 * k as f64;
            let motion = |velocity: Vector| TrackedMotion { velocity, path: time * velocity };
            lagrangian.add(time, &[motion(Vector::X), motion(-Vector::X)]);
            next = Some(k + 1);
        }
        let lags = lagrangian.sums().lags(None);
        assert!(lagrangian.fits() && lags.len() > 1 && lags.is_sorted_by(|a, b| a.time < b.time));
        for lag in &lags {
            let square = lag.time * lag.time;
            assert!((lag.time / 0.5).fract() == 0.0, "{lag:?}");
            assert!((lag.mean_square_displacement.x - square).abs() < 1e-12 * (1.0 + square), "{lag:?}");
        }
        let mut again = Lagrangian::new(&[0; 2]);
        assert!(again.load(&lagrangian.save()) && again.sums() == lagrangian.sums());
    }
}

/// A gap of any length takes no time to skip, and nothing is correlated across one that no level spans.
#[test]
fn gaps_may_be_of_any_length() {
    let mut lagrangian = Lagrangian::new(&[0]);
    (0..4).for_each(|k| lagrangian.add(f64::from(k), &[TrackedMotion::default()]));
    lagrangian.skip_missing(u64::MAX / 2 - 3);
    lagrangian.add(1e19, &[TrackedMotion::default()]);
    assert!(lagrangian.sums().lags(None).iter().all(|lag| lag.time <= 3.0));
    lagrangian.skip_missing(u64::MAX);
}

/// Sums of parts of any size add up to those of all: exactly, for integers.
#[test]
fn parts_add_up_to_the_whole() {
    let species = [0, 1, 1, 0, 1, 1, 1, 0, 1, 0, 0, 1, 1];
    let motion = |k: u32, row: usize| {
        let number = |axis: u32| f64::from((7 * k + 5 * row as u32 + 3 * axis) % 11);
        let [velocity, path] = [0, 3].map(|first| Vector::new(number(first), number(first + 1), number(first + 2)));
        TrackedMotion { velocity, path }
    };
    let sums = |rows: std::ops::Range<usize>| {
        let mut before = vec![0; 2];
        species[..rows.start].iter().for_each(|&s| before[s as usize] += 1);
        let mut lagrangian = Lagrangian::after(before, &species[rows.clone()]);
        assert!(lagrangian.fits());
        for k in 0..40 {
            lagrangian.add(f64::from(k), &rows.clone().map(|row| motion(k, row)).collect::<Vec<_>>());
        }
        assert!(lagrangian.fits() && !Lagrangian { classes: vec![0; 14], ..lagrangian.clone() }.fits());
        lagrangian.sums().into_numbers()
    };
    let mut total = sums(0..4);
    for part in [4..4, 4..5, 5..13] {
        total.iter_mut().zip(sums(part)).for_each(|(sum, more)| *sum += more);
    }
    assert_eq!(LagSums::of_numbers(2, total), LagSums::of_numbers(2, sums(0..13)));
}

#[test]
fn memory_grows_as_the_logarithm_of_the_samples() {
    let mut lagrangian = Lagrangian::new(&[0; 3]);
    for k in 0..4096 {
        lagrangian.add(f64::from(k), &[TrackedMotion::default(); 3]);
    }
    assert_eq!(lagrangian.levels.len(), 13);
}
