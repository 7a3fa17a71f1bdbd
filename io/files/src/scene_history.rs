//! Scenes of a file of frames: that of its first frame, and a table of the keys that have changed since then, in
//! `parameters/changes`: `step`, `key`, `before` and `after`, one row per change. As with frames, rows are valid once
//! the length of `step` includes them.

use crate::Provenance;
use crate::frames::group;
use crate::missing_steps::Period;
use crate::self_contained;
use hdf5::dataset::{AllocTime, FillTime};
use hdf5::types::FixedUnicode;
use hdf5::{Dataset, File, Group, H5Type};
use scene::{Difference, Rule, Scene, SceneChange, differences_of, is_none, rule, some_of};
use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;
use toml::{Table, Value};

/// Path of the table's group.
const PLACE: &str = "parameters/changes";
/// Number of rows that a file has room for.
const ROOM: usize = 200;
/// Largest number of bytes of a key, and of a value; longer ones are cut.
const KEY: usize = 64;
const VALUE: usize = 128;

/// The scenes of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneHistory {
    /// The scene of the first frame.
    pub first: String,
    /// Changes in the order of their steps.
    pub changes: Vec<SceneChange>,
}

impl SceneHistory {
    /// Scene history of a file, as far as it can be read.
    pub fn of(path: &Path) -> Option<Self> {
        let file = self_contained::open(path).ok()?;
        let changes = changes(&file).ok()?;
        Some(Self { first: Provenance::read(&file).ok()?.scene, changes })
    }

    /// The history in the time series, or in the trajectory, of a folder.
    pub fn of_folder(folder: &Path) -> Option<Self> {
        ["observables.h5", "trajectory.h5"].into_iter().find_map(|name| Self::of(&folder.join(name)))
    }

    /// Drops the changes after a step, and adds those that make the scene that of `now` from that step on. `Err` if it
    /// is no scene of this run: keys differ that can't change.
    pub fn bring_to(&mut self, now: &str, step: u64) -> Result<(), String> {
        self.changes.retain(|change| change.step <= step);
        let all = differences_of(now, &self.first).map_err(|e| format!("its scene is no TOML: {e}"))?;
        let all: Vec<Difference> = all.into_iter().filter(|difference| !is_none(difference)).collect();
        let other: Vec<String> = all.iter().filter(|d| rule(&d.key) == Rule::Fixed).map(ToString::to_string).collect();
        if !other.is_empty() {
            return Err(format!(
                "it is of another scene than the checkpoint: {}; move it away, or restore it from a copy",
                some_of(&other)
            ));
        }
        let back = self.changes.iter().filter(|change| all.iter().all(|difference| difference.key != change.key));
        let back: Vec<(String, Option<String>)> =
            back.map(|change| (change.key.clone(), self.at_first(&change.key))).collect();
        let new = all.into_iter().map(|Difference { key, values: [now, then] }| (key, now, then));
        for (key, now, then) in new.chain(back.into_iter().map(|(key, first)| (key, first.clone(), first))) {
            let before = self.latest(&key).map_or_else(|| then.as_deref().map(cut), |change| change.after.clone());
            let after = now.as_deref().map(cut);
            if before != after {
                self.changes.push(SceneChange { step, key, before, after });
            }
        }
        Ok(())
    }

    /// The latest change of a key.
    pub fn latest(&self, key: &str) -> Option<&SceneChange> {
        self.changes.iter().rev().find(|change| change.key == key)
    }

    /// Value of a changed key in the first scene.
    fn at_first(&self, key: &str) -> Option<String> {
        self.changes.iter().find(|change| change.key == key).and_then(|change| change.before.clone())
    }

    /// Replaces the table of a file by the latest of these changes, as many as it has room for. A file of an
    /// older version has no table.
    pub fn write(&self, file: &File) -> hdf5::Result<()> {
        let Ok(steps) = file.dataset(&format!("{PLACE}/step")) else { return Ok(()) };
        let (stored, first) = (changes(file)?, self.changes.len().saturating_sub(ROOM));
        let latest = &self.changes[first..];
        let same = stored.iter().zip(latest).take_while(|(stored, change)| stored == change).count();
        if same < stored.len() {
            steps.resize((same,))?;
            file.flush()?;
        }
        for (row, change) in latest.iter().enumerate().skip(same) {
            put(file, "key", row, text::<KEY>(Some(&change.key))?)?;
            put(file, "before", row, text::<VALUE>(change.before.as_ref())?)?;
            put(file, "after", row, text::<VALUE>(change.after.as_ref())?)?;
            file.flush()?;
            put(file, "step", row, change.step)?;
            file.flush()?;
        }
        Ok(())
    }

