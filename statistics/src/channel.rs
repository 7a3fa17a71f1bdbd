//! Profiles across a channel, above a wall, or through a layer.

use crate::moments::COMPONENTS;
use crate::profile::cap;
use crate::{Blocks, Estimate, Fluctuations, SecondMoments, State, Store, VectorSum};
use bytemuck::{Pod, Zeroable};
use domain::{Tensor, Vector};

/// Averages over bins of equal width across a channel, for each species and for all spheres, with errors by blocking
/// of the samples. A sphere of radius `a` contributes to each bin with the volume `V_b` of its slice there,
///
/// ```text
/// phi_b = sum_n V_b,n / V_bin,      s_b = sum_n (V_b,n / (4/3 pi a_n^3)) S_n / V_bin,
/// ```
///
/// the volume fraction and the stress by the stresslets `S_n`, and likewise the stress of pairs by their moments;
/// number density and velocities are of the spheres whose centres are in the bin.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelProfile {
    bottom: f64,
    width: f64,
    bin_volume: f64,
    count: usize,
    /// `[group][bin]`: each species, then all of them together.
    bins: Vec<Vec<Bin>>,
    /// Fraction of the spheres' volume that is in no bin.
    outside: Blocks,
}

/// Averages in a bin.
#[derive(Debug, Clone, Default, PartialEq)]
struct Bin {
    fraction: Blocks,
    density: Blocks,
    velocities: Fluctuations,
    slips: Fluctuations,
    angular_velocities: Fluctuations,
    stress: [Blocks; 6],
    pair_stress: [Blocks; 6],
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
    /// Velocities relative to those of isolated force-free spheres in the flow without walls.
    pub slips: &'a [Vector],
    /// Angular velocities; empty if spheres do not rotate.
    pub angular_velocities: &'a [Vector],
    /// Stresslets, force times length; empty if there are none.
    pub stresslets: &'a [Tensor],
    /// Spheres' shares of the symmetric first moments of forces between spheres and with walls; empty if there are no
    /// such forces.
    pub pair_moments: &'a [Tensor],
}

/// Averages in a bin; velocities are NaN if no centre was in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChannelRow {
    /// Middle of the bin.
    pub height: f64,
    /// Volume fraction.
    pub volume_fraction: Estimate,
    /// Number of centres over volume.
    pub number_density: Estimate,
    /// Mean velocity.
    pub velocity: [Estimate; 3],
    /// Mean velocity relative to the flow without spheres.
    pub slip: [Estimate; 3],
    /// `<s_i s_j> - <s_i> <s_j>` of these, xx xy xz yy yz zz.
    pub fluctuations: [Estimate; 6],
    /// Mean angular velocity.
    pub angular_velocity: [Estimate; 3],
    /// Stress by stresslets, xx xy xz yy yz zz, force over area.
    pub stress: [Estimate; 6],
    /// Stress by forces between spheres, likewise; NaN without samples of them.
    pub pair_stress: [Estimate; 6],
}

/// Sums over the spheres in a bin.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct BinSums {
    /// Sums of the volumes of slices, and of the stresslets and moments in them.
    volume: f64,
    stress: [f64; 6],
    pair_stress: [f64; 6],
    velocities: VectorSum,
    slips: VectorSum,
    angular_velocities: VectorSum,
}

/// Sums of squares in a bin: of velocities, slips and angular velocities.
type BinMoments = [SecondMoments; 3];

/// Count of the numbers in either for one bin.
const OF_SUMS: usize = size_of::<BinSums>() / size_of::<f64>();
const OF_MOMENTS: usize = size_of::<BinMoments>() / size_of::<f64>();

impl ChannelProfile {
    /// Number of series in a bin.
    pub(crate) const SERIES: usize = size_of::<Bin>() / size_of::<Blocks>();

    /// `count` bins from the bottom to the top of a channel whose cross-section has the given area, for `species`
    /// species.
    pub fn new([bottom, top]: [f64; 2], area: f64, species: usize, count: usize) -> Self {
        let width = (top - bottom) / count as f64;
        let bins = vec![vec![Bin::default(); count]; species + 1];
        Self { bottom, width, bin_volume: area * width, count, bins, outside: Blocks::default() }
    }

    /// Adds all spheres at one time.
    pub fn add(&mut self, sample: &ChannelSample) {
        let sums = self.sums(sample);
        let second_moments = self.second_moments(sample, &sums);
        self.add_sums(&sums, &second_moments, [sample.stresslets, sample.pair_moments].map(|list| !list.is_empty()));
    }

    /// Sums over some of the spheres at one time; sums of parts are added number by number.
    pub fn sums(&self, sample: &ChannelSample) -> Vec<f64> {
        let mut all = vec![0.0; 2 + OF_SUMS * self.bins.len() * self.count];
        let (whole, bins) = all.split_at_mut(2);
        let bins: &mut [BinSums] = bytemuck::cast_slice_mut(bins);
        for n in 0..sample.heights.len() {
            self.add_slices(bins, &mut whole[0], sample, n);
            whole[1] += cap(sample.radii[n], sample.radii[n]);
            for place in self.places_of_centre(sample, n).into_iter().flatten() {
                bins[place].velocities.add(sample.velocities[n]);
                bins[place].slips.add(sample.slips[n]);
                if let Some(&angular_velocity) = sample.angular_velocities.get(n) {
                    bins[place].angular_velocities.add(angular_velocity);
                }
            }
        }
        all
    }

