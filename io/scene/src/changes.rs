//! Changes of a scene between two parts of its run: which keys may change, and which may not.

use crate::differences::{Difference, differences_of};
use crate::document::excerpt;
use crate::{Kind, Scene};
use serde::Serialize;
use std::fmt::{Display, Formatter};
use std::path::Path;
use toml::{Table, Value};

/// A key of a scene that has another value from a step on.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SceneChange {
    /// The step after which the new value holds.
    pub step: u64,
    /// The key, as `fluid.viscosity`.
    pub key: String,
    /// Its value before, as TOML; none where it was absent.
    pub before: Option<String>,
    /// Its value after.
    pub after: Option<String>,
}

/// Treatment of a key that has changed when a run goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// It is taken.
    Taken,
    /// It is taken if it is accepted by name.
    WithConsent,
    /// It is the run's: the scene stays another one.
    Fixed,
}

/// Keys that may change in any run: they do not change what is computed, and a device changes it within the tolerance.
const TAKEN: [&str; 12] = [
    "title",
    "time.steps",
    "time.duration",
    "time.strain",
    "answers.from",
    "output.folder",
    "output.trajectory_every",
    "output.observables_every",
    "output.checkpoint_every",
    "output.fields_every",
    "output.contacts_every",
    "hydrodynamics.device",
];

/// Keys that may change if they are accepted.
const WITH_CONSENT: [&str; 5] = [
    "fluid.viscosity",
    "repulsion.strength",
    "repulsion.range",
    "repulsion.screening_length",
    "repulsion.radius_power",
];

/// Keys that a run adds to its scene: the measured costs and network of the machine where it started, the stiffness of
/// contacts found by the adaptation, and the strain of the box that its particles come from.
const OWN: [&str; 4] = ["hydrodynamics.costs", "hydrodynamics.network", "contacts.adapted_stiffness", "box.strain"];

/// Keys that a run sets in its scene where that asks for a calibrated repulsion.
const FOUND: [&str; 2] = ["repulsion.strength", "repulsion.calibrate"];

/// Differences that are named.
const NAMED: usize = 5;

/// Treatment of a key of this name.
pub fn rule(key: &str) -> Rule {
    if TAKEN.contains(&key) || key.split(['.', '[']).next() == Some("statistics") {
        Rule::Taken
    } else if WITH_CONSENT.contains(&key) {
        Rule::WithConsent
    } else {
        Rule::Fixed
    }
}

/// Whether a difference is none: what the run has added to its scene, or a place of particles that has moved with them.
pub fn is_none(difference: &Difference) -> bool {
    let [now, then] = &difference.values;
    let is_added = then.is_none() && OWN.iter().any(|own| difference.key.starts_with(own));
    let is_moved = || now.as_deref().zip(then.as_deref()).is_some_and(|(now, then)| is_same_file(now, then));
    is_added || difference.key == "particles.path" && is_moved()
}

/// Whether two paths, as TOML, are of one file: of the same name, where one of them leads nowhere any more.
fn is_same_file(now: &str, then: &str) -> bool {
    let read = |text: &str| {
        let table: Table = toml::from_str(&format!("path = {text}")).ok()?;
        table.get("path").and_then(Value::as_str).map(str::to_owned)
    };
    let (Some(now), Some(then)) = (read(now), read(then)) else { return false };
    let [now, then] = [&now, &then].map(Path::new);
    now.file_name() == then.file_name() && !(now.is_absolute() && then.is_absolute() && now.exists() && then.exists())
}

/// The keys that are accepted, each as it was written; `Err` for one that can't be.
pub fn check_accepted(accepted: &[String]) -> Result<(), String> {
    match accepted.iter().find(|key| rule(key) != Rule::WithConsent) {
        Some(key) if rule(key) == Rule::Taken => {
            Err(format!("--accept {key}: this key may change without being accepted; leave --accept out"))
        }
        Some(key) => Err(format!(
            "--accept {key}: a run can't go on with another value of this key; those that can be accepted are {}",
            WITH_CONSENT.join(", ")
        )),
        None => Ok(()),
    }
}

impl SceneChange {
    /// Whether spheres move in another way from this step on.
    pub fn changes_answers(&self) -> bool {
        rule(&self.key) != Rule::Taken
    }
}

