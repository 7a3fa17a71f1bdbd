//! Names of species, which appear in tables.

use crate::case_environment::{CaseEnvironment, Fault, files};
use crate::pool::SCENES;
use crate::verdict::{ProcessEnd, of_cells};
use proptest::prelude::*;
use proptest::sample::select;

/// Names that tables can hold if they are quoted, and names that no table should have.
const NAMES: [&str; 26] = [
    "a",
    "a,b",
    "a;b",
    "a\"b",
    "\"a\"",
    "'a'",
    "a[b]",
    "Ж",
    "a b",
    "#a",
    "1",
    "nan",
    "x,\"y\",z",
    "",
    " ",
    "all",
    "ALL",
    "a\nb",
    "a\rb",
    "a\tb",
    "a\u{7f}b",
    "=cmd|' /C calc'!A0",
    "+1",
    "-1",
    "@sum",
    " a",
];

/// Whether a name must not appear in tables.
fn is_forbidden(name: &str) -> bool {
    name.trim().is_empty()
        || ["all", "nan", "null", "none", "inf", "infinity"].iter().any(|word| name.eq_ignore_ascii_case(word))
        || ["NA", "N/A", "n/a"].contains(&name)
        || name.chars().any(char::is_control)
        || name.starts_with(['=', '+', '-', '@'])
}

pub fn names(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let name =
        lab.draw(prop_oneof![3 => select(&NAMES[..]).prop_map(str::to_owned), 1 => "\\PC{1,6}|[a-c,;\"\\s=]{1,6}"]);
    let mut tree: toml::Value = toml::from_str(SCENES[3].1)?;
    if let Some(species) = tree["species"].as_array_mut() {
        species[0]["name"] = name.clone().into();
    }
    lab.write("scene.toml", toml::to_string(&tree)?)?;
    let run = ["run", "scene.toml", "--out", "out", "--set", "time.steps=1"];
    if is_forbidden(&name) {
        lab.run_refused(&["check", "scene.toml"], "name")?;
        return lab.run_refused(&run, "name");
    }
    let end = lab.run(&run)?;
    if end == ProcessEnd::Answered {
        for path in files(&lab.folder.join("out")).iter().filter(|path| path.extension().is_some_and(|e| e == "csv")) {
            of_cells(&std::fs::read_to_string(path)?, &name).map_err(|what| lab.fault_of(&run, &what))?;
        }
        lab.run(&["report", "out"])?;
    }
    Ok(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_without_a_meaning_are_forbidden() {
        let forbidden: Vec<&&str> = NAMES.iter().filter(|name| is_forbidden(name)).collect();
        assert_eq!(forbidden.len(), 13, "{forbidden:?}");
        assert!(!is_forbidden("a,b") && !is_forbidden("allow") && !is_forbidden("Na"));
    }
}