    /// Adds a sphere's slices to each bin of its species and of all, and to the volume inside of the bins.
    fn add_slices(&self, bins: &mut [BinSums], inside: &mut f64, sample: &ChannelSample, n: usize) {
        let (height, radius) = (sample.heights[n], sample.radii[n]);
        let volume = cap(radius, radius);
        let moments = [sample.stresslets, sample.pair_moments].map(|list| list.get(n).copied().unwrap_or(Tensor::ZERO));
        let edge = |bin: usize| cap(self.bottom + bin as f64 * self.width - height, radius);
        let [first, last] = [height - radius, height + radius].map(|z| (z - self.bottom) / self.width);
        for bin in first.max(0.0) as usize..(last.max(0.0).ceil() as usize).min(self.count) {
            let part = edge(bin + 1) - edge(bin);
            let shares = moments.map(|moment| moment * (part / volume));
            for place in self.places(sample, n, bin) {
                let BinSums { volume, stress, pair_stress, .. } = &mut bins[place];
                *volume += part;
                for (sums, share) in [stress, pair_stress].into_iter().zip(shares) {
                    for (sum, (i, j)) in sums.iter_mut().zip(COMPONENTS) {
                        *sum += share.col(i)[j];
                    }
                }
            }
            *inside += part;
        }
    }

    /// Indices of a bin for a sphere's species and for all.
    fn places(&self, sample: &ChannelSample, n: usize, bin: usize) -> [usize; 2] {
        [sample.species[n] as usize, self.bins.len() - 1].map(|group| group * self.count + bin)
    }

    /// The same for the bin that contains its centre.
    fn places_of_centre(&self, sample: &ChannelSample, n: usize) -> Option<[usize; 2]> {
        let bin = ((sample.heights[n] - self.bottom) / self.width).floor();
        (0.0..self.count as f64).contains(&bin).then(|| self.places(sample, n, bin as usize))
    }

    /// Sums of squares over some of the spheres, about the means from the sums of all; those of parts are added
    /// number by number.
    pub fn second_moments(&self, sample: &ChannelSample, sums: &[f64]) -> Vec<f64> {
        let sums: &[BinSums] = bytemuck::cast_slice(&sums[2..]);
        let mean = |sums: &BinSums| [sums.velocities, sums.slips, sums.angular_velocities].map(|sum| sum.mean());
        let means: Vec<[Vector; 3]> = sums.iter().map(mean).collect();
        let mut all = vec![0.0; OF_MOMENTS * sums.len()];
        let bins: &mut [BinMoments] = bytemuck::cast_slice_mut(&mut all);
        for n in 0..sample.heights.len() {
            for place in self.places_of_centre(sample, n).into_iter().flatten() {
                for (moments, (value, mean)) in
                    bins[place].iter_mut().zip(motion(sample, n).into_iter().zip(means[place]))
                {
                    moments.add(value - mean);
                }
            }
        }
        all
    }

    /// Adds all spheres at one time by their sums, which may lack stresslets or moments of pairs.
    pub fn add_sums(&mut self, sums: &[f64], second_moments: &[f64], [has_stresslets, has_pair_moments]: [bool; 2]) {
        self.outside.add(1.0 - sums[0] / sums[1]);
        let over = 1.0 / self.bin_volume;
        let (sums, second_moments): (&[BinSums], &[BinMoments]) =
            (bytemuck::cast_slice(&sums[2..]), bytemuck::cast_slice(second_moments));
        for ((bin, sums), second_moments) in self.bins.iter_mut().flatten().zip(sums).zip(second_moments) {
            bin.fraction.add(sums.volume * over);
            let stresses = [
                (has_stresslets, &mut bin.stress, sums.stress),
                (has_pair_moments, &mut bin.pair_stress, sums.pair_stress),
            ];
            for (_, series, sums) in stresses.into_iter().filter(|(is_known, ..)| *is_known) {
                series.iter_mut().zip(sums).for_each(|(blocks, sum)| blocks.add(sum * over));
            }
            bin.density.add(sums.velocities.count / self.bin_volume);
            bin.velocities.add_sums(&sums.velocities, &second_moments[0]);
            bin.slips.add_sums(&sums.slips, &second_moments[1]);
            bin.angular_velocities.add_sums(&sums.angular_velocities, &second_moments[2]);
        }
    }

    /// Averages in each bin, from the bottom up, of a species or, for `None`, of all.
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
            pair_stress: bin.pair_stress.each_ref().map(Blocks::estimate),
        })
    }

    /// Whether any sample had forces between spheres.
    pub fn has_pair_stress(&self) -> bool {
        self.bins.iter().flatten().next().is_some_and(|bin| bin.pair_stress[0].count() > 0)
    }

    /// Fraction of the spheres' volume that is in no bin: above the top, or below the bottom.
    pub fn outside(&self) -> Estimate {
        self.outside.estimate()
    }
}

/// Velocity, slip and angular velocity.
fn motion(sample: &ChannelSample, n: usize) -> [Vector; 3] {
    [sample.velocities[n], sample.slips[n], sample.angular_velocities.get(n).copied().unwrap_or(Vector::ZERO)]
}

impl State for ChannelProfile {
    fn visit(&mut self, store: &mut dyn Store) {
        self.outside.visit(store);
        for bin in self.bins.iter_mut().flatten() {
            for fluctuations in [&mut bin.velocities, &mut bin.slips, &mut bin.angular_velocities] {
                fluctuations.visit(store);
            }
            for blocks in
                [&mut bin.fraction, &mut bin.density].into_iter().chain(&mut bin.stress).chain(&mut bin.pair_stress)
            {
                blocks.visit(store);
            }
        }
    }
}

#[cfg(test)]
mod tests;
