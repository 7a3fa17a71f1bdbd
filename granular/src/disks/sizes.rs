//! The distribution of the disks' radii.

use crate::fraction::ratio;
use crate::parameter::{ParameterError, finite, positive, require};
use domain::Number;

/// Disks of one radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiskSpecies {
    /// Radius, relative to those of other species.
    pub radius: f64,
    /// Number of disks, relative to other species.
    pub share: f64,
}

/// Number distribution of the radii. Its scale is fixed by the unit of length.
#[derive(Debug, Clone, PartialEq)]
pub enum Sizes {
    /// Any number of species; one species makes a monodisperse system.
    DiskSpecies(Vec<DiskSpecies>),
    /// All radii between two limits, with a density proportional to a power of the radius: a power of 0 is uniform.
    Spread {
        /// The smallest radius, relative to the largest.
        smallest: f64,
        /// The largest radius, relative to the smallest.
        largest: f64,
        /// The power.
        exponent: f64,
    },
}

/// The radius that is 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LengthUnit {
    /// The number average.
    #[default]
    Mean,
    /// The smallest radius.
    Smallest,
}

/// Radius and species of a disk.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Size {
    /// Radius.
    pub radius: f64,
    /// Index of its species in the list; for a spread of radii, 0 is the lower part and 1 the upper.
    pub species: u32,
}

impl Sizes {
    /// Small disks of relative radius 1 and large ones of radius `ratio`, `share` of them for each small one.
    pub fn bidisperse(ratio: f64, share: f64) -> Self {
        Self::DiskSpecies(vec![DiskSpecies { radius: 1.0, share: 1.0 }, DiskSpecies { radius: ratio, share }])
    }

    /// Disks of one radius.
    pub fn monodisperse() -> Self {
        Self::DiskSpecies(vec![DiskSpecies { radius: 1.0, share: 1.0 }])
    }

    /// Refuses radii and shares that are not positive.
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        match self {
            Self::DiskSpecies(list) => {
                require(!list.is_empty(), "species", "an empty list", "at least one species")?;
                list.iter().try_for_each(|s| {
                    positive("species.radius", s.radius)?;
                    positive("species.number_fraction", s.share)
                })
            }
            &Self::Spread { smallest, largest, exponent } => {
                positive("particles.spread.smallest", smallest)?;
                let above = largest >= smallest && largest.is_finite();
                let allowed = "a finite number, at least particles.spread.smallest";
                require(above, "particles.spread.largest", Number(largest), allowed)?;
                finite("particles.spread.exponent", exponent)
            }
        }
    }

    /// The same with a smallest radius of 1, so that results do not depend on the unit of the radii.
    fn relative(&self) -> Self {
        match self {
            Self::DiskSpecies(list) => {
                let smallest = list.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min);
                Self::DiskSpecies(
                    list.iter().map(|s| DiskSpecies { radius: ratio(s.radius, smallest), ..*s }).collect(),
                )
            }
            &Self::Spread { smallest, largest, exponent } => {
                Self::Spread { smallest: 1.0, largest: ratio(largest, smallest), exponent }
            }
        }
    }

    /// Number of disks that cover an area.
    pub(super) fn count(&self, area: f64, unit: LengthUnit) -> f64 {
        let relative = self.relative();
        match &relative {
            Self::DiskSpecies(list) => counts(list, unit_length(list, unit), area).iter().sum(),
            Self::Spread { .. } => {
                let mean_area = relative.scaled(4096, unit).into_iter().map(disk_area).sum::<f64>() / 4096.0;
                (area / mean_area).round().max(1.0)
            }
        }
    }

    /// The disks that cover an area, as nearly as a whole number of them can.
    pub(super) fn cover(&self, area: f64, unit: LengthUnit) -> Vec<Size> {
        let relative = self.relative();
        let Self::DiskSpecies(list) = &relative else { return relative.cover_by_spread(area, unit) };
        let length = unit_length(list, unit);
        let counts = counts(list, length, area);
        let mut sizes = Vec::with_capacity(counts.iter().sum::<f64>() as usize);
        for (species, (one, &count)) in (0..).zip(list.iter().zip(&counts)) {
            sizes.extend(std::iter::repeat_n(Size { radius: one.radius / length, species }, count as usize));
        }
        sizes
    }

    fn cover_by_spread(&self, area: f64, unit: LengthUnit) -> Vec<Size> {
        let count = self.count(area, unit) as usize;
        let radii = self.scaled(count, unit);
        let divide = (radii[0] * radii[count - 1]).sqrt();
        radii.into_iter().map(|radius| Size { radius, species: u32::from(radius > divide) }).collect()
    }

    /// `count` radii of a spread, at equally spaced quantiles.
    fn scaled(&self, count: usize, unit: LengthUnit) -> Vec<f64> {
        let radii: Vec<f64> = (0..count).map(|i| self.quantile((i as f64 + 0.5) / count as f64)).collect();
        let length = match unit {
            LengthUnit::Mean => radii.iter().sum::<f64>() / radii.len() as f64,
            LengthUnit::Smallest => self.quantile(0.0),
        };
        radii.into_iter().map(|r| r / length).collect()
    }

    /// Quantile of the radius: a fraction of all disks is smaller. In closed form for a spread.
    fn quantile(&self, fraction: f64) -> f64 {
        let &Self::Spread { smallest, largest, exponent } = self else { return 1.0 };
        let power = exponent + 1.0;
        if power == 0.0 {
            return smallest * (largest / smallest).powf(fraction);
        }
        let [low, high] = [smallest, largest].map(|r| r.powf(power));
        (low + fraction * (high - low)).powf(1.0 / power)
    }
}

