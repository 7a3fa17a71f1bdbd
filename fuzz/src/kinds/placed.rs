//! Scenes whose particles come from files.

use super::change_bytes;
use super::scenes::check_and_run;
use crate::case_environment::{CaseEnvironment, Fault};
use crate::pool::{CSV, PLACED, SCENES, XYZ};
use crate::verdict::ProcessEnd;
use crate::{hdf5_file, table};

pub fn text(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let (name, good, separator) = *lab.one_of(&[("start.csv", CSV, ','), ("start.xyz", XYZ, ' ')]);
    let content = if lab.draw(0..4) == 0 {
        change_bytes(lab, good.as_bytes())
    } else {
        let edits = lab.draw(table::edits());
        edits.iter().fold(good.to_owned(), |text, edit| table::apply(&text, separator, edit)).into_bytes()
    };
    lab.write(name, content)?;
    placed(lab, name)
}

pub fn hdf5(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let sources = ["case-0.h5", "positions/trajectory.h5", "suspension/trajectory.h5", "disks/trajectory.h5"];
    let source = *lab.one_of(&sources);
    let path = lab.folder.join("start.h5");
    std::fs::copy(lab.pool.folder.join(source), &path)?;
    let edits = lab.draw(hdf5_file::edits());
    hdf5_file::apply(&path, &edits)?;
    placed(lab, "start.h5")
}

fn placed(lab: &mut CaseEnvironment, name: &str) -> Result<ProcessEnd, Fault> {
    let disks = lab.draw(0..4) == 0;
    let text = if disks {
        let text = SCENES.iter().find(|(name, _)| *name == "disks").map_or("", |(_, text)| text);
        text.replace("area_fraction = 0.4", &format!("path = '{name}'"))
    } else {
        format!("{PLACED}path = '{name}'\n")
    };
    lab.write("scene.toml", text)?;
    check_and_run(lab, &[])
}
