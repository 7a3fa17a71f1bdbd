//! Cases of `mobility`.

use super::{change_bytes, change_tree};
use crate::case_environment::{CaseEnvironment, Fault};
use crate::verdict::ProcessEnd;
use crate::{hdf5_file, tree};
use proptest::prelude::*;

/// Evaluates a case, with the answer on the standard output or in a file.
fn evaluate(lab: &mut CaseEnvironment, case: &str) -> Result<ProcessEnd, Fault> {
    let answer = *lab.one_of(&["", "answer.h5", "answer.json"]);
    let out: &[&str] = if answer.is_empty() { &[] } else { &["--out", answer] };
    let end = lab.run(&[&["mobility", case], out].concat())?;
    if end == ProcessEnd::Answered && !answer.is_empty() {
        lab.is_numbers(&lab.folder.join(answer))?;
    }
    Ok(end)
}

pub fn json(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let tree = changed_case(lab);
    lab.write("case.json", tree::to_json(&tree))?;
    evaluate(lab, "case.json")
}

pub fn json_bytes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = tree::to_json(lab.one_of(&lab.pool.cases));
    let bytes = change_bytes(lab, good.as_bytes());
    lab.write("case.json", bytes)?;
    evaluate(lab, "case.json")
}

pub fn hdf5(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let path = lab.folder.join("case.h5");
    if lab.draw(any::<bool>()) {
        let tree = changed_case(lab);
        hdf5_file::write_tree(&path, &tree)?;
    } else {
        std::fs::copy(good_file(lab), &path)?;
        let edits = lab.draw(hdf5_file::edits());
        hdf5_file::apply(&path, &edits)?;
    }
    evaluate(lab, "case.h5")
}

pub fn hdf5_bytes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let good = std::fs::read(good_file(lab))?;
    let bytes = change_bytes(lab, &good);
    lab.write("case.h5", bytes)?;
    evaluate(lab, "case.h5")
}

fn changed_case(lab: &mut CaseEnvironment) -> toml::Value {
    let good = lab.one_of(&lab.pool.cases).clone();
    change_tree(lab, good)
}

fn good_file(lab: &mut CaseEnvironment) -> std::path::PathBuf {
    let number = lab.draw(0..lab.pool.cases.len());
    lab.pool.folder.join(format!("case-{number}.h5"))
}