impl Scene {
    /// The changes with which a run goes on from a step, of which `then` is the text of the scene. `Err` names the keys
    /// that may not change, with both values.
    pub fn changes_since(&self, then: &str, accepted: &[String], step: u64) -> Result<Vec<SceneChange>, String> {
        check_accepted(accepted)?;
        let all =
            differences_of(self.text(), then).map_err(|e| format!("the scene of its checkpoint is no TOML: {e}"))?;
        let all: Vec<Difference> = all.into_iter().filter(|difference| !is_none(difference)).collect();
        let asks = |d: &&Difference| rule(&d.key) == Rule::WithConsent && !accepted.contains(&d.key);
        let stays = |d: &&Difference| rule(&d.key) == Rule::Fixed || asks(d);
        let comes_or_goes = comes_or_goes(&all, self.text(), then);
        if comes_or_goes.is_some() || all.iter().any(|d| rule(&d.key) == Rule::Fixed) {
            let lines: Vec<String> = all.iter().filter(stays).map(ToString::to_string).chain(comes_or_goes).collect();
            return Err(format!(
                "{}; put back what the run has, or start another run in another folder",
                some_of(&lines)
            ));
        }
        let asked: Vec<&Difference> = all.iter().filter(asks).collect();
        if !asked.is_empty() {
            let lines: Vec<String> = asked.iter().map(ToString::to_string).collect();
            let options: Vec<String> = asked.iter().map(|difference| format!("--accept {}", difference.key)).collect();
            return Err(format!(
                "{}; this changes the answers from step {step} on: accept it by {}, or put back what the run has",
                some_of(&lines),
                options.join(" ")
            ));
        }
        let change = |Difference { key, values: [after, before] }| SceneChange { step, key, before, after };
        Ok(all.into_iter().map(change).collect())
    }

    /// The differences from the scene that a run has kept, of keys that can't change in its course.
    pub fn fixed_differences(&self, kept: &Self) -> Vec<Difference> {
        self.other_than_added(kept).filter(|difference| rule(&difference.key) == Rule::Fixed).collect()
    }

    /// Whether a run that has kept a scene is a run of this one, whatever its end and its output.
    pub fn is_of_run(&self, kept: &Self) -> bool {
        self.other_than_added(kept).all(|difference| rule(&difference.key) == Rule::Taken)
    }

    /// The differences from the scene that a run has kept, but for what runs add to it.
    fn other_than_added(&self, kept: &Self) -> impl Iterator<Item = Difference> {
        let calibrates = self.calibrates();
        let is_found = move |key: &str| calibrates && FOUND.contains(&key);
        let is_added = |d: &Difference| d.values[0].is_none() && OWN.iter().any(|own| d.key.starts_with(own));
        self.differences(kept).into_iter().filter(move |d| !is_none(d) && !is_added(d) && !is_found(&d.key))
    }

    /// The scene with which the run of a folder goes on: this one, with the keys that the run has added to `kept`, the
    /// scene in the folder.
    pub fn with_own_keys_of(self, kept: &Self) -> Result<Self, crate::SceneError> {
        let calibrates = self.calibrates();
        let is_own = |key: &str| OWN.iter().any(|own| key.starts_with(own)) || calibrates && FOUND.contains(&key);
        let added = self.differences(kept).into_iter().filter_map(|Difference { key, values: [here, there] }| {
            let is_meant = is_own(&key) && (here.is_none() || calibrates && key.starts_with("repulsion."));
            there.filter(|_| is_meant).map(|there| format!("{key}={there}"))
        });
        let added: Vec<String> = added.collect();
        if added.is_empty() {
            return Ok(self);
        }
        self.with("what its run has added", &added)
    }

    /// Whether the strength of its repulsion is found in a trial.
    fn calibrates(&self) -> bool {
        matches!(self.kind(), Kind::Suspension(s) if s.model.repulsion.is_some_and(|repulsion| repulsion.calibrate))
    }
}

/// Why a section of keys that can be accepted may neither come nor go.
fn comes_or_goes(all: &[Difference], now: &str, then: &str) -> Option<String> {
    let has_section = |text: &str| toml::from_str::<Table>(text).is_ok_and(|table| table.contains_key("repulsion"));
    let is_changed = all.iter().any(|difference| difference.key.starts_with("repulsion."));
    (is_changed && has_section(now) != has_section(then)).then(|| {
        "[repulsion] can change, but can't be added to a run or taken from it, since the time series would have other \
         columns"
            .to_owned()
    })
}

/// The first of some lines, and how many more there are.
pub fn some_of(lines: &[String]) -> String {
    let named = lines[..lines.len().min(NAMED)].join(", ");
    if lines.len() > NAMED { format!("{named}, and {} more", lines.len() - NAMED) } else { named }
}

