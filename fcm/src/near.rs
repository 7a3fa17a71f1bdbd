//! The near field: what the common wide Gaussians leave out, pair by pair.
//!
//! Between envelopes whose radial function is `B`, with `x` from the source to the target and
//! `f_n = (1/r d/dr)^n B`, the flow of a force `F` and a dipole `G` is (`mu = 1`)
//!
//! ```text
//! u_a       = T_ab F_b + d_c T_ab G_bc,     T_ab = -delta_ab lap B + d_a d_b B
//! T_ab      = -delta_ab (2 f_1 + r^2 f_2) + x_a x_b f_2
//! d_c T_ab  = -delta_ab x_c (4 f_2 + r^2 f_3) + (delta_ac x_b + delta_bc x_a) f_2 + x_a x_b x_c f_3
//! ```
//!
//! and its gradient follows by one derivative more.

use crate::envelope::Envelope;
use crate::table::{PairFunctions, Table, Values};
use domain::{Neighbours, PeriodicBox, Tensor, Vector};
use rayon::prelude::*;
use solver::simd::vectorised;

/// Above this many radii, tables for all pairs of them cost more than they save.
const MOST_TABULATED: usize = 8;

/// Pairs that are worked on at once.
const W: usize = 8;

/// The near field of particles of given radii.
pub(crate) struct NearField {
    cutoff: f64,
    inverse_viscosity: f64,
    functions: Functions,
}

enum Functions {
    Tabulated { classes: usize, tables: Vec<Table>, alone: Vec<Values> },
    Exact { envelopes: Vec<Envelope>, wide: f64 },
}

impl Functions {
    #[inline(always)]
    fn of_pair(&self, i: u32, j: u32, square: f64) -> Values {
        match self {
            Self::Tabulated { classes, tables, .. } => tables[i as usize * classes + j as usize].evaluate(square),
            Self::Exact { envelopes, wide } => exact(envelopes, *wide, i, j, square),
        }
    }

    fn of_one(&self, i: u32) -> Values {
        match self {
            Self::Tabulated { alone, .. } => alone[i as usize],
            Self::Exact { envelopes, wide } => exact(envelopes, *wide, i, i, 0.0),
        }
    }
}

#[inline(never)]
fn exact(envelopes: &[Envelope], wide: f64, i: u32, j: u32, square: f64) -> Values {
    PairFunctions::new(envelopes[i as usize], envelopes[j as usize], wide).exact(square)
}

/// The particles present: positions, classes of radius, and loads; an empty list of dipoles stands for none.
pub(crate) struct Present<'a> {
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub classes: &'a [u32],
    pub forces: &'a [Vector],
    pub dipoles: &'a [Tensor],
}

impl NearField {
    /// For particles with these radii, all spread with the common width, in a fluid of the given viscosity. Pairs
    /// farther apart than the cutoff are left out; tables are exact to `tolerance`.
    pub fn new(radii: &[f64], wide: f64, cutoff: f64, viscosity: f64, tolerance: f64) -> Self {
        let envelopes: Vec<Envelope> = radii.iter().map(|&a| Envelope::of_sphere(a)).collect();
        let functions = if radii.len() > MOST_TABULATED {
            Functions::Exact { envelopes, wide }
        } else {
            let pair = |&i: &Envelope, &j: &Envelope| PairFunctions::new(i, j, wide);
            let tables = envelopes.iter().flat_map(|i| envelopes.iter().map(move |j| pair(i, j)));
            let tables = tables.map(|functions| Table::new(&functions, cutoff, tolerance)).collect();
            let alone = envelopes.iter().map(|e| pair(e, e).exact(0.0)).collect();
            Functions::Tabulated { classes: radii.len(), tables, alone }
        };
        Self { cutoff, inverse_viscosity: 1.0 / viscosity, functions }
    }

    /// How far it reaches.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// Adds the near field of all particles present, their own included, to the velocities and velocity gradients of
    /// the particles that have neighbour lists.
    pub fn add(&self, present: &Present, neighbours: &Neighbours, motions: &mut [(Vector, Tensor)]) {
        motions.par_chunks_mut(64).enumerate().for_each(|(batch, motions)| {
            vectorised(
                #[inline(always)]
                || {
                    for (offset, motion) in motions.iter_mut().enumerate() {
                        let row = batch * 64 + offset;
                        let (velocity, gradient) = if present.dipoles.is_empty() {
                            self.of_neighbours::<true>(present, neighbours, row)
                        } else {
                            self.of_neighbours::<false>(present, neighbours, row)
                        };
                        let (own_velocity, own_gradient) = self.of_itself(present, row);
                        motion.0 += (velocity + own_velocity) * self.inverse_viscosity;
                        motion.1 += (gradient + own_gradient) * self.inverse_viscosity;
                    }
                },
            );
        });
    }

    fn of_itself(&self, present: &Present, row: usize) -> (Vector, Tensor) {
        let f = self.functions.of_one(present.classes[row]);
        let velocity = present.forces.get(row).map_or(Vector::ZERO, |&force| force * (-2.0 * f[0]));
        let gradient = present.dipoles.get(row).map_or(Tensor::ZERO, |g| g.transpose() * f[6] - *g * (4.0 * f[6]));
        (velocity, gradient)
    }

