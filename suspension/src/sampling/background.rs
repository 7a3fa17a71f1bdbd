//! Background flow without spheres, relative to which velocities are averaged, in the user's axes.

use crate::model::box_axes::UserAxes;
use crate::model::{Flow, Model};
use domain::Vector;
use hydrodynamics::Poiseuille;
use solver::BackgroundFlow;

/// The flows of a scene at any rate.
pub struct Flows {
    kind: Flow,
    /// Whether the gradient is along z, between walls.
    is_couette: bool,
    profile: Option<Poiseuille>,
    axes: UserAxes,
}

/// The flow at one time.
#[derive(Clone, Copy)]
pub struct Background {
    flow: BackgroundFlow,
    profile: Option<Poiseuille>,
    axes: UserAxes,
}

impl Flows {
    /// The flows of a model.
    pub fn of(model: &Model) -> Self {
        let is_couette = model.cell.gradient_axis() == 2;
        Self { kind: model.flow, is_couette, profile: model.poiseuille(), axes: model.user_axes() }
    }

    /// The linear flow at a rate, in the axes of the box.
    pub fn linear(&self, rate: f64) -> BackgroundFlow {
        if self.is_couette { BackgroundFlow::couette(rate) } else { self.kind.at_rate(rate) }
    }

    /// The whole flow at a rate.
    pub fn at_rate(&self, rate: f64) -> Background {
        Background { flow: self.linear(rate), profile: self.profile, axes: self.axes }
    }

    /// Whether the flow moves spheres along each of the user's axes.
    pub fn advects(&self, rate: f64) -> [bool; 3] {
        let gradient = self.linear(rate).gradient();
        let of_box = |axis: usize| gradient.row(axis) != Vector::ZERO || (axis == 0 && self.profile.is_some());
        self.axes.list([0, 1, 2].map(of_box))
    }
}

impl Background {
    /// Velocity of a free sphere in the flow.
    pub fn velocity_of(&self, place: Vector, radius: f64) -> Vector {
        let place = self.axes.place_in(place);
        let linear = self.flow.velocity(place);
        self.axes.vector(self.profile.map_or(linear, |profile| linear + profile.velocity_of(place.z, radius)))
    }

    /// Angular velocity of a free sphere in the flow.
    pub fn angular_velocity_at(&self, place: Vector) -> Vector {
        let linear = self.flow.angular_velocity();
        let height = self.axes.place_in(place).z;
        self.axes.vector(self.profile.map_or(linear, |profile| linear + profile.angular_velocity(height)))
    }
}
