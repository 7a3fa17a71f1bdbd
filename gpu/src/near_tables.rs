//! Tables of the lubrication of near pairs, as a device takes them.

use crate::device::DeviceError;
use crate::far_field::SplitFarField;
use bytemuck::{Pod, Zeroable};

/// Two classes of radius, that of a row's sphere first, with the fields of `gpu/kernels/pair_sides.h` in the same
/// order. Of two values, the first is of stiff pairs and the second of soft ones.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct NearKind {
    /// Sum of the radii.
    pub sum: f64,
    /// The smaller radius.
    pub small: f64,
    /// 1 if the row's sphere is the larger one, otherwise 0.
    pub is_larger: f64,
    /// Viscosity times the smaller radius.
    pub drag: f64,
    /// Gap beyond which there is no lubrication.
    pub cutoff: f64,
    /// Gap below which it is constant.
    pub minimum_gap: f64,
    /// Gap below which a pair is stiff.
    pub stiff_gap: f64,
    /// Ratio of the radii, at least 1.
    pub ratio: f64,
    /// Place of the first piece in [`NearTables::series`].
    pub first: [i64; 2],
    /// Number of that piece; pieces begin at the gaps `2^(k/2 - 24)` over the smaller radius.
    pub first_piece: [i64; 2],
    /// Number of pieces.
    pub pieces: [i64; 2],
}

/// Tables of all pairs of classes of radius.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NearTables {
    /// All ordered pairs of classes, those of the first class first; empty without lubrication and springs.
    pub kinds: Vec<NearKind>,
    /// Power series of pieces of gaps. A piece has the mean of its gaps, then the coefficients of each power of some
    /// functions. Empty without lubrication: then no gap is within its cutoff.
    pub series: Vec<f64>,
    /// Distance of centres up to which pairs are lubricated.
    pub reach: f64,
    /// Whether spheres that overlap are lubricated as at a gap equal to the overlap.
    pub separates_overlaps: bool,
    /// Resistances of single spheres to translation, rotation and strain, by class of radius.
    pub resistances: Vec<[f64; 3]>,
}

impl SplitFarField {
    /// Copies the tables of near pairs to the device, in the units of its far field.
    pub fn set_near_tables(&mut self, tables: &NearTables) -> Result<(), DeviceError> {
        let Self { device, buffers, near, task, .. } = self;
        let (on, places) = (device.as_mut(), &mut buffers.near.tables);
        if !tables.kinds.is_empty() {
            task.near_kinds = places.kinds.fill(on, bytemuck::cast_slice(&tables.kinds))?;
        }
        if !tables.series.is_empty() {
            task.near_series = places.series.fill(on, bytemuck::cast_slice(&tables.series))?;
        }
        task.resistances = places.resistances.fill(on, bytemuck::cast_slice(tables.resistances.as_flattened()))?;
        task.separates_overlaps = i32::from(tables.separates_overlaps);
        near.reach = Some(tables.reach);
        Ok(())
    }

    /// Whether the tables of near pairs are there.
    pub fn has_near_tables(&self) -> bool {
        self.near.reach.is_some()
    }
}
