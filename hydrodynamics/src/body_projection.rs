//! Loads and motions of spheres as those of rigid bodies.

use crate::ambient::StrainRate;
use crate::bodies::RigidBodies;
use crate::bodies::matrix::{BodyMatrix, SphereResistance, motion_of_member};
use crate::bodies::members::Members;
use crate::pairs::matrix::diagonal_block::inverse;
use crate::pairs::matrix::lanes::{LANES, SimdLanes};
use crate::pairs::search::NearPairs;
use crate::six_vector::{SixVector, SixVectors};
use domain::Particles;
use domain::parallel::{MeasuredLoop, change, change_rows, mapped, of_rows};
use fcm::{Linear, Motion};
use lubrication::Arithmetic;
use rayon::prelude::*;
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;

/// Rigid bodies in the solve with the resistance of single spheres and of stiff pairs. With `Z` the resistance of
/// single spheres, `S = K^T Z K` is that of the bodies if their spheres do not interact. Where components of the motion
/// of a body are given, `K` has columns for the others alone, and the inverses have zeros.
pub struct BodyProjection<'a> {
    bodies: &'a RigidBodies,
    single: &'a [SixVector],
    /// Motions of the spheres relative to the background flow when the unknown motions of their bodies are zero.
    offsets: SixVectors,
    /// `S^-1` of each body.
    inverse: Vec<BodyMatrix>,
    /// `(S + K^T R K)^-1 S` of each body, with the resistance `R` of its own stiff pairs; `None` without such pairs.
    preconditioner: Option<Vec<BodyMatrix>>,
}

/// Number of bodies whose matrices one thread inverts at a time.
const BATCH: usize = 64;

impl<'a> BodyProjection<'a> {
    /// The projection for spheres with single-sphere resistances, and with the given motions relative to the background
    /// flow when their bodies rest relative to it. Collective.
    pub fn new(bodies: &'a RigidBodies, near: &NearPairs, single: &'a [SixVector], mut offsets: SixVectors) -> Self {
        let (members, given) = (bodies.members(), bodies.given_components());
        let alone = |row: usize| {
            let arm = members.arm(row);
            BodyMatrix::of_members([arm; 2], &SphereResistance::of_single(&single[row]))
        };
        let alone = bodies.matrices(alone);
        let preconditioner = near.stiff_of_bodies().map(|stiff| {
            let mut resistance = bodies.matrices(|row| stiff.of_member(members, row));
            change(&mut resistance, &alone, |sum, &of_body| *sum += of_body);
            let mut preconditioner = inverses(resistance, &given);
            change(&mut preconditioner, &alone, |inverse, s| *inverse = inverse.product(s));
            preconditioner
        });
        if !given.is_empty() {
            let moved = SixVectors(mapped(&given, |given| SixVector(given.map(Option::unwrap_or_default))));
            change_rows(&mut offsets.0, |row, offset| *offset += members.motion(row, &moved).unwrap_or_default());
        }
        Self { bodies, single, offsets, inverse: inverses(alone, &given), preconditioner }
    }

    /// Replaces the loads on members by those with the same totals that move single spheres as parts of their bodies:
    /// `Z K S^-1 K^T L`. Collective.
    pub fn project(&self, loads: &mut SixVectors) {
        let motions = self.moved(&self.bodies.totals(loads));
        let (members, single) = (self.bodies.members(), self.single);
        change_rows(&mut loads.0, |row, load| {
            if let Some(motion) = members.motion(row, &motions) {
                *load = resisted(&single[row], motion);
            }
        });
    }

    /// Overwrites the motions of members by those under projected loads: any member tells the load on its body. Without
    /// stiff pairs these are the motions of single spheres under the projected loads.
    pub fn precondition(&self, projected: &SixVectors, motions: &mut SixVectors) {
        let Some(preconditioner) = &self.preconditioner else { return };
        let (members, single) = (self.bodies.members(), self.single);
        let of_body = |(body, matrix): (usize, &BodyMatrix)| {
            let row = members.rows(body)[0] as usize;
            let moved = SixVector(std::array::from_fn(|k| projected.0[row].0[k] / single[row].0[k]));
            matrix.times(&motion_of_member(moved, -members.arm(row)))
        };
        let moved = SixVectors(preconditioner.par_iter().enumerate().map(of_body).measured().collect());
        change_rows(&mut motions.0, |row, motion| {
            if let Some(rigid) = members.motion(row, &moved) {
                *motion = rigid;
            }
        });
    }

