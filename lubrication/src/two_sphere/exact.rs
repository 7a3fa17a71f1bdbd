//! Resistance functions at one gap, from the solution in bispherical coordinates.

use std::f64::consts::PI;

use super::bispherical::{self, SphereMoments};
use super::functions::{Function, Pairwise, ResistanceFunctions, WallFunctions};
use super::geometry::Geometry;
use super::surface_velocity::{SurfaceFunction, SurfaceVelocity};

/// All functions for radii 1 and `ratio` at a positive, finite `gap`, in units of the first radius.
pub fn resistance(ratio: f64, gap: f64) -> ResistanceFunctions {
    of(&Geometry::new(ratio, gap), ratio)
}

/// Functions of a sphere of radius 1 that moves at a positive, finite `gap` from a fixed plane wall.
pub fn wall_resistance(gap: f64) -> WallFunctions {
    let both = of(&Geometry::at_wall(gap), 1.0);
    WallFunctions(both.0.map(|pairwise| pairwise[0][0]))
}

fn of(geometry: &Geometry, ratio: f64) -> ResistanceFunctions {
    let scales = Normalisation { focus: geometry.focus.value(), ratio };
    let mut functions = ResistanceFunctions([Pairwise::default(); 11]);
    axial(geometry, &scales, &mut functions.0);
    transverse(geometry, &scales, &mut functions.0);
    planar(geometry, &scales, &mut functions.0);
    functions.0[Function::XC as usize] = scales.normalise(3, PI, &bispherical::spin(geometry));
    functions
}

/// Converts `[moves][bears]` in units of the focal distance to the hatted normalisation, `[bears][moves]`.
struct Normalisation {
    focus: f64,
    ratio: f64,
}

impl Normalisation {
    fn normalise(&self, power: i32, factor: f64, values: &[[f64; 2]; 2]) -> Pairwise {
        let radii = [1.0, self.ratio];
        [0, 1].map(|i| [0, 1].map(|j| values[j][i] * (self.focus / (radii[i] + radii[j])).powi(power) / factor))
    }
}

fn axial(geometry: &Geometry, scales: &Normalisation, functions: &mut [Pairwise; 11]) {
    let translate = |sphere| SurfaceVelocity {
        sphere,
        axial: SurfaceFunction::One,
        raised: SurfaceFunction::Zero,
        lowered: SurfaceFunction::Zero,
    };
    let strain = |sphere| SurfaceVelocity {
        sphere,
        axial: SurfaceFunction::Height,
        raised: SurfaceFunction::Radius(-0.5),
        lowered: SurfaceFunction::Zero,
    };
    let loads = bispherical::solve(geometry, 0, &[translate(0), translate(1), strain(0), strain(1)]);
    functions[Function::XA as usize] = scales.normalise(1, 3.0 * PI, &pick(&loads[..2], |load| load.force.value()));
    functions[Function::XG as usize] =
        scales.normalise(2, 2.0 / 3.0 * PI, &pick(&loads[..2], |load| load.stresslet.value()));
    functions[Function::XM as usize] =
        scales.normalise(3, 5.0 / 6.0 * PI, &pick(&loads[2..], |load| load.stresslet.value()));
}

fn transverse(geometry: &Geometry, scales: &Normalisation, functions: &mut [Pairwise; 11]) {
    let drive = |sphere, axial, lowered| SurfaceVelocity { sphere, axial, raised: SurfaceFunction::Zero, lowered };
    let translate = |sphere| drive(sphere, SurfaceFunction::Zero, SurfaceFunction::One);
    let rotate = |sphere| drive(sphere, SurfaceFunction::Radius(-1.0), SurfaceFunction::Height);
    let strain = |sphere| drive(sphere, SurfaceFunction::Radius(1.0), SurfaceFunction::Height);
    let drives = [translate(0), translate(1), rotate(0), rotate(1), strain(0), strain(1)];
    let loads = bispherical::solve(geometry, 1, &drives);
    let (translations, rotations, strains) = (&loads[..2], &loads[2..4], &loads[4..]);
    functions[Function::YA as usize] = scales.normalise(1, 3.0 * PI, &pick(translations, |load| load.force.value()));
    functions[Function::YB as usize] = scales.normalise(2, PI, &pick(translations, |load| -load.torque.value()));
    functions[Function::YG as usize] = scales.normalise(2, PI, &pick(translations, |load| load.stresslet.value()));
    functions[Function::YC as usize] = scales.normalise(3, PI, &pick(rotations, |load| load.torque.value()));
    functions[Function::YH as usize] = scales.normalise(3, PI, &pick(rotations, |load| load.stresslet.value()));
    functions[Function::YM as usize] =
        scales.normalise(3, 5.0 / 6.0 * PI, &pick(strains, |load| load.stresslet.value()));
}

fn planar(geometry: &Geometry, scales: &Normalisation, functions: &mut [Pairwise; 11]) {
    let strain = |sphere| SurfaceVelocity {
        sphere,
        axial: SurfaceFunction::Zero,
        raised: SurfaceFunction::Zero,
        lowered: SurfaceFunction::Radius(1.0),
    };
    let loads = bispherical::solve(geometry, 2, &[strain(0), strain(1)]);
    functions[Function::ZM as usize] =
        scales.normalise(3, 5.0 / 6.0 * PI, &pick(&loads, |load| load.stresslet.value()));
}

fn pick(loads: &[[SphereMoments; 2]], of: impl Fn(&SphereMoments) -> f64) -> [[f64; 2]; 2] {
    [0, 1].map(|moves| [0, 1].map(|bears| of(&loads[moves][bears])))
}
