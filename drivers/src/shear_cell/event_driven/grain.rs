//! A grain between two events.

use domain::Vector;

/// A grain in free flight: the state at its own `time`, from which it follows `x + v t + a t^2/2`. It has all that is
/// needed to predict a contact without acceleration, in one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct Grain {
    pub position: Vector,
    pub velocity: Vector,
    pub time: f64,
    pub cell: u32,
    /// The number of changes of its course: a contact planned with an older stamp is void.
    pub stamp: u32,
}

/// The rest of a grain's state.
#[derive(Debug, Clone, Copy)]
pub struct Rest {
    pub spin: Vector,
    pub last_hit: f64,
}

impl Grain {
    /// Position and velocity at a time, under an acceleration or none.
    #[inline]
    pub fn at(&self, time: f64, acceleration: Option<Vector>) -> (Vector, Vector) {
        let t = time - self.time;
        match acceleration {
            None => (self.position + self.velocity * t, self.velocity),
            Some(a) => (self.position + self.velocity * t + a * (0.5 * t * t), self.velocity + a * t),
        }
    }
}

/// What a grain does next: the contact planned with a partner, or the end of its stay in the cell.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Time of the contact.
    pub contact: f64,
    pub partner: u32,
    /// The partner's stamp when the contact was planned.
    pub stamp: u32,
    /// Time up to which contacts were looked for, and for which its acceleration serves.
    pub renewal: f64,
    /// Time at which it leaves its cell, or of its renewal.
    pub exit: f64,
    pub exit_by: Exit,
}

/// How a grain's stay in a cell ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Through the face of this axis, up or down: into the next cell or against a wall.
    Face { axis: u8, up: bool },
    /// Its acceleration has served its time.
    Renewal,
}
