//! Averages and totals over contacts.

use super::touching::{AllTouching, Touching};
use domain::parallel::{greatest, mapped, of_rows};
use domain::{Comm, Particles, Tensor};
use lubrication::{Contact, PairKind};

/// Averages and totals over contacts.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactStatistics {
    /// Contribution of each particle of this rank to the symmetric first moments of contact forces. For a pair at `x_i`
    /// and `x_j` with the force `F` on the first, the moment is the symmetric part of `-(x_i - x_j) F`; it is divided
    /// between the two in proportion to their radii.
    pub moments: Vec<Tensor>,
    sums: Sums,
}

/// Sums over this rank's contacts, in which each pair is counted once per particle.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    particles: f64,
    contacts: f64,
    frictional: f64,
    sliding: f64,
    energy: f64,
    /// Largest overlap, over the roughness.
    overlap: f64,
}

/// Shares of a contact, as seen by one of its particles, in the sums.
struct ContactTerms {
    energy: f64,
    is_frictional: bool,
    is_sliding: bool,
}

/// Largest overlap of this rank's contacts, over the roughness.
pub(super) fn largest_overlap(law: &Contact, touching: &AllTouching) -> f64 {
    let of_one = |contact: &Touching| contact.overlap / (law.roughness * contact.between.mean_radius());
    greatest(touching.list.items(), of_one)
}

/// Contribution of a contact to the first moment of its particle.
fn moment(law: &Contact, contact: &Touching) -> Tensor {
    let [force, _] = contact.load(law.force(contact.overlap, contact.between), &contact.memory);
    let arm = contact.arms[0] * contact.axis;
    let moment = Tensor::from_cols(arm * force.x, arm * force.y, arm * force.z);
    (moment + moment.transpose()) * 0.5
}

impl ContactTerms {
    fn of(law: &Contact, contact: &Touching) -> Self {
        let normal = law.force(contact.overlap, contact.between);
        let across = [contact.memory.force, contact.memory.rolling];
        // A contact of two spheres is in the sum twice.
        let share = if let PairKind::Wall(_) = contact.between { 1.0 } else { 0.5 };
        Self {
            energy: share * law.energy(contact.overlap, contact.between, across),
            is_frictional: law.coulomb_limit(normal) > 0.0,
            is_sliding: contact.memory.shares[0] < 1.0,
        }
    }
}

impl ContactStatistics {
    pub(super) fn of(law: &Contact, touching: &AllTouching, particles: &Particles) -> Self {
        let (contacts, particles) = (&touching.list, particles.len());
        let moment_of =
            |row: usize| contacts.of(row).iter().fold(Tensor::ZERO, |sum, contact| sum + moment(law, contact));
        let mut sums = Sums { particles: particles as f64, ..Sums::default() };
        // Summed in the order of the contacts on any number of threads.
        for terms in mapped(contacts.items(), |contact| ContactTerms::of(law, contact)) {
            sums.contacts += 1.0;
            sums.frictional += f64::from(u8::from(terms.is_frictional));
            sums.sliding += f64::from(u8::from(terms.is_sliding));
            sums.energy += terms.energy;
        }
        sums.overlap = largest_overlap(law, touching);
        Self { moments: of_rows(particles, moment_of), sums }
    }

    /// Mean number of contacts per particle, fractions of frictional and of sliding contacts, largest overlap over the
    /// roughness, and elastic energy. Collective.
    pub fn numbers(&self, comm: &Comm) -> [f64; 5] {
        let Sums { particles, contacts, frictional, sliding, energy, overlap } = self.sums;
        let mut sums = [particles, contacts, frictional, sliding, energy];
        let mut largest = [overlap];
        comm.sum(&mut sums);
        comm.max(&mut largest);
        let [particles, contacts, frictional, sliding, energy] = sums;
        let share = |part: f64| if contacts > 0.0 { part / contacts } else { 0.0 };
        [contacts / particles, share(frictional), share(sliding), largest[0], energy]
    }
}
