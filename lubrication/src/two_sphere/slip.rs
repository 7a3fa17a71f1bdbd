//! Loads of two spheres at rest by the slip of squirmers: the exact solution in bispherical coordinates, and tables.

use std::sync::Arc;

use super::TwoSphereError;
use super::bispherical::{self, SphereMoments};
use super::gap_table::{GapTable, Tabulated};
use super::geometry::Geometry;
use super::normal_polynomial::NormalPolynomial;
use super::surface_velocity::{SurfaceFunction, SurfaceVelocity};
use super::table::LARGEST_RATIO;

/// Loads of two spheres at rest on the fluid, over viscosity, by a slip velocity at the surface of one,
///
/// ```text
/// u = (n n - I).b + (n.Q.n) n - Q.n
/// ```
///
/// with `n` the outward normal, `z` the unit vector from sphere 1 to sphere 2, and a unit mode of one azimuthal order:
/// `b = z` or `Q = zz - I/3` (names with X), `b = x` or `Q = xz + zx` (Y), `Q = xx - yy` (Z).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SlipFunction {
    /// Force along `z` by `b`.
    XF1,
    /// First moment `zz` by `b`.
    XS1,
    /// Force along `z` by `Q`.
    XF2,
    /// First moment `zz` by `Q`.
    XS2,
    /// Force along `x` by `b`.
    YF1,
    /// Torque about `y` by `b`.
    YT1,
    /// First moment `xz` by `b`.
    YS1,
    /// Force along `x` by `Q`.
    YF2,
    /// Torque about `y` by `Q`.
    YT2,
    /// First moment `xz` by `Q`.
    YS2,
    /// First moment `xx` by `Q`.
    ZS2,
}

impl SlipFunction {
    /// All functions, in the order of the tables.
    pub const ALL: [Self; SLIP_FUNCTIONS] = [
        Self::XF1,
        Self::XS1,
        Self::XF2,
        Self::XS2,
        Self::YF1,
        Self::YT1,
        Self::YS1,
        Self::YF2,
        Self::YT2,
        Self::YS2,
        Self::ZS2,
    ];

    /// Value of the load of sphere `bears` by the slip of sphere `slips`, 0 or 1.
    pub fn of(self, values: &SlipValues, bears: usize, slips: usize) -> f64 {
        values[4 * self as usize + 2 * bears + slips]
    }
}

/// All values with their names in output: `XF1_11`, `XF1_12` and so on, with the sphere that has the load first.
pub fn named_slip(values: &SlipValues) -> Vec<(String, f64)> {
    let places = [(0, 0), (0, 1), (1, 0), (1, 1)];
    let all = SlipFunction::ALL.into_iter().flat_map(|function| places.map(|(i, j)| (function, i, j)));
    all.map(|(function, i, j)| (format!("{function:?}_{}{}", i + 1, j + 1), function.of(values, i, j))).collect()
}

/// All values of a sphere at a wall with their names in output: `XF1`, `XS1` and so on.
pub fn named_slip_at_wall(values: &[f64; SLIP_FUNCTIONS]) -> Vec<(String, f64)> {
    SlipFunction::ALL.into_iter().zip(values).map(|(function, &value)| (format!("{function:?}"), value)).collect()
}

/// Number of functions.
pub const SLIP_FUNCTIONS: usize = 11;

/// Number of values: of each function `[bears][slips]`.
pub const SLIP_VALUES: usize = 4 * SLIP_FUNCTIONS;

/// Values of all functions for radii 1 and `ratio`: of function `f` for the load of sphere `i` by the slip of sphere
/// `j` (0 or 1) at `4 f + 2 i + j`. An isolated sphere of radius `a` has the force `-4 pi a b` and the first moment
/// `-4 pi a^2 Q`.
pub type SlipValues = [f64; SLIP_VALUES];

/// Lowest power of `t = (a1 + a2)/r` in a function: for the sphere that slips, and for the other.
const LEADING: [[usize; 2]; SLIP_FUNCTIONS] =
    [[0, 1], [3, 2], [3, 2], [0, 3], [0, 1], [3, 2], [3, 2], [3, 2], [4, 3], [0, 3], [0, 3]];

/// Terms of the near-contact expansion: those of regular functions, and the logarithms with unknown coefficients.
const TERMS: usize = 10;

/// Tables of the loads by slip for one ratio of radii, at any gap.
#[derive(Debug, Clone)]
pub struct TwoSphereSlip {
    ratio: f64,
    table: GapTable<SLIP_VALUES, TERMS>,
}

