//! Names of results in the folder of a run.

use std::path::Path;

/// Scene of the run.
pub const SCENE: &str = "scene.toml";

/// Files that commands write to the folder of a run, apart from checkpoints.
const FILES: [&str; 23] = [
    SCENE,
    "report.html",
    "trajectory.h5",
    "trajectory.xyz",
    "trajectory.gsd",
    "trajectory.pvd",
    "observables.h5",
    "observables.csv",
    "fields.xdmf",
    "contacts.csv",
    "force-chains.pvd",
    "averages.h5",
    "averages.csv",
    "profile.csv",
    "walls.csv",
    "map.csv",
    "totals.csv",
    "solution.h5",
    "summary.csv",
    "sweep.h5",
    "branches.csv",
    "family.csv",
    "family.h5",
];

/// Folders in it, with the beginnings and endings of the names of their files, which have the digits of a
/// step or a number in between.
const FOLDERS: [(&str, &str, &str); 7] = [
    ("fields", "velocity-", ".h5"),
    ("contacts", "contacts-", ".h5"),
    (CASES, "", ".csv"),
    ("trajectory", "", ".vtp"),
    ("force-chains", "", ".vtp"),
    ("statistics", "", ""),
    ("stats", "", ""),
];

/// Folder of the runs of a sweep, which also holds the scene of these runs.
const CASES: &str = "cases";

/// Files in `statistics` and `stats`.
const STATISTICS: [&str; 10] = [
    "statistics.h5",
    "summary.csv",
    "velocity_density.csv",
    "angular_velocity_density.csv",
    "lags.csv",
    "pairs.csv",
    "pairs_by_angle.csv",
    "concentration.csv",
    "profile.csv",
    "harmonics.csv",
];

/// Whether a file or a folder in the folder of a run has a name of results.
pub(super) fn is_of_results(name: &str) -> bool {
    let is_point = has_number(name, "point-", "");
    FILES.contains(&name) || FOLDERS.iter().any(|(folder, ..)| *folder == name) || is_checkpoint(name) || is_point
}

/// Whether a file in a folder of results has a name of results.
pub(super) fn is_of_results_in(folder: &str, name: &str) -> bool {
    if folder == CASES && name == SCENE {
        return true;
    }
    let Some((_, start, end)) = FOLDERS.iter().find(|(known, ..)| *known == folder) else { return false };
    if end.is_empty() { STATISTICS.contains(&name) } else { has_number(name, start, end) }
}

/// Whether a name is that of a checkpoint.
pub(crate) fn is_checkpoint(name: &str) -> bool {
    has_number(name, "checkpoint-", ".bin")
}

/// Whether a path is that of a field, a contact file, or another file with digits in its name in a results folder.
pub(crate) fn is_numbered(path: &Path, start: &str, end: &str) -> bool {
    path.file_name().and_then(|name| name.to_str()).is_some_and(|name| has_number(name, start, end))
}

fn has_number(name: &str, start: &str, end: &str) -> bool {
    let number = name.strip_prefix(start).and_then(|rest| rest.strip_suffix(end));
    number.is_some_and(|digits| !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_results_are_told_from_others() {
        for name in ["scene.toml", "fields", "checkpoint-0000000012.bin", "stats", "report.html", "cases", "point-0001"]
        {
            assert!(is_of_results(name), "{name}");
        }
        for name in ["notes.txt", "checkpoint-best.bin", "checkpoint-.bin", "my-fields", "scene.toml.bak"] {
            assert!(!is_of_results(name), "{name}");
        }
        let inside = [
            ("fields", "velocity-0000000001.h5"),
            ("cases", "0000.csv"),
            ("cases", "scene.toml"),
            ("stats", "lags.csv"),
        ];
        assert!(inside.into_iter().all(|(folder, name)| is_of_results_in(folder, name)));
        let others = [("fields", "wheat.txt"), ("cases", "pair.json"), ("stats", "mine.csv"), ("notes", "0000.csv")];
        assert!(!others.into_iter().any(|(folder, name)| is_of_results_in(folder, name)));
    }
}
