//! The family that tells how an answer depends on the step, the box, the tolerance and the stiffness of contacts.

use super::{Family, SceneFile};
use crate::overrides::get;
use crate::scene::SceneText;
use crate::{Kind, Scene, SceneError, SuspensionScene};
use domain::Boundaries;
use std::path::Path;
use toml::{Table, Value};

/// A scene as it is, and with one thing changed at a time, each with the same seeds.
#[derive(Debug)]
pub struct Convergence {
    /// The runs; the first point is the scene as it is.
    pub family: Family,
    /// Description of the change at each further point.
    pub changes: Vec<&'static str>,
    /// Changes that can't be made, with the reasons.
    pub left_out: Vec<String>,
}

/// Keys that are changed together, with the values that they have and get.
struct KeyChange {
    name: &'static str,
    keys: Vec<(String, Value, Value)>,
}

impl Convergence {
    /// The runs of a scene with so many seeds.
    pub fn of(scene: &Scene, seeds: u64) -> Result<Self, SceneError> {
        let table: Table = toml::from_str(scene.text()).expect("the scene was read from this text");
        let root = Value::Table(table);
        let (mut changes, mut left_out) = (Vec::new(), Vec::new());
        for found in [half_step(&root, scene), box_of(&root, scene), tolerance(&root, scene), stiffness(&root, scene)] {
            match found {
                Ok(change) => changes.push(change),
                Err(why) => left_out.push(why),
            }
        }
        let text = text_of(root, &changes, seeds);
        let source = SceneText {
            text: &text,
            name: "the scene with its changes",
            folder: Path::new(""),
            overrides: &[],
            without: &[],
            edges_of: scene.edges_of(),
        };
        let family = match SceneFile::of_text(source)? {
            SceneFile::Family(family) => family,
            SceneFile::Scene(_) => unreachable!("the text has the section of a family"),
        };
        Ok(Self { family, changes: changes.iter().map(|change| change.name).collect(), left_out })
    }
}

/// The text of the family: each point has all keys, changed or as they are.
fn text_of(root: Value, changes: &[KeyChange], seeds: u64) -> String {
    let point = |changed: Option<usize>| {
        let of = |(place, change): (usize, &KeyChange)| {
            let pick = |(key, now, then): &(String, Value, Value)| {
                (key.clone(), if changed == Some(place) { then.clone() } else { now.clone() })
            };
            change.keys.iter().map(pick).collect::<Vec<_>>()
        };
        Value::Table(changes.iter().enumerate().flat_map(of).collect())
    };
    let points = std::iter::once(None).chain((0..changes.len()).map(Some)).map(point).collect();
    let mut table = root.try_into::<Table>().unwrap_or_default();
    table.insert(
        "ensemble".to_owned(),
        Value::Table([("seeds".to_owned(), Value::Integer(seeds as i64))].into_iter().collect()),
    );
    table.insert("sweep".to_owned(), Value::Array(points));
    toml::to_string(&table).expect("it comes from a text")
}

fn number(root: &Value, key: &str) -> Option<f64> {
    let value = get(root, key)?;
    value.as_float().or_else(|| value.as_integer().map(|n| n as f64))
}

fn scaled(key: &str, now: f64, factor: f64) -> (String, Value, Value) {
    (key.to_owned(), Value::Float(now), Value::Float(now * factor))
}

/// Whole numbers of steps, of which there are twice as many.
const IN_STEPS: [&str; 8] = [
    "time.steps",
    "output.trajectory_every",
    "output.observables_every",
    "output.checkpoint_every",
    "output.fields_every",
    "output.contacts_every",
    "output.measure_every",
    "statistics.every",
];

fn half_step(root: &Value, scene: &Scene) -> Result<KeyChange, String> {
    let step = number(root, "time.step").ok_or("the step: the scene has no time.step")?;
    if let Kind::Continuum(_) = scene.kind() {
        return Err("the step: scenes of this kind have none".to_owned());
    }
    let twice = |key: &&str| {
        let now = get(root, key)?.as_integer()?;
        Some(((*key).to_owned(), Value::Integer(now), Value::Integer(now.saturating_mul(2))))
    };
    let keys = std::iter::once(scaled("time.step", step, 0.5)).chain(IN_STEPS.iter().filter_map(twice));
    Ok(KeyChange { name: "half the step", keys: keys.collect() })
}

