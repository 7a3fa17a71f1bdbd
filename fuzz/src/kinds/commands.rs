//! Command lines.

use crate::case_environment::{CaseEnvironment, Fault};
use crate::hostile;
use crate::pool::{CASES, SCENES};
use crate::verdict::ProcessEnd;
use std::ffi::OsString;
use std::os::unix::ffi::OsStringExt;

/// Valid command lines.
const COMMANDS: [&[&str]; 15] = [
    &["run", "scene.toml", "--out", "out", "--set", "time.steps=1"],
    &["check", "scene.toml", "--set", "box.edges=[9,9,9]"],
    &["resume", "plain", "--steps", "3"],
    &["stats", "plain", "--from", "0", "--to", "1", "--distance", "3", "--diffusive-from", "0.01", "--out", "s"],
    &["mobility", "case.json", "--tolerance", "1e-2", "--out", "answer.h5"],
    &["bench", "--particles", "20", "--repeats", "1", "--tolerance", "1e-2"],
    &["two-sphere", "--ratio", "1.5", "--gap", "0.1", "--json"],
    &["new", "settling"],
    &["info", "plain/trajectory.h5", "--scene"],
    &["completions", "bash"],
    &["report", "plain", "--out", "page.html"],
    &["export", "plain", "--to", "xyz", "--frames", "0:2:1", "--out", "frames.xyz"],
    &["check", "scene.toml", "--json", "--ranks", "2"],
    &["run", "scene.toml", "--force", "--threads", "1"],
    &["--help"],
];

pub fn words(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    lab.write("scene.toml", SCENES[1].1)?;
    lab.write("case.json", CASES[0])?;
    lab.copy_results("plain")?;
    let mut words: Vec<OsString> = lab.one_of(&COMMANDS).iter().map(OsString::from).collect();
    for _ in 0..lab.draw(1..4usize) {
        change_words(lab, &mut words);
    }
    let end = lab.run_os(&words)?;
    let answer = lab.folder.join("answer.h5");
    if answer.is_file() {
        lab.is_numbers(&answer)?;
    }
    Ok(end)
}

fn change_words(lab: &mut CaseEnvironment, words: &mut Vec<OsString>) {
    if words.is_empty() {
        return;
    }
    let flags = [
        "--set",
        "--out",
        "--threads",
        "--tolerance",
        "--steps",
        "--force",
        "--",
        "-h",
        "--version",
        "--grid",
        "--case",
        "--kind",
        "--ratio",
        "--gap",
        "--from",
    ];
    let (at, other) = (lab.draw(0..words.len()), lab.draw(0..words.len()));
    let new = match lab.draw(0..5) {
        0 => lab.draw(hostile::number()).to_string().into(),
        1 => lab.draw(hostile::whole()).to_string().into(),
        2 => lab.draw(hostile::word()).into(),
        3 => OsString::from(*lab.one_of(&flags)),
        _ => OsString::from_vec(vec![b'a', 0xff, 0xfe]),
    };
    match lab.draw(0..5) {
        0 => drop(words.remove(at)),
        1 => words.insert(at, new),
        2 => words.swap(at, other),
        _ => words[at] = new,
    }
}
