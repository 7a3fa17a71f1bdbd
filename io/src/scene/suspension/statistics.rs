//! What a scene says of statistics.

use super::checks::{finite, positive};
use super::{Fault, raw};
use crate::Schedule;
use domain::{Number, PeriodicBox};
use serde::Deserialize;

/// What is averaged in the course of a run, and when.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Statistics {
    /// When samples are taken.
    pub samples: Schedule,
    /// The time of the first sample.
    pub from: f64,
    /// The largest distance of pairs whose distribution is wanted; the program's default where the scene has none.
    pub distance: Option<f64>,
    /// The axis of concentration and segregation; the program's choice where the scene has none.
    pub axis: Option<Axis>,
    /// The time lag from which motion is diffusive; the program's default where the scene has none.
    pub diffusive_from: Option<f64>,
}

/// An axis of the box.
#[derive(Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Axis {
    /// Along the flow.
    X,
    /// Along the gradient.
    Y,
    /// Along the vorticity.
    Z,
}

impl Statistics {
    /// Samples of every frame, and defaults.
    pub const ALL: Self =
        Self { samples: Schedule::EVERY_TIME, from: 0.0, distance: None, axis: None, diffusive_from: None };

    pub(super) fn checked(raw: &raw::Statistics, cell: &PeriodicBox) -> Result<Self, Fault> {
        let positive = |name: &str, value: Option<f64>| {
            value.map(|value| positive(&format!("statistics.{name}"), value)).transpose()
        };
        Ok(Self {
            samples: Schedule::every(raw.every),
            from: finite("statistics.from", raw.from)?,
            distance: raw.distance.map(|distance| Self::distance(distance, cell)).transpose()?,
            axis: raw.axis,
            diffusive_from: positive("diffusive_from", raw.diffusive_from)?,
        })
    }

    fn distance(distance: f64, cell: &PeriodicBox) -> Result<f64, Fault> {
        let distance = positive("statistics.distance", distance)?;
        Self::check_distance(distance, cell).map_err(|message| Fault::new("statistics.distance", message))?;
        Ok(distance)
    }

    /// Whether pairs in a box can be told apart up to a distance; if not, what is wrong with it.
    pub fn check_distance(distance: f64, cell: &PeriodicBox) -> Result<(), String> {
        let shortest = cell.edges().min_element();
        let (found, least, most) = (Number(distance), Number(SHORTEST * shortest), Number(shortest));
        if distance > shortest {
            return Err(format!("is {found}; pairs are told apart up to the box's shortest edge, {most}"));
        }
        if distance < SHORTEST * shortest {
            return Err(format!("is {found}; it needs at least {least:.4}, a millionth of the box's shortest edge"));
        }
        Ok(())
    }
}

/// The least distance of pairs that is told apart, over the box's shortest edge.
const SHORTEST: f64 = 1e-6;
