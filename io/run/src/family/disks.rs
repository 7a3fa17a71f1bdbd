//! Tables of a family of sheared disks: the time series of each point as a mean over the seeds, and its final values.

use super::folder::FamilyFolder;
use super::spread::SeedMean;
use files::{FileError, Observables};
use granular::disks::{RECORD_COLUMNS, estimated_free_path, viscous_length};
use scene::{Family, GranularDisksScene, Kind, Member};
use simulation::Table;

/// The words that tell a point from the others, and its numbers.
const WORDS: [&str; 2] = ["point", "values"];
const OF: [(&str, &str); 3] = [("viscosity", "force*time/length^2"), ("rate", "1/time"), ("area_fraction", "")];

/// Further columns of a branch: the lengths of its disks, and the segregation in the last tenth of its runs.
const BRANCH: [(&str, &str); 4] = [
    ("viscous_length", "length"),
    ("estimated_free_path", "length"),
    ("last_segregation", ""),
    ("last_segregation_error", ""),
];

/// For each record of a run its numbers.
type Records = Vec<Vec<f64>>;

/// The tables of the records that there are by now; none for a family of other scenes.
pub(super) fn tables(folder: &FamilyFolder, family: &Family) -> Result<Vec<Table>, FileError> {
    let columns = RECORD_COLUMNS.iter().flat_map(|(name, unit)| [((*name).to_owned(), *unit), error_of(name, unit)]);
    let mut averages = Table::new("averages", &WORDS, &OF);
    averages.columns.extend(columns);
    let mut branches = Table::new("branches", &WORDS, &[&OF[..], &BRANCH].concat());
    for members in family.points() {
        let scene = family.scene(&members[0]).map_err(|e| FileError::read(folder.path(), &e))?;
        let Kind::GranularDisks(disks) = scene.kind() else { return Ok(Vec::new()) };
        let runs = members.iter().map(|member| records(folder, member)).collect::<Result<Vec<_>, _>>()?;
        let runs: Vec<Records> = runs.into_iter().filter(|records| !records.is_empty()).collect();
        if !runs.is_empty() {
            add(&mut averages, &mut branches, &members[0], disks, &runs);
        }
    }
    Ok(vec![averages, branches])
}

fn error_of(name: &str, unit: &'static str) -> (String, &'static str) {
    (format!("{name}_error"), unit)
}

/// The records of a run, so far as all of its quantities have them.
fn records(folder: &FamilyFolder, member: &Member) -> Result<Records, FileError> {
    let is_one = |name: &str| RECORD_COLUMNS.iter().any(|(column, _)| *column == name);
    let series = match Observables::of_folder(&folder.member(member), &is_one) {
        // Too many rows are being written to read it; the table is made again when this run ends.
        Err(_) if folder.is_running(member) => None,
        read => read?,
    };
    let Some(series) = series else { return Ok(Vec::new()) };
    let columns: Option<Vec<Vec<f64>>> =
        RECORD_COLUMNS.iter().map(|(name, _)| Some(series.get(name)?.column(0, 0).collect())).collect();
    let Some(columns) = columns else { return Ok(Vec::new()) };
    let count = columns.iter().map(Vec::len).min().unwrap_or_default();
    Ok((0..count).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
}

/// Adds a point: a row for each record that all of its runs have, and one for what they come to.
fn add(averages: &mut Table, branches: &mut Table, member: &Member, disks: &GranularDisksScene, runs: &[Records]) {
    let words = [member.point_name(), member.described()];
    let words = [&words[0][..], &words[1]];
    let p = disks.model.parameters();
    let of = [p.viscosity, p.flow.rate(p.edges[1]), p.area_fraction];
    let mean = |values: Vec<f64>| {
        let found = SeedMean::of(&values.into_iter().map(|value| (value, f64::NAN)).collect::<Vec<_>>());
        [found.mean, found.error]
    };
    let shortest = runs.iter().map(Vec::len).min().unwrap_or_default();
    for row in 0..shortest {
        let numbers = (0..RECORD_COLUMNS.len()).flat_map(|c| mean(runs.iter().map(|run| run[row][c]).collect()));
        averages.add(&words, &[&of[..], &numbers.collect::<Vec<_>>()].concat());
    }
    let last = mean(runs.iter().map(|records| last_segregation(records)).collect());
    let lengths = [viscous_length(&disks.model), estimated_free_path(p.area_fraction)];
    branches.add(&words, &[&of[..], &lengths, &last].concat());
}

/// The mean segregation in the last tenth of some records.
fn last_segregation(records: &[Vec<f64>]) -> f64 {
    let place = RECORD_COLUMNS.iter().position(|(name, _)| *name == "segregation").unwrap_or_default();
    let last = &records[records.len() - records.len().div_ceil(10)..];
    last.iter().map(|record| record[place]).sum::<f64>() / last.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ExistingRun;
    use scene::SceneFile;

    const SERIES: [[f64; 3]; 2] = [[0.1, 0.2, 0.6], [0.3, 0.4, 0.8]];

    /// Two seeds of two viscosities, of which the second has been run with one seed.
    #[test]
    fn a_point_is_the_mean_of_its_seeds_at_each_record() {
        let place = tempfile::tempdir().unwrap();
        let text = scene::Template::named("disk-sweep").unwrap().text;
        let Ok(SceneFile::Family(family)) = SceneFile::parse(text, "d.toml", &[]) else { panic!("a family") };
        let folder = FamilyFolder::claim(place.path(), &family, ExistingRun::Keep).unwrap();
        let names: Vec<&str> = RECORD_COLUMNS.iter().map(|(name, _)| *name).collect();
        for (member, values) in family.members().iter().zip([SERIES[0], SERIES[1], SERIES[0]]) {
            let rows = values.iter().enumerate().map(|(step, value)| {
                let numbers = names.iter().map(|name| if *name == "segregation" { *value } else { step as f64 });
                format!("{step},{step},{}\n", numbers.map(|n| n.to_string()).collect::<Vec<_>>().join(","))
            });
            let text = format!("step,time,{}\n{}", names.join(","), rows.collect::<String>());
            std::fs::write(folder.member(member).join("observables.csv"), text).unwrap();
        }
        let [averages, branches] = &tables(&folder, &family).unwrap()[..] else { panic!("two tables") };
        assert_eq!((averages.rows.len(), branches.rows.len()), (6, 2));
        let (words, numbers) = &averages.rows[1];
        assert_eq!(words, &["point-0001", "fluid.viscosity = 0.001"]);
        assert!((numbers[5] - 0.3).abs() < 1e-12 && numbers[..4] == [0.001, 0.01, 0.6, 1.0], "{numbers:?}");
        // Two values 0.1 from their mean, with the factor of Student's distribution.
        assert!((numbers[6] - 1.837_337 * 0.1).abs() < 1e-6, "{numbers:?}");
        let (words, numbers) = &branches.rows[1];
        assert_eq!(words[1], "fluid.viscosity = 0.01");
        assert!((numbers[5] - 0.6).abs() < 1e-12 && numbers[6].is_nan(), "{numbers:?}");
        assert!((branches.rows[0].1[5] - 0.7).abs() < 1e-12 && branches.rows[0].1[3] > 0.0);
    }
}
