//! Checked parameters of the shear cell.

use super::{CollisionRule, FrictionLaw, Side, WallContact};
use crate::parameter::{ParameterError, not_negative, of_sensible_size, positive, require, restitution};
use domain::{Number, Vector};
use std::f64::consts::PI;

/// Constraint of the top wall.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Top {
    /// Fixed at its height.
    #[default]
    Fixed,
    /// Free to move up and down under a load.
    Free {
        /// Normal stress of the load, including the weight of the wall.
        pressure: f64,
        /// Mass per area. A dead weight has `pressure / gravity`; less mass makes the wall respond faster.
        mass_per_area: f64,
    },
}

/// Parameters of a scene. The default is Yu and Tichy's cell at `U` = 1.4 m/s; they do not state
/// the friction of the grains.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellParameters {
    /// Period along the flow (x).
    pub length: f64,
    /// Gap between bottom and top (y).
    pub height: f64,
    /// Width between the side walls (z).
    pub width: f64,
    /// Diameter of the grains.
    pub diameter: f64,
    /// Density of their material.
    pub density: f64,
    /// Contact between grains.
    pub grain_contact: CollisionRule,
    /// Contact of a grain with a wall.
    pub wall_contact: CollisionRule,
    /// Speed of the bottom and side walls along x.
    pub speed: f64,
    /// Constraint of the top wall.
    pub top: Top,
    /// Acceleration of gravity along -y.
    pub gravity: f64,
    /// Circumference of the trough at mid-width, or `None` for a straight one.
    pub circumference: Option<f64>,
    /// Whether the curved path also turns velocity along z into velocity along x, `a_x = v_x v_z / r`.
    pub coriolis: bool,
    /// Two collisions of a grain within this time count as one contact; the second is elastic (event-driven engine).
    pub contact_time: f64,
}

impl Default for CellParameters {
    fn default() -> Self {
        let contact = CollisionRule { restitution: 0.9, friction: 0.3, law: FrictionLaw::Box };
        Self {
            length: 0.03,
            height: 4e-3,
            width: 0.019,
            diameter: 0.787e-3,
            density: 2550.0,
            grain_contact: contact,
            wall_contact: contact,
            speed: 1.4,
            top: Top::Fixed,
            gravity: 9.81,
            circumference: Some(0.479),
            coriolis: false,
            contact_time: 1e-7,
        }
    }
}

impl CellParameters {
    /// Grains in a box at rest without gravity or curvature, all of whose contacts are alike.
    pub(super) fn of_gas(edges: Vector, diameter: f64, density: f64, contact: CollisionRule) -> Self {
        let [length, height, width] = edges.to_array();
        Self {
            length,
            height,
            width,
            diameter,
            density,
            grain_contact: contact,
            wall_contact: contact,
            speed: 0.0,
            gravity: 0.0,
            circumference: None,
            // Short compared with the time in which a grain of a gas with speed 1 crosses a diameter.
            contact_time: 1e-9 * diameter,
            ..Self::default()
        }
    }

    /// Keys and values of the quantities, each with the power of ten up to which its size is sensible. The first five
    /// are positive, and the four after the circumference not negative.
    fn quantities(&self) -> [(&'static str, f64, i32); 13] {
        let (pressure, mass_per_area) = match self.top {
            Top::Free { pressure, mass_per_area } => (pressure, mass_per_area),
            Top::Fixed => (0.0, 0.0),
        };
        [
            ("cell.length", self.length, 40),
            ("cell.height", self.height, 40),
            ("cell.width", self.width, 40),
            ("grains.diameter", self.diameter, 40),
            ("grains.density", self.density, 140),
            ("cell.circumference", self.circumference.unwrap_or(0.0), 40),
            ("grains.friction", self.grain_contact.friction, 10),
            ("walls.friction", self.wall_contact.friction, 10),
            ("cell.speed", self.speed, 70),
            ("cell.gravity", self.gravity, 100),
            ("top.mass_per_area", mass_per_area, 100),
            ("top.pressure", pressure, 140),
            // Where a scene does not set it, it follows from the others.
            ("grains.contact_time", self.contact_time, 60),
        ]
    }
}

/// A shear cell, or a periodic box of its grains, with checked parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellModel {
    parameters: CellParameters,
    walled: bool,
    /// Radius of the trough at mid-width; infinite for a straight one.
    mid_radius: f64,
}

impl CellModel {
    /// The cell with its walls.
    pub fn new(parameters: CellParameters) -> Result<Self, ParameterError> {
        let p = &parameters;
        let quantities = p.quantities();
        quantities[..5].iter().try_for_each(|&(key, value, _)| positive(key, value))?;
        for (key, value, _) in &quantities[1..3] {
            require(*value > p.diameter, key, Number(*value), "more than a diameter")?;
        }
        require(p.length > 3.0 * p.diameter, "cell.length", Number(p.length), "more than three diameters")?;
        restitution("grains.restitution", p.grain_contact.restitution)?;
        restitution("walls.restitution", p.wall_contact.restitution)?;
        quantities[6..10].iter().try_for_each(|&(key, value, _)| not_negative(key, value))?;
        if let Some(around) = p.circumference {
            let wide = around.is_finite() && around > PI * p.width;
            let allowed = "more than pi times the width: the inner wall has a radius";
            require(wide, "cell.circumference", Number(around), allowed)?;
        }
        if let Top::Free { pressure, mass_per_area } = p.top {
            positive("top.pressure", pressure)?;
            positive("top.mass_per_area", mass_per_area)?;
        }
        quantities.into_iter().try_for_each(|(key, value, power)| of_sensible_size(key, value, power))?;
        positive("grains.contact_time", p.contact_time)?;
        Ok(Self { parameters, walled: true, mid_radius: 0.0 }.with(parameters))
    }

