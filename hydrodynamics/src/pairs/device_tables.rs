//! Tables of the lubrication between spheres, as a device takes them.

use crate::pairs::lubrication::PairLubrication;
use fcm::{NearKind, NearTables};
use lubrication::GapSeries;

/// Tables of pairs that are not lubricated, for springs, between spheres of some radii.
pub fn without_lubrication(radii: &[f64], resistances: Vec<[f64; 3]>) -> NearTables {
    let pairs = radii.iter().flat_map(|&own| radii.iter().map(move |&other| [own, other]));
    let kind = |[own, other]: [f64; 2]| NearKind {
        sum: own + other,
        small: own.min(other),
        is_larger: f64::from(u8::from(own > other)),
        ratio: own.max(other) / own.min(other),
        // Below all gaps, of overlapping spheres too.
        cutoff: -2.0 * (own + other),
        stiff_gap: -2.0 * (own + other),
        ..bytemuck::Zeroable::zeroed()
    };
    NearTables { kinds: pairs.map(kind).collect(), resistances, ..NearTables::default() }
}

impl PairLubrication {
    /// Tables for species whose resistances to translation, rotation and strain are given.
    pub fn tables(&self, viscosity: f64, resistances: Vec<[f64; 3]>) -> NearTables {
        let (force, species) = (&self.force, self.force.radii().len());
        let mut tables = NearTables {
            reach: force.reach(),
            separates_overlaps: force.range().separates_overlaps(),
            resistances,
            ..NearTables::default()
        };
        for pair in (0..species * species).map(|k| [k / species, k % species]) {
            let kind = self.kind(viscosity, pair.map(|s| s as u32), &mut tables);
            tables.kinds.push(kind);
        }
        tables
    }

    /// Kind of a pair of species, whose series are appended to the tables: those of stiff pairs once for both orders.
    fn kind(&self, viscosity: f64, pair: [u32; 2], tables: &mut NearTables) -> NearKind {
        let (force, [own, other]) = (&self.force, pair.map(|s| self.force.radii()[s as usize]));
        let (small, large, stiff_gap) = (own.min(other), own.max(other), self.stiff_gap(pair));
        let [i, j] = pair.map(|s| s as usize);
        let known = (i > j).then(|| tables.kinds[j * force.radii().len() + i]);
        let mut kind = NearKind {
            sum: own + other,
            small,
            is_larger: f64::from(u8::from(own > other)),
            drag: viscosity * small,
            cutoff: force.range().cutoff() * large,
            minimum_gap: force.minimum_gap(pair),
            stiff_gap,
            ratio: large / small,
            ..known.unwrap_or(bytemuck::Zeroable::zeroed())
        };
        if known.is_none() {
            append(tables, &mut kind, 0, &force.series(pair));
        }
        append(tables, &mut kind, 1, &self.soft.series(pair));
        kind
    }
}

/// Appends the series of the stiff pairs (0) or of the soft pairs (1) of a kind.
fn append(tables: &mut NearTables, kind: &mut NearKind, set: usize, series: &GapSeries) {
    kind.first[set] = tables.series.len() as i64;
    kind.first_piece[set] = series.first_piece as i64;
    kind.pieces[set] = series.pieces as i64;
    tables.series.extend_from_slice(&series.numbers);
}
