//! Short-range forces that change while particles move.

use lubrication::Surfaces;

/// Forces between near particles, taken not as they are but as they will be after some time: a pair that opens at the rate
/// `w` then pushes with a force that is less by `resistance w`, the force's decay with distance times that time. So it
/// resists to motions like lubrication, and however stiff it is, no motion overshoots.
pub struct Springs<'a> {
    /// Resistance, force over velocity, of two particles, or of one and a wall, by the distance of their centres.
    pub resistance: &'a (dyn Fn(f64, Surfaces) -> f64 + Sync),
    /// The particles that touch each of those that the rank owns, in their order; or nothing.
    pub contacts: &'a [Vec<ContactSprings>],
    /// Bonds and traps.
    pub tethers: &'a TetherResistance,
}

/// What a contact resists to the motions of two particles, force over velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSprings {
    /// The id of the other particle, or that which stands for a wall.
    pub other: u64,
    /// Along the line of centres.
    pub normal: f64,
    /// Across, by the relative velocity of the surfaces where they touch: with arms that divide the distance of the centres
    /// as the radii do.
    pub tangential: f64,
    /// By the difference of angular velocities across the line of centres times the harmonic mean radius.
    pub rolling: f64,
}

/// What a bond resists to the parting of the centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondSprings {
    /// The id of the other particle.
    pub other: u64,
    /// The distance up to which an image of it is the one that is meant.
    pub within: f64,
    /// Force over velocity.
    pub resistance: f64,
}

/// What bonds and traps resist to motions of the particles that a rank owns, force over velocity; empty without them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TetherResistance {
    /// Of bonds, particle by particle.
    pub bonds: Vec<Vec<BondSprings>>,
    /// Of traps.
    pub traps: Vec<f64>,
}

impl ContactSprings {
    /// What stands for the id of a wall: no particle has such, and it is a whole number that a double holds.
    pub fn wall(wall: usize) -> u64 {
        (1 << 52) + wall as u64
    }

    /// The same in another unit of velocity.
    #[must_use]
    pub fn times(&self, unit: f64) -> Self {
        let Self { other, normal, tangential, rolling } = *self;
        Self { other, normal: normal * unit, tangential: tangential * unit, rolling: rolling * unit }
    }
}

impl Springs<'_> {
    /// What a particle in a row and another, of an id, of some radii and at a distance of their centres resist: along their
    /// line, across it, and to rolling.
    pub fn between(&self, rows: (usize, u64), distance: f64, radii: [f64; 2]) -> [f64; 3] {
        self.of(rows, distance, radii.into())
    }

    /// The same of a particle in a row and a wall.
    pub fn at_wall(&self, (row, wall): (usize, usize), distance: f64, radius: f64) -> [f64; 3] {
        self.of((row, ContactSprings::wall(wall)), distance, Surfaces::Wall(radius))
    }

    fn of(&self, (row, other): (usize, u64), distance: f64, between: Surfaces) -> [f64; 3] {
        let contact = self.contacts.get(row).and_then(|all| all.iter().find(|contact| contact.other == other));
        let [normal, tangential, rolling] = contact.map_or([0.0; 3], |c| [c.normal, c.tangential, c.rolling]);
        [(self.resistance)(distance, between) + normal + self.bond((row, other), distance), tangential, rolling]
    }

    /// What a bond resists along its line.
    fn bond(&self, (row, other): (usize, u64), distance: f64) -> f64 {
        let mut bonds = self.tethers.bonds.get(row).into_iter().flatten();
        bonds.find(|bond| bond.other == other && distance < bond.within).map_or(0.0, |bond| bond.resistance)
    }

    /// What a trap resists to the motion of the particle in a row, if there is one.
    pub fn trap(&self, row: usize) -> Option<f64> {
        self.tethers.traps.get(row).copied().filter(|&resistance| resistance > 0.0)
    }
}