    #[inline(always)]
    fn of_neighbours<const MONOPOLES: bool>(
        &self,
        present: &Present,
        neighbours: &Neighbours,
        row: usize,
    ) -> (Vector, Tensor) {
        let (centre, class) = (present.positions[row], present.classes[row]);
        let mut sums = Sums::default();
        for group in neighbours.of(row).chunks(W) {
            let mut lanes = Group::default();
            for (l, neighbour) in group.iter().enumerate() {
                let j = neighbour.row as usize;
                let mut x = centre - present.positions[j];
                if neighbour.steps != [0; 3] {
                    x -= present.cell.lattice(neighbour.steps.map(i32::from));
                }
                let square = x.length_squared();
                if square >= self.cutoff * self.cutoff {
                    continue;
                }
                lanes.set_place(l, x, &self.functions.of_pair(class, present.classes[j], square));
                if let Some(&force) = present.forces.get(j) {
                    lanes.set_force(l, force);
                }
                if !MONOPOLES {
                    lanes.set_dipole(l, &present.dipoles[j]);
                }
            }
            sums.add::<MONOPOLES>(&lanes);
        }
        sums.total()
    }
}

/// Up to `W` neighbours, one a lane; lanes of zeros add nothing.
#[derive(Default)]
struct Group {
    x: [[f64; W]; 3],
    values: [[f64; W]; 9],
    force: [[f64; W]; 3],
    dipole: [[[f64; W]; 3]; 3],
}

impl Group {
    #[inline(always)]
    fn set_place(&mut self, lane: usize, x: Vector, values: &Values) {
        for a in 0..3 {
            self.x[a][lane] = x[a];
        }
        for f in 0..9 {
            self.values[f][lane] = values[f];
        }
    }

    #[inline(always)]
    fn set_force(&mut self, lane: usize, force: Vector) {
        for a in 0..3 {
            self.force[a][lane] = force[a];
        }
    }

    #[inline(always)]
    fn set_dipole(&mut self, lane: usize, dipole: &Tensor) {
        for b in 0..3 {
            for c in 0..3 {
                self.dipole[b][c][lane] = dipole.col(c)[b];
            }
        }
    }
}

/// Velocity and `gradient[a][d] = d_d u_a` by lane.
#[derive(Default)]
struct Sums {
    velocity: [[f64; W]; 3],
    gradient: [[[f64; W]; 3]; 3],
}

impl Sums {
    #[inline(always)]
    fn add<const MONOPOLES: bool>(&mut self, group: &Group) {
        for l in 0..W {
            let x = [group.x[0][l], group.x[1][l], group.x[2][l]];
            let force = [group.force[0][l], group.force[1][l], group.force[2][l]];
            let mut f = [0.0; 9];
            for n in 0..9 {
                f[n] = group.values[n][l];
            }
            let square = dot(x, x);
            let along = dot(x, force);
            let level = -square.mul_add(f[1], 2.0 * f[0]);
            for a in 0..3 {
                self.velocity[a][l] += force[a].mul_add(level, x[a] * (along * f[1]));
            }
            if MONOPOLES {
                continue;
            }
            let (mut g, mut gx, mut xg) = ([[0.0; 3]; 3], [0.0; 3], [0.0; 3]);
            for a in 0..3 {
                for b in 0..3 {
                    g[a][b] = group.dipole[a][b][l];
                }
            }
            for a in 0..3 {
                gx[a] = dot(g[a], x);
                xg[a] = dot([g[0][a], g[1][a], g[2][a]], x);
            }
            let xgx = dot(x, gx);
            // From the dipole to the velocity.
            let level = -square.mul_add(f[3], 4.0 * f[2]);
            for a in 0..3 {
                self.velocity[a][l] += gx[a].mul_add(level, xg[a].mul_add(f[2], x[a] * (xgx * f[3])));
            }
            // From the force to the gradient, and from the dipole to the gradient.
            let level = -square.mul_add(f[5], 4.0 * f[4]);
            let twist = -square.mul_add(f[7], 4.0 * f[6]);
            let bend = -square.mul_add(f[8], 6.0 * f[7]);
            let trace = along.mul_add(f[4], xgx * f[7]);
            for a in 0..3 {
                let left =
                    x[a].mul_add(along.mul_add(f[5], xgx * f[8]), force[a] * level) + gx[a].mul_add(bend, xg[a] * f[7]);
                for d in 0..3 {
                    let right = force[d].mul_add(f[4], (gx[d] + xg[d]) * f[7]);
                    let mut sum = left.mul_add(x[d], x[a] * right);
                    sum += g[a][d].mul_add(twist, g[d][a] * f[6]);
                    self.gradient[a][d][l] += if a == d { sum + trace } else { sum };
                }
            }
        }
    }

    #[inline(always)]
    fn total(&self) -> (Vector, Tensor) {
        let sum = |lanes: &[f64; W]| lanes.iter().sum::<f64>();
        let velocity = Vector::from_array(std::array::from_fn(|a| sum(&self.velocity[a])));
        let column = |d: usize| Vector::from_array(std::array::from_fn(|a| sum(&self.gradient[a][d])));
        (velocity, Tensor::from_cols(column(0), column(1), column(2)))
    }
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}