    /// Replaces motions relative to the background flow by the nearest ones in which bodies are rigid. Collective.
    pub fn make_rigid(&self, motions: &mut SixVectors) {
        motions.add(-1.0, &self.offsets);
        let moved = self.moved(&self.bodies.totals(&motions.resisted(self.single)));
        let (members, offsets) = (self.bodies.members(), &self.offsets);
        change_rows(&mut motions.0, |row, motion| {
            if let Some(mut rigid) = members.motion(row, &moved) {
                rigid += offsets.0[row];
                *motion = rigid;
            }
        });
    }

    /// `S^-1` times loads on the bodies.
    fn moved(&self, totals: &SixVectors) -> SixVectors {
        let of_body = |(matrix, load): (&BodyMatrix, &SixVector)| matrix.times(load);
        SixVectors(self.inverse.par_iter().zip(&totals.0).map(of_body).measured().collect())
    }
}

/// Load of a single sphere in a motion.
fn resisted(single: &SixVector, motion: SixVector) -> SixVector {
    SixVector(std::array::from_fn(|k| single.0[k] * motion.0[k]))
}

/// Inverses of symmetric positive definite matrices without the given components, of which the list may be empty.
fn inverses(mut matrices: Vec<BodyMatrix>, given: &[[Option<f64>; 6]]) -> Vec<BodyMatrix> {
    let without = |matrices: &mut Vec<BodyMatrix>, diagonal: f64| {
        if !given.is_empty() {
            let components = |given: &[Option<f64>; 6]| given.map(|component| component.is_some());
            change(matrices, given, |matrix, given| *matrix = matrix.without(components(given), diagonal));
        }
    };
    without(&mut matrices, 1.0);
    matrices.par_chunks_mut(BATCH).measured().for_each(|batch| f64::dispatch(Inversion(batch)));
    without(&mut matrices, 0.0);
    matrices
}

/// Inverts symmetric positive definite matrices, one per lane.
struct Inversion<'a>(&'a mut [BodyMatrix]);

impl VectorKernel<f64> for Inversion<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for matrices in self.0.chunks_mut(LANES) {
            let mut lanes = [[0.0; LANES]; BodyMatrix::NUMBERS];
            // The identity keeps empty lanes invertible.
            (0..6).for_each(|k| lanes[7 * k] = [1.0; LANES]);
            for (lane, matrix) in matrices.iter().enumerate() {
                for k in 0..BodyMatrix::NUMBERS {
                    lanes[k][lane] = matrix.0.as_flattened()[k];
                }
            }
            let mut work = [[SimdLanes::<V>::constant(0.0); 6]; 6];
            for k in 0..BodyMatrix::NUMBERS {
                work.as_flattened_mut()[k] = SimdLanes::read(&lanes[k]);
            }
            let found = inverse(work);
            for k in 0..BodyMatrix::NUMBERS {
                found.as_flattened()[k].write(&mut lanes[k]);
            }
            for (lane, matrix) in matrices.iter_mut().enumerate() {
                for k in 0..BodyMatrix::NUMBERS {
                    matrix.0.as_flattened_mut()[k] = lanes[k][lane];
                }
            }
        }
    }
}

impl RigidBodies {
    /// Motions of the bodies relative to a background flow at their centres, from motions of the spheres relative to
    /// that flow. Collective.
    pub(crate) fn motions_in(&self, flow: StrainRate, spheres: &Particles, motion: &Motion) -> Motion {
        let mut relative = SixVectors::new(spheres.len(), &motion.velocities, &motion.angular_velocities);
        relative.add(-1.0, &self.members().offsets(spheres, flow));
        self.body_motions(&Motion {
            velocities: relative.linear(),
            angular_velocities: relative.angular(),
            strain_rates: Vec::new(),
        })
    }
}

impl Members {
    /// Motions of the spheres relative to a background flow when their bodies move with the flow at their centres. A
    /// single sphere that moves freely has the velocity of the flow at its centre plus `a^2 / 6` times its curvature.
    pub(crate) fn offsets(&self, spheres: &Particles, flow: StrainRate) -> SixVectors {
        SixVectors(of_rows(spheres.len(), |row| {
            if self.body(row).is_none() {
                return SixVector::default();
            }
            let (arm, radius) = (self.arm(row), spheres.radii[row]);
            let strained = flow.at(spheres.positions[row].z - arm.z).tensor().mul_vec3(arm);
            let curved = flow.half_curvature() * (arm.z * arm.z + radius * radius / 3.0);
            -SixVector::new(strained + curved, flow.turning(arm.z))
        }))
    }
}