/// Twice the edges along all periodic axes, at the same concentration.
fn box_of(root: &Value, scene: &Scene) -> Result<KeyChange, String> {
    let edges = get(root, "box.edges").and_then(Value::as_array).ok_or("the box: the scene has no box.edges")?;
    let is_periodic = match scene.kind() {
        Kind::Suspension(suspension) => periodic_axes(suspension, root)?,
        Kind::GranularDisks(_) => vec![true; 2],
        _ => return Err("the box: it is doubled in suspensions and of disks only".to_owned()),
    };
    if get(root, "particles.path").is_some() || get(root, "particles.positions").is_some() {
        return Err("the box: the particles have given places, of which there are none for a larger one".to_owned());
    }
    let double = |(edge, is_periodic): (&Value, &bool)| {
        let edge = edge.as_float().or_else(|| edge.as_integer().map(|n| n as f64)).unwrap_or(f64::NAN);
        Value::Float(if *is_periodic { 2.0 * edge } else { edge })
    };
    let doubled = edges.iter().zip(&is_periodic).map(double).collect();
    let mut keys = vec![("box.edges".to_owned(), Value::Array(edges.clone()), Value::Array(doubled))];
    let factor = 1_i64 << is_periodic.iter().filter(|is_periodic| **is_periodic).count();
    let count = |name: &str| get(root, name).and_then(Value::as_array).map_or(0, Vec::len);
    if (0..count("bodies")).any(|place| get(root, &format!("bodies[{place}].positions")).is_some()) {
        return Err("the box: bodies have given places, of which there are none for a larger one".to_owned());
    }
    let counts = ["species", "bodies"].map(|name| (0..count(name)).map(move |place| format!("{name}[{place}].count")));
    for key in counts.into_iter().flatten() {
        if let Some(count) = get(root, &key).and_then(Value::as_integer) {
            keys.push((key, Value::Integer(count), Value::Integer(count.saturating_mul(factor))));
        }
    }
    if let Some(grid) = get(root, "hydrodynamics.grid").and_then(Value::as_array) {
        let double = |(points, is_periodic): (&Value, &bool)| match points.as_integer() {
            Some(points) if *is_periodic => Value::Integer(2 * points),
            _ => points.clone(),
        };
        let doubled = grid.iter().zip(&is_periodic).map(double).collect();
        keys.push(("hydrodynamics.grid".to_owned(), Value::Array(grid.clone()), Value::Array(doubled)));
    }
    Ok(KeyChange { name: "twice the edges", keys })
}

fn periodic_axes(scene: &SuspensionScene, root: &Value) -> Result<Vec<bool>, String> {
    if scene.model.cell.boundaries() == Boundaries::Open {
        return Err("the box: unbounded fluid has none".to_owned());
    }
    let named = get(root, "box.boundaries").and_then(Value::as_array);
    Ok(named.map_or(vec![true; 3], |names| names.iter().map(|name| name.as_str() == Some("periodic")).collect()))
}

fn tolerance(root: &Value, scene: &Scene) -> Result<KeyChange, String> {
    let Kind::Suspension(suspension) = scene.kind() else {
        return Err("the tolerance: suspensions have one".to_owned());
    };
    let mut keys = vec![scaled("hydrodynamics.tolerance", suspension.model.hydrodynamics.tolerance, 0.1)];
    let others = ["hydrodynamics.iteration_tolerance"].map(|key| Some(scaled(key, number(root, key)?, 0.1)));
    keys.extend(others.into_iter().flatten());
    Ok(KeyChange { name: "a tenth of the tolerance", keys })
}

