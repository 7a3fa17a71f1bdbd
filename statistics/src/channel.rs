//! Profiles across a channel, above a bottom, or through a layer.

use crate::profile::cap;
use crate::{Blocks, Estimate, Fluctuations, State, Store};
use domain::{Tensor, Vector};

/// Averages over bins of equal width across a channel, of each species and of all spheres, with errors by blocks of the samples.
/// A sphere of radius `a` is in each bin with the volume `V_b` of its slice there,
///
/// ```text
/// phi_b = sum_n V_b,n / V_bin,      s_b = sum_n (V_b,n / (4/3 pi a_n^3)) S_n / V_bin,
/// ```
///
/// volume fraction and stress by the stresslets `S_n`; number density and velocities are of the spheres whose centres are in it.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelProfile {
    bottom: f64,
    width: f64,
    bin_volume: f64,
    count: usize,
    /// `[group][bin]`: species one after another, and then all of them.
    bins: Vec<Vec<Bin>>,
    /// The share of the spheres' volume that is in no bin.
    outside: Blocks,
}

/// What is averaged in a bin.
#[derive(Debug, Clone, Default, PartialEq)]
struct Bin {
    fraction: Blocks,
    density: Blocks,
    velocities: Fluctuations,
    slips: Fluctuations,
    angular_velocities: Fluctuations,
    stress: [Blocks; 6],
}

/// All spheres at one time.
#[derive(Debug, Clone, Copy)]
pub struct ChannelSample<'a> {
    /// Coordinates of the centres across the channel.
    pub heights: &'a [f64],
    /// Radii.
    pub radii: &'a [f64],
    /// Species, counted from 0.
    pub species: &'a [u32],
    /// Velocities.
    pub velocities: &'a [Vector],
    /// Velocities relative to what a free sphere alone has in the flow without walls.
    pub slips: &'a [Vector],
    /// Angular velocities; none of spheres that do not turn.
    pub angular_velocities: &'a [Vector],
    /// Stresslets, force times length; none where there are none.
    pub stresslets: &'a [Tensor],
}

/// The averages in a bin; of velocities, not a number where there was no centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelRow {
    /// The middle of the bin.
    pub height: f64,
    /// Volume fraction.
    pub volume_fraction: Estimate,
    /// Centres over volume.
    pub number_density: Estimate,
    /// Mean velocity.
    pub velocity: [Estimate; 3],
    /// Mean velocity relative to the flow without spheres.
    pub slip: [Estimate; 3],
    /// `<s_i s_j> - <s_i> <s_j>` of these, xx xy xz yy yz zz.
    pub fluctuations: [Estimate; 6],
    /// Mean angular velocity.
    pub angular_velocity: [Estimate; 3],
    /// Stress, xx xy xz yy yz zz, force over area.
    pub stress: [Estimate; 6],
}

/// The components of a symmetric tensor, in the order xx, xy, xz, yy, yz, zz.
const COMPONENTS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// The volume and the stresslets of the slices in a bin.
#[derive(Clone, Copy)]
struct Slices {
    volume: f64,
    stress: Tensor,
}

impl ChannelProfile {
    /// Series of numbers in a bin.
    pub(crate) const SERIES: usize = size_of::<Bin>() / size_of::<Blocks>();

    /// So many bins from a bottom to a top of a channel of this area along it, for `species` species.
    pub fn new([bottom, top]: [f64; 2], area: f64, (species, count): (usize, usize)) -> Self {
        let width = (top - bottom) / count as f64;
        let bins = vec![vec![Bin::default(); count]; species + 1];
        Self { bottom, width, bin_volume: area * width, count, bins, outside: Blocks::default() }
    }

    /// Adds all spheres at one time.
    pub fn add(&mut self, sample: &ChannelSample) {
        self.add_slices(sample);
        self.add_centres(sample);
    }

