//! Keys of rigid bodies.

use crate::document::{Alternative, NumberOr};
use schemars::JsonSchema;
use serde::Deserialize;

#[derive(Deserialize, JsonSchema, Default)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct BodiesSection {
    /// Name in the results.
    pub(in crate::suspension) name: Option<String>,
    /// Shape of the bodies, of equal spheres; or a list of spheres.
    pub(in crate::suspension) shape: Option<BodyShapeName>,
    /// Number of spheres, for "rod", "ring", "shell" and "aggregate"; or without a shape, the list of the spheres.
    pub(in crate::suspension) spheres: Option<SpheresKey>,
    /// Number of spheres along an edge, for "plate", "tetrahedron" and "cube".
    pub(in crate::suspension) edge: Option<u64>,
    /// Radius of the spheres of a shape; for "shell" by default that at which the nearest two touch.
    pub(in crate::suspension) radius: Option<f64>,
    /// Gap between neighbouring spheres of a shape, negative for spheres that overlap; 0 by default.
    pub(in crate::suspension) gap: Option<f64>,
    /// Radius of the surface on which the centres are, for "shell".
    pub(in crate::suspension) shell_radius: Option<f64>,
    /// Seed of the shape, for "aggregate"; that of the scene by default.
    pub(in crate::suspension) shape_seed: Option<u64>,
    /// Number of bodies; or positions, or `volume_fraction`.
    pub(in crate::suspension) count: Option<u64>,
    /// Volume of the spheres of the bodies over that of the box; or count, or positions.
    pub(in crate::suspension) volume_fraction: Option<f64>,
    /// Centres of the bodies at the start; random by default.
    pub(in crate::suspension) positions: Option<Vec<[f64; 3]>>,
    /// Orientations of the bodies at the start: "random" (default), or "aligned".
    pub(in crate::suspension) orientation: Option<BodyOrientationName>,
    /// Direction of the axes of the bodies at the start, for orientation = "aligned".
    pub(in crate::suspension) orientation_axis: Option<[f64; 3]>,
    /// Orientations of the bodies at the start one by one, as quaternions w, x, y, z.
    pub(in crate::suspension) orientations: Option<Vec<[f64; 4]>>,
    /// Density of the spheres minus that of the fluid; the weight acts at the centre of their volumes.
    pub(in crate::suspension) density_difference: Option<f64>,
    /// Constant force on each body, at the centre of its volumes, in addition to its weight.
    #[serde(default)]
    pub(in crate::suspension) force: [f64; 3],
    /// Constant torque on each body.
    #[serde(default)]
    pub(in crate::suspension) torque: [f64; 3],
    /// Given velocity of the centre of each body, component by component, each a number or "free"; the force that it
    /// takes is in the time series.
    pub(in crate::suspension) velocity: Option<[NumberOr<Free>; 3]>,
    /// Given angular velocity of each body, component by component, each a number or "free"; the torque that it takes
    /// is in the time series.
    pub(in crate::suspension) angular_velocity: Option<[NumberOr<Free>; 3]>,
}

/// A component of a motion that is not given.
#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum Free {
    Free,
}

impl Alternative for Free {
    const WORDS: &'static str = "a number or \"free\"";
}

/// Shapes that are made of equal spheres.
#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum BodyShapeName {
    Doublet,
    Rod,
    Ring,
    Plate,
    Tetrahedron,
    Cube,
    Shell,
    Aggregate,
}

/// Orientations of bodies at the start.
#[derive(Deserialize, JsonSchema, Clone, Copy, PartialEq)]
#[serde(rename_all = "kebab-case")]
pub(in crate::suspension) enum BodyOrientationName {
    Random,
    Aligned,
}

/// A number of spheres, or a list of them.
pub(in crate::suspension) type SpheresKey = NumberOr<Vec<BodySphereSection>>;

#[derive(Deserialize, JsonSchema, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(in crate::suspension) struct BodySphereSection {
    /// Centre of the sphere in the axes of the body.
    pub(in crate::suspension) position: [f64; 3],
    /// Radius.
    pub(in crate::suspension) radius: f64,
}

impl Alternative for Vec<BodySphereSection> {
    const WORDS: &'static str =
        "a number of spheres, or a list of them, as [{ position = [0.0, 0.0, 0.0], radius = 1.0 }]";
}
