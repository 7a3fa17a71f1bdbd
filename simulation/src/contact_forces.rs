//! Forces between particles that touch.

use domain::Vector;

/// The contacts of all particles at one time, on the first rank.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForces {
    /// Steps taken.
    pub step: u64,
    /// The time.
    pub time: f64,
    /// The vectors of the lattice.
    pub lattice: [Vector; 3],
    /// The contacts, in the order of their ids.
    pub list: Vec<ContactForce>,
}

/// The contact of two particles, of which the first has the lower id.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Their ids.
    pub ids: [u64; 2],
    /// The centre of the first.
    pub place: Vector,
    /// From there to the centre of the second, as near as it is.
    pub separation: Vector,
    /// The force that pushes them apart along that line; below 0 where it pulls.
    pub normal: f64,
    /// The force on the first across that line.
    pub tangential: Vector,
    /// What holds them.
    pub state: ContactState,
}

/// What holds two particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactState {
    /// A contact without friction.
    Frictionless,
    /// One whose surfaces stick.
    Sticking,
    /// One whose surfaces slide.
    Sliding,
    /// No contact but a bond.
    Bond,
}

impl ContactState {
    /// All of them; files have their places in this list.
    pub const ALL: [Self; 4] = [Self::Frictionless, Self::Sticking, Self::Sliding, Self::Bond];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frictionless => "frictionless",
            Self::Sticking => "sticking",
            Self::Sliding => "sliding",
            Self::Bond => "bond",
        }
    }

    /// Its place among all.
    pub fn number(self) -> i32 {
        self as i32
    }
}