    fn add_slices(&mut self, sample: &ChannelSample) {
        let groups = self.bins.len();
        let mut slices = vec![vec![Slices { volume: 0.0, stress: Tensor::ZERO }; self.count]; groups];
        let [mut inside, mut whole] = [0.0; 2];
        for (n, (&height, &radius)) in sample.heights.iter().zip(sample.radii).enumerate() {
            let volume = cap(radius, radius);
            let stresslet = sample.stresslets.get(n).copied().unwrap_or(Tensor::ZERO);
            let edge = |bin: usize| cap(self.bottom + bin as f64 * self.width - height, radius);
            let [first, last] = [height - radius, height + radius].map(|z| (z - self.bottom) / self.width);
            for bin in first.max(0.0) as usize..(last.max(0.0).ceil() as usize).min(self.count) {
                let part = edge(bin + 1) - edge(bin);
                for group in [sample.species[n] as usize, groups - 1] {
                    slices[group][bin].volume += part;
                    slices[group][bin].stress += stresslet * (part / volume);
                }
                inside += part;
            }
            whole += volume;
        }
        self.outside.add(1.0 - inside / whole);
        let over = 1.0 / self.bin_volume;
        for (bin, slices) in self.bins.iter_mut().flatten().zip(slices.iter().flatten()) {
            bin.fraction.add(slices.volume * over);
            if !sample.stresslets.is_empty() {
                for (blocks, (i, j)) in bin.stress.iter_mut().zip(COMPONENTS) {
                    blocks.add(slices.stress.col(i)[j] * over);
                }
            }
        }
    }

    fn add_centres(&mut self, sample: &ChannelSample) {
        let mut rows = vec![Vec::new(); self.count];
        for (n, height) in sample.heights.iter().enumerate() {
            let bin = ((height - self.bottom) / self.width).floor();
            if (0.0..self.count as f64).contains(&bin) {
                rows[bin as usize].push(n);
            }
        }
        let all = self.bins.len() - 1;
        for (group, bins) in self.bins.iter_mut().enumerate() {
            for (bin, rows) in bins.iter_mut().zip(&rows) {
                let own = rows.iter().copied().filter(|&n| group == all || sample.species[n] as usize == group);
                bin.density.add(own.clone().count() as f64 / self.bin_volume);
                bin.velocities.add(own.clone().map(|n| sample.velocities[n]));
                bin.slips.add(own.clone().map(|n| sample.slips[n]));
                if !sample.angular_velocities.is_empty() {
                    bin.angular_velocities.add(own.map(|n| sample.angular_velocities[n]));
                }
            }
        }
    }

    /// The averages in each bin, from the bottom up, of a species or, `None`, of all.
    pub fn rows(&self, species: Option<usize>) -> impl Iterator<Item = ChannelRow> {
        let bins = &self.bins[species.unwrap_or(self.bins.len() - 1)];
        bins.iter().enumerate().map(|(k, bin)| ChannelRow {
            height: self.bottom + (k as f64 + 0.5) * self.width,
            volume_fraction: bin.fraction.estimate(),
            number_density: bin.density.estimate(),
            velocity: bin.velocities.pooled_mean(),
            slip: bin.slips.pooled_mean(),
            fluctuations: bin.slips.components(),
            angular_velocity: bin.angular_velocities.pooled_mean(),
            stress: bin.stress.each_ref().map(Blocks::estimate),
        })
    }

    /// The share of the spheres' volume that is in no bin: above the top, or below the bottom.
    pub fn outside(&self) -> Estimate {
        self.outside.estimate()
    }
}

impl State for ChannelProfile {
    fn visit(&mut self, store: &mut dyn Store) {
        self.outside.visit(store);
        for bin in self.bins.iter_mut().flatten() {
            for fluctuations in [&mut bin.velocities, &mut bin.slips, &mut bin.angular_velocities] {
                fluctuations.visit(store);
            }
            for blocks in [&mut bin.fraction, &mut bin.density].into_iter().chain(&mut bin.stress) {
                blocks.visit(store);
            }
        }
    }
}

