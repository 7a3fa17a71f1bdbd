//! Kinds of hostile input, and the commands that the program is given with each.

mod cases;
mod commands;
mod edited;
mod labels;
mod misfits;
mod placed;
mod results;
mod scenes;
mod starts;
mod strangers;

use crate::bytes;
use crate::case_environment::{CaseEnvironment, Fault};
use crate::tree;
use crate::verdict::ProcessEnd;

/// Makes a case and judges the program's reaction; mistakes of the harness itself are faults, too.
pub type CaseTrial = fn(&mut CaseEnvironment) -> Result<ProcessEnd, Fault>;

/// The kinds, with their shares of all cases.
pub const KINDS: [(&str, usize, CaseTrial); 23] = [
    ("scenes", 10, scenes::keys),
    ("scenes as bytes", 2, scenes::bytes),
    ("--set", 4, scenes::overrides),
    ("cases in JSON", 4, cases::json),
    ("cases in JSON as bytes", 1, cases::json_bytes),
    ("cases in HDF5", 3, cases::hdf5),
    ("cases in HDF5 as bytes", 1, cases::hdf5_bytes),
    ("checkpoints as bytes", 1, results::checkpoint_bytes),
    ("checkpoints with a checksum that fits", 3, results::checkpoint_numbers),
    ("results in HDF5", 3, results::hdf5),
    ("results as bytes", 2, results::bytes),
    ("folders of results", 1, results::folders),
    ("particles in CSV and XYZ", 3, placed::text),
    ("particles in HDF5", 2, placed::hdf5),
    ("costs of the machine", 1, scenes::costs),
    ("command lines", 3, commands::words),
    ("lists and tables that do not fit", 5, misfits::scenes),
    ("the same in cases", 2, misfits::cases),
    ("shapes of datasets", 2, starts::shapes),
    ("starts in all formats", 3, starts::formats),
    ("names of species", 2, labels::names),
    ("edited scenes of results", 2, edited::scenes),
    ("folders with files of others", 4, strangers::folders),
];

/// Kind of the case with this number.
pub fn kind_of(number: u64) -> usize {
    let all: usize = KINDS.iter().map(|(_, part, _)| part).sum();
    let mut place = (number as usize).wrapping_mul(7) % all;
    KINDS.iter().position(|(_, part, _)| place.checked_sub(*part).map(|rest| place = rest).is_none()).unwrap_or(0)
}

/// Applies random edits to a tree.
fn change_tree(lab: &mut CaseEnvironment, mut tree: toml::Value) -> toml::Value {
    for edit in lab.draw(tree::edits(lab.pool.keys)) {
        tree::apply(&mut tree, &edit);
    }
    tree
}

/// Applies random edits to bytes.
fn change_bytes(lab: &mut CaseEnvironment, good: &[u8]) -> Vec<u8> {
    let mut bytes = good.to_vec();
    for edit in lab.draw(bytes::edits()) {
        bytes::apply(&mut bytes, &edit);
    }
    bytes
}
