//! Forces between particles in contact.

use domain::Vector;

/// Contacts of all particles at one time, on the first rank.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForces {
    /// Number of steps taken.
    pub step: u64,
    /// Time of the contacts.
    pub time: f64,
    /// Lattice vectors.
    pub lattice: [Vector; 3],
    /// Contacts, in the order of their ids.
    pub list: Vec<ContactForce>,
}

/// Contact of two particles, the first of which has the lower id.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactForce {
    /// Ids of the particles.
    pub ids: [u64; 2],
    /// Centre of the first particle.
    pub position: Vector,
    /// Vector from there to the nearest image of the second particle's centre.
    pub separation: Vector,
    /// Normal force along that line: positive for repulsion, negative for attraction.
    pub normal: f64,
    /// Tangential force on the first particle.
    pub tangential: Vector,
    /// State of the contact.
    pub state: ContactState,
}

/// State of a contact, or a bond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactState {
    /// A contact without friction.
    Frictionless,
    /// Contact whose surfaces stick.
    Sticking,
    /// Contact whose surfaces slide.
    Sliding,
    /// A bond without a contact.
    Bond,
}

impl ContactState {
    /// All states; files store indices into this list.
    pub const ALL: [Self; 4] = [Self::Frictionless, Self::Sticking, Self::Sliding, Self::Bond];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frictionless => "frictionless",
            Self::Sticking => "sticking",
            Self::Sliding => "sliding",
            Self::Bond => "bond",
        }
    }

    /// Index in [`Self::ALL`].
    pub fn number(self) -> i32 {
        self as i32
    }
}