impl TwoSphereSlip {
    /// Tables for radii 1 and `ratio`. Must not be called from a rayon task.
    ///
    /// # Errors
    /// If the ratio is outside of the range of the two-sphere functions.
    pub fn with_ratio(ratio: f64) -> Result<Arc<Self>, TwoSphereError> {
        if !(1.0 / LARGEST_RATIO..=LARGEST_RATIO).contains(&ratio) {
            return Err(TwoSphereError::Ratio(ratio));
        }
        let leading = std::array::from_fn(|i| LEADING[i / 4][usize::from(i % 4 == 1 || i % 4 == 2)]);
        let size = 1.0 + ratio;
        let tabulated = Tabulated { size, least: ratio.min(1.0), unit: 0.5 * size, is_even: true, leading };
        let table = GapTable::compute(tabulated, [[0.0; 3]; SLIP_VALUES], |gap| loads(ratio, gap));
        Ok(Arc::new(Self { ratio, table }))
    }

    /// Radius of sphere 2 over that of sphere 1.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// All values at a positive `gap`, in units of the first radius.
    pub fn at(&self, gap: f64) -> SlipValues {
        self.table.at(gap)
    }
}

/// All values at a positive, finite `gap`, in units of the first radius.
pub fn loads(ratio: f64, gap: f64) -> SlipValues {
    solve(&Geometry::new(ratio, gap))
}

/// Loads of a sphere of radius 1 at a positive, finite `gap` from a plane wall by its own slip, in the order of
/// [`SlipFunction::ALL`], with `z` the unit vector from its centre to the wall.
pub fn wall_loads(gap: f64) -> [f64; SLIP_FUNCTIONS] {
    values_of(&solve(&Geometry::at_wall(gap)), 0, 0)
}

/// Values of all functions for the load of sphere `bears` by the slip of sphere `slips`, 0 or 1.
pub fn values_of(values: &SlipValues, bears: usize, slips: usize) -> [f64; SLIP_FUNCTIONS] {
    SlipFunction::ALL.map(|function| function.of(values, bears, slips))
}

fn solve(geometry: &Geometry) -> SlipValues {
    let drives = |order: usize, modes: &[SlipMode]| {
        let drive = |mode: &SlipMode, sphere| mode.on(sphere);
        let all: Vec<SurfaceVelocity> = modes.iter().flat_map(|mode| [drive(mode, 0), drive(mode, 1)]).collect();
        bispherical::solve(geometry, order, &all)
    };
    let [axial, transverse, planar] = [drives(0, &AXIAL), drives(1, &TRANSVERSE), drives(2, &PLANAR)];
    let focus = geometry.focus.value();
    let force = |load: &SphereMoments| load.force.value() * focus;
    let torque = |load: &SphereMoments| load.torque.value() * focus * focus;
    let moment = |load: &SphereMoments| load.stresslet.value() * focus * focus;
    let mut values = [0.0; SLIP_VALUES];
    let mut put = |function: SlipFunction, found: &[[SphereMoments; 2]], of: &dyn Fn(&SphereMoments) -> f64| {
        for (bears, slips) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            values[4 * function as usize + 2 * bears + slips] = of(&found[slips][bears]);
        }
    };
    put(SlipFunction::XF1, &axial[..2], &force);
    put(SlipFunction::XS1, &axial[..2], &moment);
    put(SlipFunction::XF2, &axial[2..], &force);
    put(SlipFunction::XS2, &axial[2..], &moment);
    put(SlipFunction::YF1, &transverse[..2], &force);
    put(SlipFunction::YT1, &transverse[..2], &torque);
    put(SlipFunction::YS1, &transverse[..2], &moment);
    put(SlipFunction::YF2, &transverse[2..], &force);
    put(SlipFunction::YT2, &transverse[2..], &torque);
    put(SlipFunction::YS2, &transverse[2..], &moment);
    put(SlipFunction::ZS2, &planar, &moment);
    values
}

/// Slip of a unit mode: `v_z`, `(v_rho + v_phi)/2`, `(v_rho - v_phi)/2` as polynomials of the normal; for order 0 the
/// second is `v_rho`.
struct SlipMode {
    axial: NormalPolynomial,
    raised: NormalPolynomial,
    lowered: Option<NormalPolynomial>,
}

impl SlipMode {
    fn on(&self, sphere: usize) -> SurfaceVelocity {
        SurfaceVelocity {
            sphere,
            axial: SurfaceFunction::Normal(self.axial),
            raised: SurfaceFunction::Normal(self.raised),
            lowered: self.lowered.map_or(SurfaceFunction::Zero, SurfaceFunction::Normal),
        }
    }
}

const fn normal(order: usize, powers: [f64; 4]) -> NormalPolynomial {
    NormalPolynomial { order, powers }
}

