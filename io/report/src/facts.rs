//! A short description of a run.

use crate::about::About;
use crate::playback::Playback;
use domain::Number;
use files::{Observables, Provenance, TrajectoryReader};
use scene::{Family, Kind};

/// Name and value of a fact.
pub(super) type Fact = (&'static str, String);

/// Trajectory of a run with the frames that are shown, and its time series.
pub(super) struct RunProgress<'a> {
    pub(super) trajectory: Option<(&'a TrajectoryReader, &'a Playback)>,
    pub(super) series: &'a Observables,
}

impl RunProgress<'_> {
    /// The last step with a frame or a row.
    pub(super) fn last_step(&self) -> Option<u64> {
        let of_frames = self.trajectory.and_then(|(recorded, _)| recorded.steps().last().copied());
        of_frames.max(self.series.last_step)
    }
}

/// The kind, particles, box, steps, program and seed of a run.
pub(super) fn facts(about: &About, provenance: &Provenance, course: &RunProgress) -> Vec<Fact> {
    let steps = about.kind().map_or(0, Kind::steps);
    let last = course.last_step().filter(|_| steps > 0);
    let shown = course.trajectory.map(|(_, playback)| playback);
    let has_seed = about.kind().is_some_and(|kind| !matches!(kind, Kind::Continuum(_)));
    let ranks = if provenance.ranks == 1 { "1 rank".to_owned() } else { format!("{} ranks", provenance.ranks) };
    let facts = [
        ("kind", Some(about.kind_name().to_owned())),
        ("runs", about.family().map(runs)),
        ("particles", course.trajectory.map(|(recorded, _)| particles(about, recorded))),
        ("box", shown.and_then(Playback::box_in_words)),
        ("steps", last.map(|last| format!("{last} of {steps}"))),
        ("made by", Some(format!("{} on {ranks}", provenance.program))),
        ("seed", has_seed.then(|| provenance.seed.to_string())),
    ];
    facts.into_iter().filter_map(|(name, fact)| Some((name, fact?))).collect()
}

/// Number of runs of a family.
fn runs(family: &Family) -> String {
    format!("{} at {} points", family.members().len(), family.points().count())
}

/// Number and radii of the particles of each species.
fn particles(about: &About, recorded: &TrajectoryReader) -> String {
    let (species, radii, names) = (recorded.species(), recorded.radii(), about.species());
    let kinds = species.iter().max().map_or(0, |last| last + 1);
    let of_kind = |kind: u32| {
        let of: Vec<f64> = species.iter().zip(radii).filter(|(s, _)| **s == kind).map(|(_, &radius)| radius).collect();
        let name = names.get(kind as usize).cloned().unwrap_or_else(|| format!("species {kind}"));
        (!of.is_empty()).then(|| (format!("{} {name}, {}", of.len(), sizes(&of)), sizes(&of)))
    };
    let what = format!("{} {}", species.len(), about.particles());
    match &(0..kinds).filter_map(of_kind).collect::<Vec<_>>()[..] {
        [(_, sizes)] => format!("{what} of {sizes}"),
        kinds => format!("{what}: {}", kinds.iter().map(|(kind, _)| kind.as_str()).collect::<Vec<_>>().join("; ")),
    }
}

fn sizes(radii: &[f64]) -> String {
    let [least, most] = [f64::min, f64::max].map(|pick| radii.iter().copied().reduce(pick).unwrap_or(0.0));
    if least < most {
        format!("radii {:.4} to {:.4}", Number(least), Number(most))
    } else {
        format!("radius {:.4}", Number(least))
    }
}