/// Four times the stiffness of contacts; where the stiffness adapts to a target overlap, a quarter of that overlap.
/// Without contacts, four times the repulsion.
fn stiffness(root: &Value, scene: &Scene) -> Result<KeyChange, String> {
    let Kind::Suspension(suspension) = scene.kind() else {
        return Err("the stiffness: suspensions with contacts or repulsion have one".to_owned());
    };
    let name = "four times the stiffness";
    if let Some(contacts) = &suspension.model.contacts {
        let key = match contacts.stiffness {
            Some(stiffness) => scaled("contacts.stiffness", stiffness, 4.0),
            None => scaled("contacts.target_overlap", contacts.overlap, 0.25),
        };
        return Ok(KeyChange { name, keys: vec![key] });
    }
    let strength = number(root, "repulsion.strength");
    let strength = strength.ok_or("the stiffness: the scene has neither contacts nor repulsion")?;
    Ok(KeyChange { name: "four times the repulsion", keys: vec![scaled("repulsion.strength", strength, 4.0)] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Template;

    fn of(name: &str, sets: &[&str]) -> Convergence {
        let sets: Vec<String> = sets.iter().map(|&set| set.to_owned()).collect();
        let scene = Scene::parse(Template::named(name).unwrap().text, "scene.toml", &sets).unwrap();
        Convergence::of(&scene, 2).unwrap()
    }

    fn differences(found: &Convergence, point: usize) -> Vec<String> {
        let scene = |point: usize| found.family.scene(&found.family.members()[2 * point]).unwrap();
        scene(point).differences(&scene(0)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn one_thing_is_changed_at_a_time() {
        let found = of("dense", &[]);
        let names = ["half the step", "twice the edges", "a tenth of the tolerance", "four times the stiffness"];
        assert_eq!(found.changes, names);
        assert_eq!(found.family.members().len(), 10);
        let half = differences(&found, 1);
        assert!(half.iter().any(|line| line.starts_with("time.step is ")), "{half:?}");
        let [whole, finer] = [0, 2].map(|place| found.family.scene(&found.family.members()[place]).unwrap());
        let (Kind::Suspension(whole), Kind::Suspension(finer)) = (whole.kind(), finer.kind()) else { panic!() };
        assert!((finer.time.end() - whole.time.end()).abs() < 1e-9, "the same duration");
        let larger = differences(&found, 2);
        assert!(larger.iter().all(|line| line.starts_with("box.edges")), "{larger:?}");
        assert!(
            differences(&found, 3)[0].starts_with("hydrodynamics.tolerance is 0.001 here"),
            "{:?}",
            differences(&found, 3)
        );
        assert!(
            differences(&found, 4)[0].starts_with("contacts.target_overlap is 0.075"),
            "{:?}",
            differences(&found, 4)
        );
    }

    #[test]
    fn counts_grow_with_the_box_and_walls_stay_where_they_are() {
        let found = of("settling", &["time.steps=10", "output.trajectory_every=5"]);
        let half = differences(&found, 1);
        assert!(half.contains(&"time.steps is 20 here and 10 there".to_owned()), "{half:?}");
        assert!(half.contains(&"output.trajectory_every is 10 here and 5 there".to_owned()), "{half:?}");
        let larger = differences(&found, 2);
        assert!(larger.contains(&"species[0].count is 25600 here and 3200 there".to_owned()), "{larger:?}");
        assert!(found.changes.contains(&"four times the repulsion"), "{:?}", found.changes);
        let pair = of("pair-settling", &[]);
        assert!(pair.left_out[0].starts_with("the box: the particles have given places"), "{:?}", pair.left_out);
        let walls = differences(&of("couette", &[]), 2);
        let edges = walls.iter().find(|line| line.starts_with("box.edges")).unwrap();
        let scene = Scene::parse(Template::named("couette").unwrap().text, "scene.toml", &[]).unwrap();
        assert!(scene.text().contains("edges = [20.0, 20.0, 12.0]"), "{}", scene.text());
        assert!(edges.contains("[40.0, 40.0, 12.0]"), "{edges}");
    }
}