/// `b = z`, `Q = zz`
const AXIAL: [SlipMode; 2] = [
    SlipMode { axial: normal(0, [-1.0, 0.0, 1.0, 0.0]), raised: normal(1, [0.0, 1.0, 0.0, 0.0]), lowered: None },
    SlipMode { axial: normal(0, [0.0, -1.0, 0.0, 1.0]), raised: normal(1, [0.0, 0.0, 1.0, 0.0]), lowered: None },
];

/// `b = x`, `Q = xz + zx`
const TRANSVERSE: [SlipMode; 2] = [
    SlipMode {
        axial: normal(1, [0.0, 1.0, 0.0, 0.0]),
        raised: normal(2, [0.5, 0.0, 0.0, 0.0]),
        lowered: Some(normal(0, [-0.5, 0.0, -0.5, 0.0])),
    },
    SlipMode {
        axial: normal(1, [-1.0, 0.0, 2.0, 0.0]),
        raised: normal(2, [0.0, 1.0, 0.0, 0.0]),
        lowered: Some(normal(0, [0.0, 0.0, 0.0, -1.0])),
    },
];

/// `Q = xx - yy`
const PLANAR: [SlipMode; 1] = [SlipMode {
    axial: normal(2, [0.0, 1.0, 0.0, 0.0]),
    raised: normal(3, [0.5, 0.0, 0.0, 0.0]),
    lowered: Some(normal(1, [-0.5, 0.0, -0.5, 0.0])),
}];

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Alone, a sphere has the force `6 pi a <u> = -4 pi a b` and the first moment `-4 pi a^2 Q`; those of `Q = zz` and
    /// of its traceless part are the same. Corrections are of the order of `(a/r)^2`.
    #[test]
    fn far_apart_each_sphere_is_alone() {
        let (ratio, gap) = (1.6, 1e5);
        let found = loads(ratio, gap);
        for (sphere, a) in [(0, 1.0), (1, ratio)] {
            let own = |function: SlipFunction| function.of(&found, sphere, sphere);
            for (function, exact) in [
                (SlipFunction::XF1, -4.0 * PI * a),
                (SlipFunction::YF1, -4.0 * PI * a),
                (SlipFunction::XS2, -8.0 / 3.0 * PI * a * a),
                (SlipFunction::YS2, -4.0 * PI * a * a),
                (SlipFunction::ZS2, -4.0 * PI * a * a),
            ] {
                assert!((own(function) / exact - 1.0).abs() < 1e-8, "{function:?}: {}, not {exact}", own(function));
            }
        }
    }

    /// At a distance `r` a held squirmer has the flow of its force and of its quadrupole, `4/3 pi a^3 b`; the force on
    /// another sphere of radius `c` is `-6 pi c (1 + c^2/6 lap) u`, up to reflections, smaller by `(a/r)^2`.
    #[test]
    fn the_load_of_the_other_sphere_is_that_in_the_flow_of_the_first() {
        let (ratio, gap) = (1.4, 400.0);
        let (found, r) = (loads(ratio, gap), 1.0 + ratio + gap);
        let flow = -4.0 * PI / (4.0 * PI * r);
        let exact = -6.0 * PI * ratio * flow;
        assert!((SlipFunction::XF1.of(&found, 1, 0) / exact - 1.0).abs() < 1e-4);
        assert!((SlipFunction::YF1.of(&found, 1, 0) / (0.5 * exact) - 1.0).abs() < 1e-4);
        // The flow of the stresslet `4 pi Q` with `Q = zz - I/3` is `-1/r^2` along `z`.
        let exact = 6.0 * PI * ratio / (r * r);
        assert!((SlipFunction::XF2.of(&found, 1, 0) / exact - 1.0).abs() < 1e-4);
        assert!((SlipFunction::XF2.of(&found, 0, 1) / (-exact * ratio) - 1.0).abs() < 1e-4);
    }

    /// Tables against the solution, with the error relative to the load of the sphere alone.
    #[test]
    #[ignore = "heavy"]
    fn tables_agree_with_the_solution() {
        for ratio in [1.0, 2.0, 10.0] {
            let tables = TwoSphereSlip::with_ratio(ratio).unwrap();
            let mut worst = 0.0_f64;
            for gap in (0..24).map(|k| 5e-5 * 2.2_f64.powi(k)) {
                let (found, exact) = (tables.at(gap), loads(ratio, gap));
                for (k, (found, exact)) in found.iter().zip(exact).enumerate() {
                    let error = (found - exact).abs() / (4.0 * PI);
                    assert!(error < 1e-6, "ratio {ratio}, gap {gap}, value {k}: {found}, not {exact}");
                    worst = worst.max(error);
                }
            }
            println!("ratio {ratio}: {worst:e}");
        }
    }
}
