//! The charts of a run, chosen by its results.

mod continuum;
mod disks;
mod family;
mod over_time;
mod shear_cell;
mod statistics;
mod suspension;
mod sweep;

use crate::about::About;
use crate::chart::Chart;
use files::{Observables, StoredTable};

/// The charts of a run.
pub(super) fn charts(about: &About, series: &Observables, tables: &[StoredTable]) -> Vec<Chart> {
    let table = |name: &str| tables.iter().find(|table| table.name == name);
    let mut charts = suspension::charts(about, series);
    charts.extend(disks::charts(series, table("profile")));
    charts.extend(shear_cell::charts(series, table("profile")));
    charts.extend(continuum::charts(table("profile")));
    charts.extend(sweep::charts(table("averages"), table("branches")));
    charts.extend(family::charts(about.family(), table("family")));
    charts.extend(statistics::charts(&table));
    charts
}
