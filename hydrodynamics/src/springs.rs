//! Implicit treatment of short-range forces.

use domain::Units;
use domain::parallel::RowLists;
use lubrication::PairKind;

/// Short-range forces, taken implicitly, at the end of a time `t`: between particles that separate at the rate `w`, a
/// repulsive force is reduced by `resistance w`, with the resistance `t` times the decay of the force with distance.
/// This acts like the resistance of lubrication, and motions do not overshoot however stiff the force is.
pub struct Springs<'a> {
    /// Resistance, force over velocity, of two particles or of a particle and a wall, as a function of the distance.
    pub resistance: &'a (dyn Fn(f64, PairKind) -> f64 + Sync),
    /// Contacts of each particle of the rank, in their order; or empty.
    pub contacts: &'a RowLists<ContactSprings>,
    /// Bonds and traps.
    pub tethers: &'a TetherResistance,
}

/// Implicit resistances of a contact, force over velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSprings {
    /// Id of the other particle, or the id that stands for a wall.
    pub other: u64,
    /// Distance below which an image of the other particle is the one in contact.
    pub within: f64,
    /// Resistance along the line of centres.
    pub normal: f64,
    /// Resistance to slip, the relative velocity of the surfaces at the point of contact, which divides the distance of
    /// the centres in proportion to the radii.
    pub tangential: f64,
    /// Resistance to rolling, the difference of the angular velocities perpendicular to the line of centres times the
    /// harmonic mean radius.
    pub rolling: f64,
}

/// Implicit resistance of a bond: to the separation of the centres, and that of a beam to bending and twisting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondSprings {
    /// Id of the other particle.
    pub other: u64,
    /// Distance below which an image of the other particle is the bonded one.
    pub within: f64,
    /// Force over velocity.
    pub resistance: f64,
    /// Torque on a sphere over its angular velocity across the line of centres, with everything else at rest.
    pub bending: f64,
    /// Torque over the difference of the angular velocities along the line of centres.
    pub twisting: f64,
}

/// Implicit resistances of a pair, as those of [`ContactSprings`] and [`BondSprings`] together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PairSprings {
    /// Resistance along the line of centres.
    pub along: f64,
    /// Resistance to slip.
    pub slip: f64,
    /// Resistance to rolling.
    pub rolling: f64,
    /// Resistance to bending.
    pub bending: f64,
    /// Resistance to twisting.
    pub twisting: f64,
}

/// Implicit resistances of bonds and traps for a rank's particles, force over velocity; empty without them.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TetherResistance {
    /// Resistances of bonds, particle by particle.
    pub bonds: RowLists<BondSprings>,
    /// Resistances of traps.
    pub traps: Vec<f64>,
}

impl ContactSprings {
    /// The id that stands for a wall: no particle has it, and a double holds it exactly.
    pub fn wall(wall: usize) -> u64 {
        (1 << 52) + wall as u64
    }

    /// These springs in other units of length and velocity.
    #[must_use]
    pub fn in_units(&self, units: &Units) -> Self {
        let [normal, tangential, rolling] =
            [self.normal, self.tangential, self.rolling].map(|resistance| resistance * units.velocity());
        Self { within: self.within / units.length, normal, tangential, rolling, ..*self }
    }
}

impl Springs<'_> {
    /// Resistances of a particle, by its row, and another, by its id.
    pub fn between(&self, row: usize, other: u64, distance: f64, radii: [f64; 2]) -> PairSprings {
        let [along, slip, rolling] = self.of(row, other, distance, radii.into());
        let bonds = self.tethers.bonds.of(row);
        let bond = bonds.iter().find(|bond| bond.other == other && distance < bond.within);
        let [stretching, bending, twisting] =
            bond.map_or([0.0; 3], |bond| [bond.resistance, bond.bending, bond.twisting]);
        PairSprings { along: along + stretching, slip, rolling, bending, twisting }
    }

    /// Resistances of a particle and a wall: along the normal, to slip, and to rolling.
    pub fn at_wall(&self, row: usize, wall: usize, distance: f64, radius: f64) -> [f64; 3] {
        self.of(row, ContactSprings::wall(wall), distance, PairKind::Wall(radius))
    }

    /// Resistances without bonds: along the line of centres, to slip, and to rolling.
    fn of(&self, row: usize, other: u64, distance: f64, between: PairKind) -> [f64; 3] {
        let is_this = |contact: &&ContactSprings| contact.other == other && distance < contact.within;
        let contact = self.contacts.of(row).iter().find(is_this);
        let [normal, tangential, rolling] = contact.map_or([0.0; 3], |c| [c.normal, c.tangential, c.rolling]);
        [(self.resistance)(distance, between) + normal, tangential, rolling]
    }

    /// Resistance of the trap of a particle, if it has one.
    pub fn trap(&self, row: usize) -> Option<f64> {
        self.tethers.traps.get(row).copied().filter(|&resistance| resistance > 0.0)
    }
}
