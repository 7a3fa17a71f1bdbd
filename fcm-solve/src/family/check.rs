//! `fcm-solve check` of a family: the outline of each point, the number of runs, and the time in all.

use super::at_once;
use crate::outlined::{OutlinedScene, outlined};
use crate::streams::json;
use anyhow::{anyhow, bail, ensure};
use domain::{Comm, Number, readable_bytes};
use run::Trial;
use scene::{Family, Member};
use serde_json::{Value, json};
use simulation::Outline;
use std::fmt::Write as _;
use suspension::Asked;

/// A point of a family, represented by its first member.
struct Checked<'a> {
    member: &'a Member,
    runs: usize,
    outline: Outline,
    trial: Option<Trial>,
}

/// The outline of a family, in words or as JSON. Every member has been read; the first member of each point is planned,
/// placed and, if `is_tried`, tried on one core.
pub fn check(family: &Family, is_tried: bool, as_json: bool) -> anyhow::Result<String> {
    let (mut points, mut refused) = (Vec::new(), Vec::new());
    for members in family.points() {
        match point(members, family, is_tried) {
            Ok(point) => points.push(point),
            Err(error) => refused.push(format!("{error:#}")),
        }
    }
    ensure!(refused.is_empty(), "{}", scene::some_of(&refused));
    let members: Vec<&Member> = family.members().iter().collect();
    let at_once = at_once(family, &members)?.min(members.len());
    let seconds = points.iter().map(|point| point.trial.as_ref().map(|trial| trial.run * point.runs as f64));
    let seconds = seconds.sum::<Option<f64>>().map(|seconds| seconds / at_once as f64);
    Ok(if as_json { json(&values(&points, at_once, seconds)) } else { words(&points, at_once, seconds) })
}

fn point<'a>(members: &'a [Member], family: &Family, is_tried: bool) -> anyhow::Result<Checked<'a>> {
    let member = &members[0];
    let work = || {
        let comm = Comm::alone();
        outlined(family.scene(member)?, Asked::present(&comm), is_tried, &comm)
    };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let OutlinedScene { outline, trial, .. } = one.install(work).map_err(|error| anyhow!("{member}: {error:#}"))?;
    if let Some(reason) = outline.refused() {
        bail!("{member}: {reason}");
    }
    Ok(Checked { member, runs: members.len(), outline, trial })
}

fn words(points: &[Checked], at_once: usize, seconds: Option<f64>) -> String {
    let runs: usize = points.iter().map(|point| point.runs).sum();
    let mut text = format!("family     {runs} runs: {} points, {} each\n", points.len(), points[0].runs);
    for Checked { member, outline, trial, .. } in points {
        let values = outline.to_json();
        let particles = values["particles"].as_u64().map(|count| format!("{count} particles"));
        let time = trial.as_ref().map(|trial| format!("about {} a run", run::time_in_words(trial.run)));
        let about = [Some(member.described()), particles, time].into_iter().flatten().filter(|words| !words.is_empty());
        writeln!(text, "{} {}", member.point_name(), about.collect::<Vec<_>>().join(", ")).expect("text grows");
        for warning in values["warnings"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            writeln!(text, "warning: {}: {warning}", member.point_name()).expect("text grows");
        }
    }
    let memory =
        points.iter().filter_map(|point| point.outline.to_json()["memory_bytes"][0].as_f64()).fold(0.0, f64::max);
    writeln!(text, "memory     about {} at most of each run, {at_once} at a time", readable_bytes(memory))
        .expect("text grows");
    match seconds {
        Some(seconds) => {
            writeln!(text, "time       about {} in all, {at_once} runs at a time", run::time_in_words(seconds))
        }
        None => writeln!(text, "time       unknown: not every point was tried"),
    }
    .expect("text grows");
    text
}

fn values(points: &[Checked], at_once: usize, seconds: Option<f64>) -> Value {
    let of_point = |point: &Checked| {
        let mut values = point.outline.to_json();
        values["point"] = point.member.point_name().into();
        values["values"] = point.member.described().into();
        values["runs"] = point.runs.into();
        values["seconds_of_run"] = point.trial.as_ref().map(|trial| trial.run).into();
        values
    };
    let runs: usize = points.iter().map(|point| point.runs).sum();
    json!({
        "kind": "family",
        "runs": runs,
        "runs_at_a_time": at_once,
        "seconds": seconds.map(|seconds| Number(seconds).0),
        "points": points.iter().map(of_point).collect::<Vec<_>>(),
    })
}