    /// Periods with their schedule of frames.
    pub fn periods(&self) -> Vec<Period> {
        let Ok(mut scene) = toml::from_str::<Table>(&self.first) else { return Vec::new() };
        let mut periods = Vec::new();
        let mut from = 0;
        for of_step in self.changes.chunk_by(|one, next| one.step == next.step) {
            periods.extend(period(&scene, from..=of_step[0].step));
            for change in of_step {
                change_key(&mut scene, change);
            }
            from = of_step[0].step + 1;
        }
        periods.extend(period(&scene, from..=u64::MAX));
        periods
    }

    /// The scene of the first frame, followed by comments with the changes and the steps from which they hold.
    pub fn in_words(&self) -> String {
        let mut text = self.first.clone();
        if !self.changes.is_empty() && !text.ends_with('\n') {
            text.push('\n');
        }
        let comments: Vec<String> = self.changes.iter().map(|change| format!("# {change}\n")).collect();
        text + &comments.concat()
    }
}

/// Schedule of frames for a range of steps, according to the scene at that time.
fn period(scene: &Table, steps: RangeInclusive<u64>) -> Option<Period> {
    let text = toml::to_string(scene).ok()?;
    let scene = Scene::parse(&text, "the scene of the run", &[]).ok()?;
    let schedule = scene.kind().output()?.trajectory;
    Some(Period { steps, schedule })
}

/// Changes a key of a section. A value that was cut, which no schedule has, is left unchanged.
fn change_key(scene: &mut Table, change: &SceneChange) {
    let Some((section, name)) = change.key.split_once('.') else { return };
    let section = scene.entry(section).or_insert_with(|| Value::Table(Table::new()));
    let Some(section) = section.as_table_mut() else { return };
    match &change.after {
        None => drop(section.remove(name)),
        Some(text) => {
            let value = toml::from_str::<Table>(&format!("value = {text}")).ok();
            if let Some(value) = value.and_then(|mut table| table.remove("value")) {
                section.insert(name.to_owned(), value);
            }
        }
    }
}

/// Creates an empty table.
pub(crate) fn create(file: &File) -> hdf5::Result<()> {
    let table = group(file, PLACE)?;
    reserve::<u64>(&table, "step")?;
    reserve::<FixedUnicode<KEY>>(&table, "key")?;
    reserve::<FixedUnicode<VALUE>>(&table, "before")?;
    reserve::<FixedUnicode<VALUE>>(&table, "after")
}

/// Creates a column without rows, with all its storage allocated.
fn reserve<T: H5Type>(table: &Group, name: &str) -> hdf5::Result<()> {
    let new = table.new_dataset::<T>().with_dcpl(|d| d.alloc_time(Some(AllocTime::Early)).fill_time(FillTime::Never));
    let column = new.chunk((ROOM,)).shape((0..=ROOM,)).create(name)?;
    column.resize((1,))?;
    column.resize((0,))
}

/// Changes listed in a file; empty if it has no table.
pub(crate) fn changes(file: &File) -> hdf5::Result<Vec<SceneChange>> {
    let column = |name: &str| file.dataset(&format!("{PLACE}/{name}"));
    let Ok(steps) = column("step") else { return Ok(Vec::new()) };
    let steps = short::<u64>(&steps)?;
    let keys = short::<FixedUnicode<KEY>>(&column("key")?)?;
    let [before, after] = [column("before")?, column("after")?];
    let (before, after) = (short::<FixedUnicode<VALUE>>(&before)?, short::<FixedUnicode<VALUE>>(&after)?);
    let value = |list: &[FixedUnicode<VALUE>], row: usize| list.get(row).map(read).filter(|text| !text.is_empty());
    let row = |(row, (&step, key)): (usize, (&u64, &FixedUnicode<KEY>))| SceneChange {
        step,
        key: read(key),
        before: value(&before, row),
        after: value(&after, row),
    };
    Ok(steps.iter().zip(&keys).enumerate().map(row).collect())
}

/// A text, which may have any bytes in a damaged file.
fn read<const N: usize>(text: &FixedUnicode<N>) -> String {
    String::from_utf8_lossy(text.as_bytes()).into_owned()
}

/// All values of a column, which must not be longer than the table can be.
fn short<T: H5Type>(dataset: &Dataset) -> hdf5::Result<Vec<T>> {
    if dataset.shape().iter().product::<usize>() > ROOM {
        return Err(format!("{} has more than {ROOM} rows", dataset.name()).into());
    }
    dataset.read_raw()
}

fn put<T: H5Type + Clone>(file: &File, name: &str, row: usize, value: T) -> hdf5::Result<()> {
    let dataset = file.dataset(&format!("{PLACE}/{name}"))?;
    dataset.resize((row + 1,))?;
    dataset.write_slice(&[value], row..=row)
}

fn text<const N: usize>(value: Option<&String>) -> hdf5::Result<FixedUnicode<N>> {
    let value = value.map(String::as_str).unwrap_or_default();
    FixedUnicode::from_str(value).map_err(|e| format!("`{value}`: {e}").into())
}

