use super::*;
use domain::Random;
use std::f64::consts::PI;

const NONE: ChannelSample = ChannelSample {
    heights: &[],
    radii: &[],
    species: &[],
    velocities: &[],
    slips: &[],
    angular_velocities: &[],
    stresslets: &[],
    pair_moments: &[],
};

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12 * (1.0 + b.abs())
}

/// A sphere over several bins, a smaller one within one bin, and one half of which is above the top: known slices.
#[test]
fn spheres_at_given_heights_have_known_profiles() {
    let mut profile = ChannelProfile::new([1.0, 9.0], 5.0, 2, 8);
    let spin = [Vector::Y, 2.0 * Vector::Y, Vector::ZERO];
    let sample = ChannelSample {
        heights: &[4.0, 6.5, 9.0],
        radii: &[1.0, 0.25, 1.0],
        species: &[0, 1, 1],
        velocities: &[Vector::X, Vector::new(3.0, 0.0, 1.0), Vector::ZERO],
        slips: &[-Vector::X, Vector::X, Vector::ZERO],
        angular_velocities: &spin,
        stresslets: &[Tensor::from_diagonal(Vector::new(2.0, -1.0, -1.0)), Tensor::ZERO, Tensor::ZERO],
        pair_moments: &[Tensor::from_diagonal(-Vector::Z), Tensor::ZERO, Tensor::ZERO],
    };
    profile.add(&sample);
    profile.add(&sample);
    let rows: Vec<ChannelRow> = profile.rows(Some(0)).collect();
    for (k, row) in rows.iter().enumerate() {
        assert!(close(row.height, 1.5 + k as f64));
        let half = if k == 2 || k == 3 { 2.0 / 3.0 * PI / 5.0 } else { 0.0 };
        assert!(close(row.volume_fraction.mean, half) && row.volume_fraction.error == 0.0, "{k}");
        // Half of the stresslet over the volume of the bin.
        assert!(close(row.stress[0].mean, if half > 0.0 { 0.2 } else { 0.0 }));
        assert!(close(row.pair_stress[5].mean, if half > 0.0 { -0.1 } else { 0.0 }));
        assert!(close(row.number_density.mean, if k == 3 { 0.2 } else { 0.0 }), "{k}");
        assert_eq!(row.velocity[0].mean.is_nan(), k != 3);
    }
    assert!(close(rows[3].slip[0].mean, -1.0) && close(rows[3].angular_velocity[1].mean, 1.0));
    let small: Vec<ChannelRow> = profile.rows(Some(1)).collect();
    assert!(
        close(small[5].volume_fraction.mean, PI / 48.0 / 5.0) && close(small[7].volume_fraction.mean, 2.0 / 15.0 * PI)
    );
    let all: Vec<ChannelRow> = profile.rows(None).collect();
    assert!(close(all[5].velocity[2].mean, 1.0) && close(all[5].fluctuations[0].mean, 0.0));
    let volumes = 4.0 / 3.0 * PI * (2.0 + 1.0 / 64.0);
    assert!(close(profile.outside().mean, 2.0 / 3.0 * PI / volumes));
}

/// For any bins, slices of spheres between the walls add up to their volume, and centres to their number; means over
/// bins weighted by their numbers are those of all.
#[test]
fn profiles_integrate_to_what_is_there() {
    let mut random = Random::new(5, 1);
    for count in [1, 7, 64] {
        let mut profile = ChannelProfile::new([0.0, 10.0], 36.0, 1, count);
        let (mut sum, mut moment, mut squares) = (0.0, Vector::ZERO, 0.0);
        for _ in 0..5 {
            let radii: Vec<f64> = (0..30).map(|_| 0.5 + random.uniform()).collect();
            let heights: Vec<f64> = radii.iter().map(|a| a + (10.0 - 2.0 * a) * random.uniform()).collect();
            let velocities: Vec<Vector> = (0..30).map(|_| random.point()).collect();
            sum += radii.iter().map(|a| 4.0 / 3.0 * PI * a.powi(3)).sum::<f64>() / 360.0 / 5.0;
            moment += velocities.iter().sum::<Vector>();
            squares += velocities.iter().map(|v| v.x * v.x).sum::<f64>();
            let (slips, radii, heights) = (&velocities, &radii, &heights);
            profile.add(&ChannelSample { heights, radii, species: &[0; 30], velocities: &velocities, slips, ..NONE });
        }
        let rows: Vec<ChannelRow> = profile.rows(None).collect();
        let mean =
            |of: &dyn Fn(&ChannelRow) -> f64| rows.iter().map(of).filter(|x| !x.is_nan()).sum::<f64>() / count as f64;
        assert!(close(mean(&|r| r.volume_fraction.mean), sum) && close(mean(&|r| r.number_density.mean), 30.0 / 360.0));
        let by_number = |of: &dyn Fn(&ChannelRow) -> f64| mean(&|r| r.number_density.mean * of(r)) * 360.0 * 5.0;
        assert!(close(by_number(&|r| r.velocity[1].mean), moment.y), "{count}");
        let second = |r: &ChannelRow| r.fluctuations[0].mean + r.slip[0].mean.powi(2);
        assert!(close(by_number(&second), squares), "{count}");
        assert!(profile.outside().mean.abs() < 1e-14);
        assert!(rows[0].stress[0].mean.is_nan() && rows[0].pair_stress[0].mean.is_nan(), "there were none");
        assert!(!profile.has_pair_stress());
    }
}

