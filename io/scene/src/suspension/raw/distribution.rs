//! Keys of distributions of radii.

use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct DistributionSection {
    /// Kind of distribution.
    pub(in crate::suspension) kind: DistributionKind,
    /// Number of classes of spheres that represent it; 4 by default.
    pub(in crate::suspension) classes: Option<usize>,
    /// Number average of the radius, for "log-normal".
    pub(in crate::suspension) mean: Option<f64>,
    /// Standard deviation of the radius by number, for "log-normal".
    pub(in crate::suspension) standard_deviation: Option<f64>,
    /// Smallest radius, for "power-law".
    pub(in crate::suspension) smallest: Option<f64>,
    /// Largest radius, for "power-law".
    pub(in crate::suspension) largest: Option<f64>,
    /// Power of the radius in the number density, for "power-law".
    pub(in crate::suspension) exponent: Option<f64>,
    /// Radii and their relative numbers, for "table".
    pub(in crate::suspension) table: Option<Vec<[f64; 2]>>,
}

#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum DistributionKind {
    LogNormal,
    PowerLaw,
    Table,
}