/// Numbers of disks of each species. Numbers of species other than the most frequent one follow their shares; the
/// most frequent one fills the remaining area.
fn counts(list: &[DiskSpecies], length: f64, area: f64) -> Vec<f64> {
    let covers: Vec<f64> = list.iter().map(|s| disk_area(s.radius / length)).collect();
    let frequent = (1..list.len()).fold(0, |best, s| if list[s].share > list[best].share { s } else { best });
    let each = area / list.iter().zip(&covers).map(|(s, cover)| s.share * cover).sum::<f64>();
    let mut counts: Vec<f64> = list.iter().map(|s| (s.share * each).round()).collect();
    counts[frequent] = 0.0;
    let covered: f64 = counts.iter().zip(&covers).map(|(count, cover)| count * cover).sum();
    counts[frequent] = ((area - covered) / covers[frequent]).round().max(0.0);
    counts
}

/// The radius that is 1, in the unit of the list.
fn unit_length(list: &[DiskSpecies], unit: LengthUnit) -> f64 {
    match unit {
        LengthUnit::Mean => {
            list.iter().map(|s| s.share * s.radius).sum::<f64>() / list.iter().map(|s| s.share).sum::<f64>()
        }
        LengthUnit::Smallest => list.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min),
    }
}

fn disk_area(radius: f64) -> f64 {
    std::f64::consts::PI * radius * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fraction(sizes: &[Size]) -> f64 {
        sizes.iter().map(|s| disk_area(s.radius)).sum::<f64>() / 1e4
    }

    #[test]
    fn the_papers_mixture_has_1460_disks() {
        let sizes = Sizes::bidisperse(4.0, 0.05).cover(6000.0, LengthUnit::Mean);
        let big: Vec<&Size> = sizes.iter().filter(|s| s.species == 1).collect();
        assert_eq!((sizes.len(), big.len()), (1460, 69));
        assert!((big[0].radius - 3.5).abs() < 1e-15 && (sizes[0].radius - 0.875).abs() < 1e-15);
        assert!((fraction(&sizes) - 0.60012).abs() < 1e-5);
        let small_unit = Sizes::bidisperse(4.0, 0.05).cover(6000.0, LengthUnit::Smallest);
        assert_eq!(small_unit.iter().filter(|s| s.species == 1).count(), 53);
        assert_eq!(small_unit.len(), 1115);
    }

    #[test]
    fn a_rare_species_too_large_for_the_area_leaves_it_to_the_others() {
        // Half a disk of radius 1000 would cover as much as half a million small ones.
        let sizes = Sizes::bidisperse(1000.0, 1e-7);
        let count = sizes.count(1e6, LengthUnit::Smallest) as usize;
        assert_eq!(count, (1e6 / std::f64::consts::PI).round() as usize);
        assert_eq!(sizes.cover(1e6, LengthUnit::Smallest).len(), count);
        let spread = Sizes::Spread { smallest: 1.0, largest: 3.0, exponent: -2.0 };
        let count = spread.count(6000.0, LengthUnit::Mean) as usize;
        assert_eq!(spread.cover(6000.0, LengthUnit::Mean).len(), count);
    }

    #[test]
    fn spreads_and_many_species_cover_what_they_should() {
        for exponent in [-3.0, -1.0, 0.0, 2.0] {
            let sizes = Sizes::Spread { smallest: 1.0, largest: 3.0, exponent }.cover(6000.0, LengthUnit::Mean);
            let mean = sizes.iter().map(|s| s.radius).sum::<f64>() / sizes.len() as f64;
            // Up to half a disk.
            assert!((fraction(&sizes) - 0.6).abs() < 5e-4 && (mean - 1.0).abs() < 1e-12, "{exponent}");
        }
        let three = [(1.0, 6.0), (2.0, 3.0), (3.0, 1.0)].map(|(radius, share)| DiskSpecies { radius, share });
        let sizes = Sizes::DiskSpecies(three.to_vec()).cover(6000.0, LengthUnit::Smallest);
        let count = |species| sizes.iter().filter(|s| s.species == species).count() as f64;
        assert!((fraction(&sizes) - 0.6).abs() < 5e-4);
        assert!((count(0) / count(1) - 2.0).abs() < 0.05 && (count(1) / count(2) - 3.0).abs() < 0.1);
    }
}
