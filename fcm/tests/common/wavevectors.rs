//! Force-coupling method by a plain sum over wavevectors, without grid or splitting.

use super::Suspension;
use domain::{Tensor, Traceless, Vector};
use fcm::{Loads, Motion};
use std::f64::consts::{PI, TAU};

/// The sum ends where `exp(-k^2 sigma'^2)` of the smallest dipole envelope is `exp(-34)`, 2e-15.
const EXPONENT: f64 = 34.0;

/// Load `F` and `G` of a particle, and the widths of its envelopes.
struct Source {
    position: Vector,
    force: Vector,
    dipole: Tensor,
    quadrupole: Vector,
    widths: [f64; 2],
}

impl Suspension {
    /// `(F, T, S) -> (V, Omega, E)`.
    pub fn motion(&self, loads: &Loads) -> Motion {
        let sources: Vec<Source> = (0..self.positions.len()).map(|n| self.source(loads, n)).collect();
        self.motion_by(&sources)
    }

    /// `H -> (V, Omega, E)` with degenerate quadrupoles whose transform is `-k^2 exp(-k^2 sigma'^2/2) sinh(x)/x`, where
    /// `x = k^2 sigma'^2/32`.
    pub fn quadrupole_motion(&self, quadrupoles: &[Vector]) -> Motion {
        let mut sources: Vec<Source> = (0..self.positions.len()).map(|n| self.source(&Loads::default(), n)).collect();
        for (source, &quadrupole) in sources.iter_mut().zip(quadrupoles) {
            source.quadrupole = quadrupole;
        }
        self.motion_by(&sources)
    }

    fn motion_by(&self, sources: &[Source]) -> Motion {
        let mut flow = vec![(Vector::ZERO, Tensor::ZERO); sources.len()];
        let mut factors = Vec::new();
        for k in self.wavevectors() {
            add_mode(k, sources, &mut factors, &mut flow);
        }
        // Each wavevector also stands for its opposite.
        let scale = 2.0 / (self.cell.volume() * self.viscosity);
        let gradients: Vec<Tensor> = flow.iter().map(|f| f.1 * scale).collect();
        Motion {
            velocities: flow.iter().map(|f| f.0 * scale).collect(),
            angular_velocities: gradients.iter().map(half_curl).collect(),
            strain_rates: gradients.iter().map(Traceless::part_of).collect(),
        }
    }

    fn source(&self, loads: &Loads, n: usize) -> Source {
        let a = self.radii[n];
        let t = loads.torques.get(n).copied().unwrap_or_default() * 0.5;
        let antisymmetric = Tensor::from_cols_array(&[0.0, -t.z, t.y, t.z, 0.0, -t.x, -t.y, t.x, 0.0]);
        Source {
            position: self.positions[n],
            force: loads.forces.get(n).copied().unwrap_or_default(),
            dipole: loads.stresslets.get(n).copied().unwrap_or_default().tensor() + antisymmetric,
            quadrupole: Vector::ZERO,
            widths: [a / PI.sqrt(), a / (6.0 * PI.sqrt()).cbrt()],
        }
    }

    /// One of each pair of opposite wavevectors, up to where the envelopes vanish.
    fn wavevectors(&self) -> impl Iterator<Item = Vector> {
        let smallest = self.radii.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = EXPONENT.sqrt() / (smallest / (6.0 * PI.sqrt()).cbrt());
        let (unit, strain) = (TAU / self.cell.edges(), self.cell.strain());
        let within = |unit: f64, around: f64, room: f64| {
            let (middle, room) = (around / unit, room.max(0.0).sqrt() / unit);
            ((middle - room).ceil() as i32)..=((middle + room).floor() as i32)
        };
        let square = largest * largest;
        (0..=(largest / unit.x) as i32).flat_map(move |m1| {
            let k1 = f64::from(m1) * unit.x;
            within(unit.y, strain * k1, square - k1 * k1).flat_map(move |m2| {
                let k2 = f64::from(m2) * unit.y - strain * k1;
                within(unit.z, 0.0, square - k1 * k1 - k2 * k2)
                    .filter(move |&m3| m1 > 0 || m2 > 0 || (m2 == 0 && m3 > 0))
                    .map(move |m3| Vector::new(k1, k2, f64::from(m3) * unit.z))
            })
        })
    }
}

/// Adds `Re[u exp(i k.Y)]` and its gradient with `u = (I - k k/k^2)/k^2 sum (F w + i G.k w') exp(-i k.Y)`, averaged
/// over the envelopes. `factors` is working memory for `w cos, w sin, w' cos, w' sin` of each particle.
fn add_mode(k: Vector, sources: &[Source], factors: &mut Vec<[f64; 4]>, flow: &mut [(Vector, Tensor)]) {
    let square = k.length_squared();
    factors.clear();
    let (mut real, mut imaginary) = (Vector::ZERO, Vector::ZERO);
    for source in sources {
        let (sin, cos) = k.dot(source.position).sin_cos();
        let [w, v] = source.widths.map(|s| (-0.5 * square * s * s).exp());
        let x = square * source.widths[1].powi(2) / 32.0;
        let lower = if x > 0.0 { -square * x.sinh() / x } else { 0.0 };
        let (f, g) = (source.force * w + source.quadrupole * (v * lower), source.dipole * k);
        real += f * cos + g * (v * sin);
        imaginary += g * (v * cos) - f * sin;
        factors.push([w * cos, w * sin, v * cos, v * sin]);
    }
    let project = |u: Vector| (u - k * (k.dot(u) / square)) / square;
    let (real, imaginary) = (project(real), project(imaginary));
    for (&[wc, ws, vc, vs], (velocity, gradient)) in factors.iter().zip(flow) {
        *velocity += real * wc - imaginary * ws;
        let along = -(real * vs + imaginary * vc);
        *gradient += Tensor::from_cols(along * k.x, along * k.y, along * k.z);
    }
}

/// Half the curl from a gradient whose column `j` is `d_j u`.
fn half_curl(d: &Tensor) -> Vector {
    0.5 * Vector::new(d.y_axis.z - d.z_axis.y, d.z_axis.x - d.x_axis.z, d.x_axis.y - d.y_axis.x)
}