impl Display for SceneChange {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let [before, after] = [&self.before, &self.after].map(|value| excerpt(value.as_deref().unwrap_or("absent")));
        write!(f, "{} is {after} from step {} on, and was {before}", self.key, self.step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
time = { step = 0.02, steps = 30 }
output.trajectory_every = 5
repulsion = { strength = 4.0, range = 0.1 }
[[species]]
name = "a"
radius = 1.0
count = 25
"#;

    fn changes(from: &str, to: &str, accepted: &[&str]) -> Result<Vec<String>, String> {
        let now = Scene::parse(&TEXT.replace(from, to), "scene.toml", &[]).unwrap();
        let accepted: Vec<String> = accepted.iter().map(|&key| key.to_owned()).collect();
        Ok(now.changes_since(TEXT, &accepted, 7)?.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn what_does_not_change_the_answers_is_taken() {
        for (from, to, said) in [
            (
                "steps = 30",
                "duration = 1.5",
                vec!["time.duration is 1.5 from step 7 on, and was absent", "time.steps is absent"],
            ),
            ("every = 5", "every = 2", vec!["output.trajectory_every is 2 from step 7 on, and was 5"]),
            ("box.edges", "title = \"b\"\nbox.edges", vec!["title is \"b\" from step 7 on"]),
            ("[[species]]", "[statistics]\nevery = 2\n[[species]]", vec!["statistics.every is 2"]),
            (
                "[[species]]",
                "[answers]\nfrom = 0.2\n[[species]]",
                vec!["answers.from is 0.2 from step 7 on, and was absent"],
            ),
            ("1.0", "1.0", vec![]),
            (
                "[[species]]",
                "hydrodynamics.device = \"gpu\"\n[[species]]",
                vec!["hydrodynamics.device is \"gpu\" from step 7 on, and was absent"],
            ),
            (
                "[[species]]",
                "hydrodynamics.costs = { stencils = 1.0, transforms = 1.0, pairs = 1.0 }\n[[species]]",
                vec![],
            ),
        ] {
            let found = changes(from, to, &[]).unwrap();
            assert_eq!(found.len(), said.len(), "{found:?}");
            assert!(found.iter().zip(&said).all(|(found, said)| found.starts_with(said)), "{found:?}");
        }
    }

    #[test]
    fn what_changes_the_answers_has_to_be_accepted() {
        let error = changes("viscosity = 1.0", "viscosity = 2.0", &[]).unwrap_err();
        assert!(
            error.contains("fluid.viscosity is 2.0 here and 1.0 there; this changes the answers from step 7 on"),
            "{error}"
        );
        assert!(error.contains("accept it by --accept fluid.viscosity"), "{error}");
        let taken = changes("viscosity = 1.0", "viscosity = 2.0", &["fluid.viscosity", "repulsion.range"]).unwrap();
        assert_eq!(taken, ["fluid.viscosity is 2.0 from step 7 on, and was 1.0"]);
        assert_eq!(changes("strength = 4.0", "strength = 5.0", &["repulsion.strength"]).unwrap().len(), 1);
        let error =
            changes("repulsion = { strength = 4.0, range = 0.1 }", "", &["repulsion.strength", "repulsion.range"]);
        assert!(error.unwrap_err().contains("[repulsion] can change, but can't be added"));
    }

    #[test]
    fn everything_else_is_refused_by_name_with_both_values() {
        for (from, to, key) in [
            (
                "14.0, 14.0, 14.0",
                "15.0, 14.0, 14.0",
                "box.edges is [15.0, 14.0, 14.0] here and [14.0, 14.0, 14.0] there",
            ),
            ("step = 0.02", "step = 0.01", "time.step is 0.01 here and 0.02 there"),
            ("25", "24", "species[0].count is 24 here and 25 there"),
            ("radius = 1.0", "radius = 1.1", "species[0].radius is 1.1"),
            ("box.edges", "seed = 5\nbox.edges", "seed is 5 here and absent there"),
            (
                "[[species]]",
                "flow = { kind = \"shear\", rate = 2.0 }\n[[species]]",
                "flow.rate is 2.0 here and absent there",
            ),
        ] {
            let error = changes(from, to, &["fluid.viscosity"]).unwrap_err();
            assert!(error.contains(key) && error.contains("put back what the run has"), "{error}");
        }
        for (key, why) in [("box.edges", "can't go on with another value"), ("time.steps", "without being accepted")] {
            assert!(changes("1.0", "1.0", &[key]).unwrap_err().contains(why));
        }
    }
}
