//! State and next event of a grain between two events.

use domain::Vector;

/// A grain in free flight: its state at its own `time`, from which it follows `x + v t + a t^2/2`. All data for
/// predicting a contact without acceleration are in one cache line.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub struct Grain {
    pub position: Vector,
    pub velocity: Vector,
    pub time: f64,
    pub cell: u32,
    /// Number of changes of its trajectory: a contact planned with an older stamp is void.
    pub stamp: u32,
}

/// The rest of a grain's state.
#[derive(Debug, Clone, Copy)]
pub struct Rotation {
    pub spin: Vector,
    pub last_collision: f64,
}

impl Grain {
    /// Position and velocity at a time, with or without an acceleration.
    #[inline]
    pub fn at(&self, time: f64, acceleration: Option<Vector>) -> (Vector, Vector) {
        let t = time - self.time;
        match acceleration {
            None => (self.position + self.velocity * t, self.velocity),
            Some(a) => (self.position + self.velocity * t + a * (0.5 * t * t), self.velocity + a * t),
        }
    }
}

/// Next event of a grain: the planned contact with a partner, or the exit from its cell.
#[derive(Debug, Clone, Copy, Default)]
pub struct NextEvent {
    /// Time of the contact.
    pub contact: f64,
    pub partner: u32,
    /// The partner's stamp when the contact was planned.
    pub stamp: u32,
    /// Time up to which contacts were searched for and the stored acceleration is valid.
    pub renewal: f64,
    /// Time at which it leaves its cell, or of its renewal.
    pub exit: f64,
    pub exit_by: Exit,
}

/// The way in which a grain's stay in a cell ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Exit {
    /// Through the face of this axis, up or down: into the next cell or against a wall.
    Face { axis: u8, up: bool },
    /// The stored acceleration is no longer valid.
    #[default]
    Renewal,
}
