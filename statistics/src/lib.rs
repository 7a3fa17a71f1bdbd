//! Estimators of averages over a run, to which samples are added one after another. They do not keep the samples:
//! their memory is constant or grows as the logarithm of the length of the run. Their state can be stored and
//! restored bit for bit ([`State`]), and results are those of all samples at once, up to round-off.
//!
//! They are independent of scenes, files and ranks: the caller provides all particles, or parts of them whose sums it
//! adds up ([`VectorSum`], [`LagSums`], [`ChannelProfile::sums`]) or whose counts ([`Counts`]).
//!
//! Example: the mean of a correlated series, with an error that takes the correlation into account:
//! ```
//! use statistics::Blocks;
//!
//! let (mut blocks, mut value) = (Blocks::default(), 0.0);
//! for step in 0..10_000_u32 {
//!     let noise = f64::from(step.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24) - 0.5;
//!     value = 0.9 * value + noise;
//!     blocks.add(value);
//! }
//! let estimate = blocks.estimate();
//! assert!(estimate.converged && estimate.mean.abs() < 5.0 * estimate.error);
//! ```

mod blocks;
mod channel;
mod counts;
mod diffusion;
mod fluctuations;
mod histogram;
mod lagrangian;
mod memory;
mod moments;
mod oscillation;
mod pair_distribution;
mod profile;
mod segregation;
mod state;
mod steady_state;
mod stretched_exponential;

pub use blocks::{Blocks, Estimate};
pub use channel::{ChannelProfile, ChannelRow, ChannelSample};
pub use counts::Counts;
pub use diffusion::{Diffusivity, global_coefficient, mean_coefficient, mean_radius};
pub use fluctuations::Fluctuations;
pub use histogram::Histogram;
pub use lagrangian::{Lag, LagSums, Lagrangian, TrackedMotion};
pub use moments::{SecondMoments, VectorSum};
pub use oscillation::{FEWEST_SAMPLES, Moduli};
pub use pair_distribution::{Angle, PairDistribution};
pub use profile::Profile;
pub use segregation::SpeciesColumns;
pub use state::{Loader, Saver, State, Store};
pub use steady_state::{RequestedPrecision, SteadyMean, TimeSeries, Transient, Verdict};
pub use stretched_exponential::{StretchedExponential, maximum};