/// Spheres in two parts, with integers, whose sums are exact: the profiles of the parts add up to that of all, with
/// rotations and without.
#[test]
fn spheres_may_be_added_in_parts() {
    let vectors: Vec<Vector> = (0..9).map(|n| Vector::new(f64::from(n), f64::from(n * n % 7), 4.0)).collect();
    let heights: Vec<f64> = (0..9).map(|n| f64::from(2 * n % 8) + 0.5).collect();
    let species = [0, 1, 0, 1, 0, 1, 0, 1, 0];
    let stresslets: Vec<Tensor> = vectors.iter().map(|v| Tensor::from_diagonal(*v)).collect();
    let pair_moments: Vec<Tensor> = stresslets.iter().rev().map(|s| *s * 2.0).collect();
    let tensors = |row: &ChannelRow| row.fluctuations.into_iter().chain(row.stress).chain(row.pair_stress);
    let of = |rows: std::ops::Range<usize>, spin: &'_ [Vector]| -> ChannelSample<'_> {
        let spin = if spin.is_empty() { &[][..] } else { &vectors[rows.clone()] };
        ChannelSample {
            heights: &heights[rows.clone()],
            radii: &[0.5; 9][rows.clone()],
            species: &species[rows.clone()],
            velocities: &vectors[rows.clone()],
            slips: &vectors[rows.clone()],
            angular_velocities: spin,
            stresslets: &stresslets[rows.clone()],
            pair_moments: &pair_moments[rows],
        }
    };
    for spin in [&vectors[..], &[]] {
        let new = || ChannelProfile::new([0.0, 8.0], 4.0, 2, 8);
        let (mut whole, mut parts) = (new(), new());
        whole.add(&of(0..9, spin));
        let samples = [0..4, 4..4, 4..9].map(|rows| of(rows, spin));
        let added = |each: &dyn Fn(&ChannelSample) -> Vec<f64>| {
            samples.iter().map(each).reduce(|a, b| a.iter().zip(b).map(|(a, b)| a + b).collect()).unwrap()
        };
        let sums = added(&|sample| parts.sums(sample));
        let second_moments = added(&|sample| parts.second_moments(sample, &sums));
        parts.add_sums(&sums, &second_moments, [true; 2]);
        for (whole, parts) in
            whole.rows(None).chain(whole.rows(Some(1))).zip(parts.rows(None).chain(parts.rows(Some(1))))
        {
            assert_eq!(whole.velocity[1].mean.to_bits(), parts.velocity[1].mean.to_bits());
            assert_eq!(whole.angular_velocity[0].mean.is_nan(), spin.is_empty() || whole.velocity[0].mean.is_nan());
            for (a, b) in tensors(&whole).zip(tensors(&parts)) {
                assert!(close(a.mean, b.mean) || a.mean.is_nan() && b.mean.is_nan(), "{a:?} {b:?}");
            }
            assert!(close(whole.volume_fraction.mean, parts.volume_fraction.mean));
        }
    }
}

#[test]
fn the_state_lasts_bit_for_bit() {
    let new = || ChannelProfile::new([0.0, 4.0], 9.0, 1, 4);
    let add = |profile: &mut ChannelProfile, k: i32| {
        let heights = [1.0 + 0.3 * f64::from(k)];
        let velocities = [Vector::X * f64::from(k)];
        let sample = ChannelSample { heights: &heights, radii: &[1.0], species: &[0], velocities: &velocities, ..NONE };
        profile.add(&ChannelSample { slips: &velocities, stresslets: &[Tensor::IDENTITY], ..sample });
    };
    let (mut whole, mut first) = (new(), new());
    (0..7).for_each(|k| add(&mut whole, k));
    (0..3).for_each(|k| add(&mut first, k));
    let mut resumed = new();
    assert!(resumed.load(&first.save()));
    (3..7).for_each(|k| add(&mut resumed, k));
    assert_eq!(resumed, whole);
    assert!(!ChannelProfile::new([0.0, 4.0], 9.0, 1, 5).load(&whole.save()));
}