    /// A box that is periodic along all three axes, without walls, gravity or curvature: a granular gas.
    pub fn gas(edges: Vector, diameter: f64, density: f64, contact: CollisionRule) -> Result<Self, ParameterError> {
        let gas = CellParameters::of_gas(edges, diameter, density, contact);
        for (key, value, _) in &gas.quantities()[..3] {
            require(*value > 3.0 * diameter, key, Number(*value), "more than three diameters")?;
        }
        Ok(Self { walled: false, ..Self::new(gas)? })
    }

    /// The same geometry with other parameters, which are not checked.
    pub(super) fn with(&self, parameters: CellParameters) -> Self {
        let mid_radius = parameters.circumference.map_or(f64::INFINITY, |around| around / (2.0 * PI));
        Self { parameters, walled: self.walled, mid_radius }
    }

    /// The checked parameters.
    pub fn parameters(&self) -> &CellParameters {
        &self.parameters
    }

    /// Length, height and width; the height as given, wherever a free top wall may be.
    pub fn edges(&self) -> Vector {
        Vector::new(self.parameters.length, self.parameters.height, self.parameters.width)
    }

    /// Radius of a grain.
    pub fn radius(&self) -> f64 {
        0.5 * self.parameters.diameter
    }

    /// Mass of a grain.
    pub fn mass(&self) -> f64 {
        self.parameters.density * PI / 6.0 * self.parameters.diameter.powi(3)
    }

    /// Number of grains whose mean solid fraction is nearest to the given one.
    pub fn count(&self, solid_fraction: f64) -> Result<usize, ParameterError> {
        let fits = solid_fraction > 0.0 && solid_fraction <= 0.62;
        let allowed = "0 < solid_fraction <= 0.62: more can't be packed at random";
        require(fits, "grains.solid_fraction", Number(solid_fraction), allowed)?;
        let volume = self.edges().element_product();
        Ok((solid_fraction * volume / (PI / 6.0 * self.parameters.diameter.powi(3))).round() as usize)
    }

    /// Solid fraction of some grains under a top wall at a height.
    pub(super) fn solid_fraction(&self, count: usize, height: f64) -> f64 {
        let p = &self.parameters;
        count as f64 * PI / 6.0 * p.diameter.powi(3) / (p.length * p.width * height)
    }

    /// Whether an axis ends at walls instead of being periodic.
    pub fn is_walled(&self, axis: usize) -> bool {
        self.walled && axis > 0
    }

    /// Walls of the cell.
    pub fn sides(&self) -> &'static [Side] {
        if self.walled { &Side::ALL } else { &[] }
    }

    /// Area of a wall.
    pub fn area(&self, side: Side) -> f64 {
        self.parameters.length * if side.axis() == 1 { self.parameters.width } else { self.parameters.height }
    }

    /// A wall at a collision; `top_wall` is the upward velocity of a free top wall.
    pub(super) fn wall_contact(&self, side: Side, top_wall: f64) -> WallContact {
        let (p, top) = (&self.parameters, side == Side::Top);
        let velocity = if top { Vector::Y * top_wall } else { Vector::X * p.speed };
        let mass_ratio = if top { self.top_wall_mass().map_or(0.0, |mass| self.mass() / mass) } else { 0.0 };
        WallContact { side, velocity, mass_ratio }
    }

    /// Whether the top wall is free to move.
    pub fn is_top_wall_free(&self) -> bool {
        self.top_wall_mass().is_some()
    }

    /// Mass of a free top wall.
    pub(super) fn top_wall_mass(&self) -> Option<f64> {
        let Top::Free { mass_per_area, .. } = self.parameters.top else { return None };
        self.walled.then(|| mass_per_area * self.area(Side::Top))
    }

    /// Downward acceleration of a free top wall due to its load.
    pub(super) fn top_wall_acceleration(&self) -> f64 {
        let Top::Free { pressure, mass_per_area } = self.parameters.top else { return 0.0 };
        if self.walled { pressure / mass_per_area } else { 0.0 }
    }

    /// Typical upper bound on the difference between two neighbours' accelerations: gravity and
    /// the curvature of the path.
    pub(super) fn acceleration_bound(&self) -> f64 {
        self.parameters.gravity + self.parameters.speed.powi(2) / self.mid_radius + self.top_wall_acceleration()
    }

    /// Whether grains or the top wall accelerate between collisions.
    pub(super) fn has_body_force(&self) -> bool {
        self.parameters.gravity > 0.0 || self.mid_radius.is_finite() || self.top_wall_mass().is_some()
    }

    /// Acceleration of a grain: gravity along -y; in a curved trough of mid radius `r_m` also `a_z = -v_x^2/r` toward
    /// the outer wall at z = 0, `r = r_m - (z - W/2)`, and with `coriolis` its counterpart `a_x = v_x v_z/r`.
    #[inline]
    pub(super) fn acceleration(&self, position: Vector, velocity: Vector) -> Vector {
        let p = &self.parameters;
        let curvature = 1.0 / (self.mid_radius - (position.z - 0.5 * p.width));
        let along = if p.coriolis { velocity.x * velocity.z * curvature } else { 0.0 };
        Vector::new(along, -p.gravity, -velocity.x * velocity.x * curvature)
    }
}
