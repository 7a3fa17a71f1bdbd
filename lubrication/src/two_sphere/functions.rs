//! Names and storage of the scalar functions.

use std::ops::Index;

/// One of the eleven scalar functions: a load against a motion, and an azimuthal order (X: 0, Y: 1, Z: 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Function {
    /// Force along the line of centres against velocity.
    XA,
    /// Force normal to the line of centres against velocity.
    YA,
    /// Torque against velocity.
    YB,
    /// Torque along the line of centres against angular velocity.
    XC,
    /// Torque normal to the line of centres against angular velocity.
    YC,
    /// Axisymmetric stresslet against velocity.
    XG,
    /// Transverse stresslet against velocity.
    YG,
    /// Transverse stresslet against angular velocity.
    YH,
    /// Axisymmetric stresslet against rate of strain.
    XM,
    /// Transverse stresslet against rate of strain.
    YM,
    /// Stresslet in the plane normal to the line of centres, against rate of strain.
    ZM,
}

impl Function {
    /// All functions, in the order of the tables.
    pub const ALL: [Self; 11] =
        [Self::XA, Self::YA, Self::YB, Self::XC, Self::YC, Self::XG, Self::YG, Self::YH, Self::XM, Self::YM, Self::ZM];

    /// Whether the signs of 12 and 22 flip when the spheres are exchanged.
    pub(crate) fn is_odd(self) -> bool {
        matches!(self, Self::YB | Self::XG | Self::YG)
    }
}

/// Values of a function by the sphere with the load and the sphere that moves: `[bears][moves]`.
pub type Pairwise = [[f64; 2]; 2];

/// Resistance functions at one gap, in the hatted normalisation of Jeffrey & Onishi (1984), section 1, and Jeffrey
/// (1992), section 2.
///
/// With `s = a_i + a_j`, resistance over viscosity is `3 pi s` times a function A, `pi s²` times B or G, `pi s³`
/// times C or H, `5/6 pi s³` times M. The unit vector `d` points from sphere 1 to sphere 2, and loads are those of
/// the spheres on the fluid. An isolated sphere has A11 = C11 = M11 = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResistanceFunctions(pub(crate) [Pairwise; 11]);

/// Mobility functions at one gap, `(U, Omega, S)` from `(F, T, E)`, in the hatted normalisation.
///
/// With `s = a_i + a_j`, mobility times viscosity is a function `a` over `3 pi s`, `b` over `pi s²`, `c` over
/// `pi s³`; the stresslet in a force- and torque-free pair is `g` times `s/2` times the force, `h` times the torque,
/// and `m` times `5/6 pi s³` times viscosity and strain rate. An isolated sphere has a11 = c11 = m11 = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MobilityFunctions(pub(crate) [Pairwise; 11]);

/// Resistance functions of a sphere at one gap from a fixed plane wall, in the same normalisation with `s = 2 a`:
/// loads by the sphere's own motion, with `d` from its centre to the wall. An isolated sphere has A = C = M = 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFunctions(pub(crate) [f64; 11]);

impl Index<Function> for WallFunctions {
    type Output = f64;
    fn index(&self, function: Function) -> &f64 {
        &self.0[function as usize]
    }
}

impl Index<Function> for ResistanceFunctions {
    type Output = Pairwise;
    fn index(&self, function: Function) -> &Pairwise {
        &self.0[function as usize]
    }
}

impl Index<Function> for MobilityFunctions {
    type Output = Pairwise;
    fn index(&self, function: Function) -> &Pairwise {
        &self.0[function as usize]
    }
}

/// All functions with their names in output files: `XA11`, `XA12`, `XA21`, `XA22`, `YA11`, and so on.
pub fn named(functions: &ResistanceFunctions) -> Vec<(&'static str, f64)> {
    NAMES.into_iter().zip(functions.0.as_flattened().as_flattened().iter().copied()).collect()
}

/// All functions of a sphere at a wall with their names in output files: `XA`, `YA`, and so on.
pub fn named_at_wall(functions: &WallFunctions) -> Vec<(String, f64)> {
    Function::ALL.into_iter().map(|function| (format!("{function:?}"), functions[function])).collect()
}

/// All mobility functions with their names, `xa11` to `zm22`.
pub fn named_mobility(functions: &MobilityFunctions) -> Vec<(&'static str, f64)> {
    MOBILITY_NAMES.into_iter().zip(functions.0.as_flattened().as_flattened().iter().copied()).collect()
}

#[rustfmt::skip]
const NAMES: [&str; 44] = [
    "XA11", "XA12", "XA21", "XA22", "YA11", "YA12", "YA21", "YA22", "YB11", "YB12", "YB21", "YB22",
    "XC11", "XC12", "XC21", "XC22", "YC11", "YC12", "YC21", "YC22", "XG11", "XG12", "XG21", "XG22",
    "YG11", "YG12", "YG21", "YG22", "YH11", "YH12", "YH21", "YH22", "XM11", "XM12", "XM21", "XM22",
    "YM11", "YM12", "YM21", "YM22", "ZM11", "ZM12", "ZM21", "ZM22",
];

#[rustfmt::skip]
const MOBILITY_NAMES: [&str; 44] = [
    "xa11", "xa12", "xa21", "xa22", "ya11", "ya12", "ya21", "ya22", "yb11", "yb12", "yb21", "yb22",
    "xc11", "xc12", "xc21", "xc22", "yc11", "yc12", "yc21", "yc22", "xg11", "xg12", "xg21", "xg22",
    "yg11", "yg12", "yg21", "yg22", "yh11", "yh12", "yh21", "yh22", "xm11", "xm12", "xm21", "xm22",
    "ym11", "ym12", "ym21", "ym22", "zm11", "zm12", "zm21", "zm22",
];
