//! The table of a family: a row for each point and quantity, with the mean over the seeds.

use super::answers::{self, MemberAnswer};
use super::disks;
use super::folder::FamilyFolder;
use super::spread::SeedMean;
use files::{FileError, Manifest, Provenance, write_tables};
use scene::{Family, Member};
use simulation::Table;
use toml::Value;

/// Files of the table.
pub(super) const FILES: [&str; 2] = ["family.csv", "family.h5"];

/// Writes the table of the answers so far.
pub(super) fn write(folder: &FamilyFolder, family: &Family, manifest: &Manifest) -> Result<(), FileError> {
    let mut tables = vec![table(folder, family)?];
    tables.extend(disks::tables(folder, family)?);
    let provenance = Provenance {
        scene: family.text().to_owned(),
        program: concat!("fcm-solve ", env!("CARGO_PKG_VERSION")).to_owned(),
        plan: format!("family     {} runs at {} points\n", family.members().len(), family.points().count()),
        ranks: 1,
        seed: family.members()[0].seed.unwrap_or_default(),
    };
    write_tables(folder.path(), "family", &provenance, &tables, manifest)
}

/// Columns of words, and columns of numbers after those of the swept keys.
const WORDS: [&str; 6] = ["point", "values", "quantity", "species", "verdicts", "unit"];
const NUMBERS: [&str; 6] = ["mean", "error", "seeds", "spread", "claimed_error", "calibration"];

/// The means over the seeds at each point.
pub(super) fn table(folder: &FamilyFolder, family: &Family) -> Result<Table, FileError> {
    let keys = numeric_keys(family);
    let names = keys.iter().map(|(_, key)| *key).chain(NUMBERS);
    let mut table = Table::new("family", &WORDS, &names.map(|name| (name, "")).collect::<Vec<_>>());
    for members in family.points() {
        let scene = family.scene(&members[0]).map_err(|e| FileError::read(folder.path(), &e))?;
        let mut answers = Vec::new();
        for member in members {
            answers.extend(answers::of(&folder.member(member), &scene)?);
        }
        add_point(&mut table, &members[0], &keys, &answers);
    }
    Ok(table)
}

/// Swept keys whose values are all numbers, with their indices.
fn numeric_keys(family: &Family) -> Vec<(usize, &str)> {
    let is_numeric = |place: usize| family.members().iter().all(|member| number(&member.values()[place]).is_some());
    family.keys().iter().map(String::as_str).enumerate().filter(|(place, _)| is_numeric(*place)).collect()
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|n| n as f64))
}

/// Adds a row for each quantity for which the runs of a point have answers.
fn add_point(table: &mut Table, member: &Member, keys: &[(usize, &str)], answers: &[MemberAnswer]) {
    let of: Vec<f64> = keys.iter().filter_map(|(place, _)| number(&member.values()[*place])).collect();
    let name = |answer: &MemberAnswer| (answer.quantity.clone(), answer.species.clone());
    let mut names: Vec<_> = answers.iter().map(name).collect();
    let mut seen = std::collections::HashSet::new();
    names.retain(|name| seen.insert(name.clone()));
    for (quantity, species) in names {
        let same: Vec<&MemberAnswer> =
            answers.iter().filter(|a| a.quantity == quantity && a.species == species).collect();
        let values: Vec<(f64, f64)> =
            same.iter().map(|a| (a.value, a.error)).filter(|(value, _)| value.is_finite()).collect();
        let numbers = if values.is_empty() {
            [f64::NAN, f64::NAN, 0.0, f64::NAN, f64::NAN, f64::NAN]
        } else {
            let found = SeedMean::of(&values);
            [found.mean, found.error, found.seeds as f64, found.deviation, found.claimed, found.calibration()]
        };
        let point = member.point_name();
        let words = [&point, &member.described(), &quantity, &species, &verdicts(&same), &same[0].unit];
        table.add(&words.map(String::as_str), &[&of[..], &numbers].concat());
    }
}

/// Number of occurrences of each verdict: `7 converged, 1 too short`.
fn verdicts(answers: &[&MemberAnswer]) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for answer in answers.iter().filter(|answer| !answer.verdict.is_empty()) {
        match counts.iter_mut().find(|(verdict, _)| *verdict == answer.verdict) {
            Some((_, count)) => *count += 1,
            None => counts.push((&answer.verdict, 1)),
        }
    }
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts.iter().map(|(verdict, count)| format!("{count} {verdict}")).collect::<Vec<_>>().join(", ")
}