/// A value cut to the length that fits into the table.
fn cut(value: &str) -> String {
    const DOTS: &str = "...";
    let value = value.replace('\0', " ");
    if value.len() < VALUE {
        return value;
    }
    let end = (0..VALUE - DOTS.len()).rev().find(|&end| value.is_char_boundary(end)).unwrap_or(0);
    format!("{}{DOTS}", &value[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIRST: &str = "title = \"a\"\n[fluid]\nviscosity = 1\n[time]\nsteps = 9\n";

    fn change(step: u64, key: &str, before: Option<&str>, after: Option<&str>) -> SceneChange {
        SceneChange { step, key: key.to_owned(), before: before.map(str::to_owned), after: after.map(str::to_owned) }
    }

    #[test]
    fn a_history_ends_in_the_scene_of_now() {
        let mut history = SceneHistory { first: FIRST.to_owned(), changes: Vec::new() };
        history.bring_to(&FIRST.replace("= 1", "= 1.0"), 3).unwrap();
        assert_eq!(history.changes, []);
        let later = FIRST.replace("viscosity = 1", "viscosity = 2.5").replace("steps = 9", "duration = 1.5");
        history.bring_to(&later, 9).unwrap();
        let expected = [
            change(9, "fluid.viscosity", Some("1"), Some("2.5")),
            change(9, "time.duration", None, Some("1.5")),
            change(9, "time.steps", Some("9"), None),
        ];
        assert_eq!(history.changes, expected);
        history.bring_to(&later, 9).unwrap();
        assert_eq!(history.changes, expected, "once is enough");
        history.bring_to(&later.replace("2.5", "4"), 12).unwrap();
        assert_eq!(history.changes[3..], [change(12, "fluid.viscosity", Some("2.5"), Some("4"))]);
        history.bring_to(&later.replace("viscosity = 2.5", "viscosity = 1"), 10).unwrap();
        assert_eq!(
            history.changes[3..],
            [change(10, "fluid.viscosity", Some("2.5"), Some("1"))],
            "later ones are gone"
        );
        assert!(history.in_words().starts_with(FIRST));
        assert!(history.in_words().ends_with("# fluid.viscosity is 1 from step 10 on, and was 2.5\n"));
        assert!(toml::from_str::<toml::Table>(&history.in_words()).is_ok());
        let error = history.bring_to(&format!("seed = 3\n{FIRST}"), 10).unwrap_err();
        assert!(error.contains("another scene than the checkpoint: seed is 3 here and absent there"), "{error}");
    }

    #[test]
    fn periods_follow_the_intervals_and_the_end() {
        let first = scene::Template::named("settling").unwrap().text.to_owned();
        let scene = Scene::parse(&first, "settling", &["time.steps=200".to_owned()]).unwrap();
        let mut history = SceneHistory { first: scene.text().to_owned(), changes: Vec::new() };
        let mut every = |setting: &str, step| {
            let scene = Scene::parse(scene.text(), "settling", &[setting.to_owned()]).unwrap();
            history.bring_to(scene.text(), step).unwrap();
            let periods = history.periods().into_iter();
            periods
                .map(|period| (*period.steps.start(), period.schedule.next_after(0).unwrap_or(0)))
                .collect::<Vec<_>>()
        };
        let usual = every("title=\"a\"", 5)[0].1;
        assert_eq!(every("output.trajectory_every=7", 20).last(), Some(&(21, 7)));
        assert_eq!(every("output.trajectory_every=0", 30)[1..], [(6, usual), (21, 7), (31, 0)]);
    }

    #[test]
    fn a_file_has_the_table_that_was_written_last() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        let file = File::create(&path).unwrap();
        assert_eq!(changes(&file).unwrap(), []);
        create(&file).unwrap();
        let long = cut(&"\u{b5}".repeat(100));
        assert!(long.ends_with("...") && long.len() < VALUE);
        let all: Vec<SceneChange> =
            (0..5).map(|step| change(step, "title", (step > 0).then_some("\"a\""), Some(&long))).collect();
        for count in [0, 3, 5, 2, 4] {
            let history = SceneHistory { first: String::new(), changes: all[..count].to_vec() };
            history.write(&file).unwrap();
            assert_eq!(changes(&file).unwrap(), history.changes);
        }
        let much = (0..=ROOM as u64).map(|step| change(step, "title", None, Some("1"))).collect::<Vec<_>>();
        SceneHistory { first: String::new(), changes: much.clone() }.write(&file).unwrap();
        assert_eq!(changes(&file).unwrap(), much[1..], "the latest");
        SceneHistory { first: String::new(), changes: all[..4].to_vec() }.write(&file).unwrap();
        drop(file);
        assert_eq!(SceneHistory::of(&path), None, "without a scene");
        assert_eq!(changes(&File::open(&path).unwrap()).unwrap(), all[..4]);
    }
}
