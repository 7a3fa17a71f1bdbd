//! Sum over pairs in space: the difference between the envelopes and the common Gaussian.

use super::entries::{EXPONENT, LocatedSphere, PairBlock, Shapes};
use crate::envelope::{Common, Envelope};
use crate::mobility::loads::dipole;
use crate::mobility::noise::{COMPONENTS, ParticleComponents, components, tensor};
use crate::pairs::table::{PairFunctions, PairValues};
use domain::{PeriodicBox, Tensor, Traceless, Vector};

/// Pair functions of all radii, and the distance at which they end.
pub(super) struct PairSum<'a> {
    cell: &'a PeriodicBox,
    functions: Vec<PairFunctions>,
    classes: usize,
    cutoff: f64,
    inverse_viscosity: f64,
}

impl<'a> PairSum<'a> {
    /// By [`PairFunctions::new`], or by those of other loads.
    pub fn new(
        shapes: &Shapes,
        cell: &'a PeriodicBox,
        functions: fn(Envelope, Envelope, Common) -> PairFunctions,
    ) -> Self {
        let all = &shapes.envelopes;
        let pairs = all.iter().flat_map(|&i| all.iter().map(move |&j| (i, j)));
        Self {
            cell,
            functions: pairs.map(|(i, j)| functions(i, j, shapes.common)).collect(),
            classes: all.len(),
            cutoff: 2.0 * shapes.common.width * EXPONENT.sqrt(),
            inverse_viscosity: 1.0 / shapes.viscosity,
        }
    }

    /// Motions of a sphere due to the loads of another and of its images, or due to its own.
    pub fn between(&self, target: &LocatedSphere, source: &LocatedSphere) -> PairBlock {
        let mut block = PairBlock::default();
        self.add_flows(target, source, &unit_loads(), &mut block);
        block
    }

    /// Adds the motion of a sphere due to each of some loads of another and of its images, or of its own.
    pub fn add_flows(
        &self,
        target: &LocatedSphere,
        source: &LocatedSphere,
        loads: &[UnitLoad],
        motions: &mut [ParticleComponents],
    ) {
        let functions = &self.functions[target.class as usize * self.classes + source.class as usize];
        self.for_each_image(target.position - source.position, |x| {
            let f = functions.exact(x.length_squared());
            for (sums, load) in motions.iter_mut().zip(loads) {
                let (velocity, gradient) = flow(&f, x, load);
                let motion = components(&(velocity * self.inverse_viscosity, gradient * self.inverse_viscosity));
                sums.iter_mut().zip(motion).for_each(|(sum, value)| *sum += value);
            }
        });
    }

    /// Calls a function with each image of a separation within the cutoff.
    fn for_each_image(&self, separation: Vector, mut call: impl FnMut(Vector)) {
        let edges = self.cell.edges();
        let at = self.cell.lattice_coordinates(separation) / edges;
        let room = self.cell.coordinate_stretch() * self.cutoff / edges;
        let steps = |axis: usize| (-at[axis] - room[axis]).ceil() as i32..=(room[axis] - at[axis]).floor() as i32;
        for k in steps(2) {
            for j in steps(1) {
                for i in steps(0) {
                    let x = separation + self.cell.lattice([i, j, k]);
                    if x.length_squared() <= self.cutoff * self.cutoff {
                        call(x);
                    }
                }
            }
        }
    }
}

/// Load of a sphere.
pub(super) struct UnitLoad {
    pub force: Vector,
    pub dipole: Tensor,
}

/// Force and dipole of each load of a sphere: three forces, three torques, and minus five stresslets, which are those
/// that work on [`components`].
pub(super) fn unit_loads() -> [UnitLoad; COMPONENTS] {
    std::array::from_fn(|load| {
        let unit = |first: usize| Vector::from_array(std::array::from_fn(|a| f64::from(u8::from(first + a == load))));
        let stresslet: [f64; 5] = std::array::from_fn(|d| -f64::from(u8::from(6 + d == load)));
        let stresslet = if load < 6 { Traceless::ZERO } else { tensor(stresslet) };
        UnitLoad { force: unit(0), dipole: dipole(stresslet, unit(3)) }
    })
}

/// Velocity at `x` from a sphere with a force `F` and a dipole `G`, and its gradient `D_ad = d_d u_a`, by the
/// functions of the pair; see [`crate::pairs::pair_correction`], with one more derivative:
///
/// ```text
/// d_d d_c T_ab G_bc = -G_ad (4 f_2 + r^2 f_3) - (G x)_a x_d (6 f_3 + r^2 f_4) + G_da f_2 + x_a x_d (x.G x) f_4
///                     + [(G^T x)_a x_d + x_a (G^T x)_d + x_a (G x)_d + delta_ad (x.G x)] f_3
/// ```
fn flow(f: &PairValues, x: Vector, load: &UnitLoad) -> (Vector, Tensor) {
    let &UnitLoad { force, dipole } = load;
    let square = x.length_squared();
    let (along, across) = (dipole * x, dipole.transpose() * x);
    let velocity =
        x * (f[1] * x.dot(force)) - force * (2.0 * f[0] + square * f[1]) + x * (f[3] * x.dot(along)) + across * f[2]
            - along * (4.0 * f[2] + square * f[3]);
    let projected = x.dot(force);
    let by_force = (Tensor::IDENTITY * projected + outer(x, force)) * f[4] + outer(x, x) * (projected * f[5])
        - outer(force, x) * (4.0 * f[4] + square * f[5]);
    let work = x.dot(along);
    let mixed = outer(across, x) + outer(x, across) + outer(x, along) + Tensor::IDENTITY * work;
    let by_dipole = mixed * f[7] + dipole.transpose() * f[6] + outer(x, x) * (work * f[8])
        - dipole * (4.0 * f[6] + square * f[7])
        - outer(along, x) * (6.0 * f[7] + square * f[8]);
    (velocity, by_force + by_dipole)
}

/// `a_i b_j`
fn outer(a: Vector, b: Vector) -> Tensor {
    Tensor::from_cols(a * b.x, a * b.y, a * b.z)
}