#[cfg(test)]
mod tests {
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
    };

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * (1.0 + b.abs())
    }

    /// A sphere over several bins, a smaller one within one bin, one of which half is above the top: known slices.
    #[test]
    fn spheres_at_given_heights_have_known_profiles() {
        let mut profile = ChannelProfile::new([1.0, 9.0], 5.0, (2, 8));
        let spin = [Vector::Y, 2.0 * Vector::Y, Vector::ZERO];
        let sample = ChannelSample {
            heights: &[4.0, 6.5, 9.0],
            radii: &[1.0, 0.25, 1.0],
            species: &[0, 1, 1],
            velocities: &[Vector::X, Vector::new(3.0, 0.0, 1.0), Vector::ZERO],
            slips: &[-Vector::X, Vector::X, Vector::ZERO],
            angular_velocities: &spin,
            stresslets: &[Tensor::from_diagonal(Vector::new(2.0, -1.0, -1.0)), Tensor::ZERO, Tensor::ZERO],
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
            assert!(close(row.number_density.mean, if k == 3 { 0.2 } else { 0.0 }), "{k}");
            assert_eq!(row.velocity[0].mean.is_nan(), k != 3);
        }
        assert!(close(rows[3].slip[0].mean, -1.0) && close(rows[3].angular_velocity[1].mean, 1.0));
        let small: Vec<ChannelRow> = profile.rows(Some(1)).collect();
        assert!(
            close(small[5].volume_fraction.mean, PI / 48.0 / 5.0)
                && close(small[7].volume_fraction.mean, 2.0 / 15.0 * PI)
        );
        let all: Vec<ChannelRow> = profile.rows(None).collect();
        assert!(close(all[5].velocity[2].mean, 1.0) && close(all[5].fluctuations[0].mean, 0.0));
        let volumes = 4.0 / 3.0 * PI * (2.0 + 1.0 / 64.0);
        assert!(close(profile.outside().mean, 2.0 / 3.0 * PI / volumes));
    }

    /// Whatever bins there are, slices of spheres between the walls add up to their volume, and centres to their number; means
    /// over bins weighed by their numbers are those of all.
    #[test]
    fn profiles_integrate_to_what_is_there() {
        let mut random = Random::new(5, 1);
        for count in [1, 7, 64] {
            let mut profile = ChannelProfile::new([0.0, 10.0], 36.0, (1, count));
            let (mut sum, mut moment, mut squares) = (0.0, Vector::ZERO, 0.0);
            for _ in 0..5 {
                let radii: Vec<f64> = (0..30).map(|_| 0.5 + random.uniform()).collect();
                let heights: Vec<f64> = radii.iter().map(|a| a + (10.0 - 2.0 * a) * random.uniform()).collect();
                let velocities: Vec<Vector> = (0..30).map(|_| random.point()).collect();
                sum += radii.iter().map(|a| 4.0 / 3.0 * PI * a.powi(3)).sum::<f64>() / 360.0 / 5.0;
                moment += velocities.iter().sum::<Vector>();
                squares += velocities.iter().map(|v| v.x * v.x).sum::<f64>();
                let (slips, radii, heights) = (&velocities, &radii, &heights);
                profile.add(&ChannelSample {
                    heights,
                    radii,
                    species: &[0; 30],
                    velocities: &velocities,
                    slips,
                    ..NONE
                });
            }
            let rows: Vec<ChannelRow> = profile.rows(None).collect();
            let mean = |of: &dyn Fn(&ChannelRow) -> f64| {
                rows.iter().map(of).filter(|x| !x.is_nan()).sum::<f64>() / count as f64
            };
            assert!(
                close(mean(&|r| r.volume_fraction.mean), sum) && close(mean(&|r| r.number_density.mean), 30.0 / 360.0)
            );
            let by_number = |of: &dyn Fn(&ChannelRow) -> f64| mean(&|r| r.number_density.mean * of(r)) * 360.0 * 5.0;
            assert!(close(by_number(&|r| r.velocity[1].mean), moment.y), "{count}");
            let second = |r: &ChannelRow| r.fluctuations[0].mean + r.slip[0].mean.powi(2);
            assert!(close(by_number(&second), squares), "{count}");
            assert!(profile.outside().mean.abs() < 1e-14);
            assert!(rows[0].stress[0].mean.is_nan(), "there were no stresslets");
        }
    }

    #[test]
    fn the_state_lasts_bit_for_bit() {
        let new = || ChannelProfile::new([0.0, 4.0], 9.0, (1, 4));
        let add = |profile: &mut ChannelProfile, k: i32| {
            let heights = [1.0 + 0.3 * f64::from(k)];
            let velocities = [Vector::X * f64::from(k)];
            let sample =
                ChannelSample { heights: &heights, radii: &[1.0], species: &[0], velocities: &velocities, ..NONE };
            profile.add(&ChannelSample { slips: &velocities, stresslets: &[Tensor::IDENTITY], ..sample });
        };
        let (mut whole, mut first) = (new(), new());
        (0..7).for_each(|k| add(&mut whole, k));
        (0..3).for_each(|k| add(&mut first, k));
        let mut resumed = new();
        assert!(resumed.load(&first.save()));
        (3..7).for_each(|k| add(&mut resumed, k));
        assert_eq!(resumed, whole);
        assert!(!ChannelProfile::new([0.0, 4.0], 9.0, (1, 5)).load(&whole.save()));
    }
}
