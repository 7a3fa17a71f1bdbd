//! Starts from files of all formats: the spheres have the positions in the file, or the file is refused.

use crate::case_environment::{CaseEnvironment, Fault};
use crate::pool::PLACED;
use crate::start::{PositionsShape, any_start};
use crate::verdict::ProcessEnd;

const RUN: [&str; 6] = ["run", "scene.toml", "--out", "out", "--set", "output.trajectory_every=1"];

pub fn formats(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let start = lab.draw(any_start());
    let name = *lab.one_of(&["start.csv", "start.xyz", "start.dump", "start.h5md"]);
    match name {
        "start.csv" => lab.write(name, start.csv())?,
        "start.xyz" => lab.write(name, start.xyz())?,
        "start.dump" => lab.write(name, start.dump())?,
        _ => start.h5md(&lab.folder.join(name))?,
    }
    lab.write("scene.toml", format!("{PLACED}path = '{name}'\n"))?;
    if start.other_box && name != "start.csv" {
        return lab.run_refused(&RUN, name);
    }
    taken(lab, &start)
}

pub fn shapes(lab: &mut CaseEnvironment) -> Result<ProcessEnd, Fault> {
    let start = lab.draw(any_start());
    let shapes = [
        PositionsShape::Rows,
        PositionsShape::Columns,
        PositionsShape::Four,
        PositionsShape::Two,
        PositionsShape::Flat,
        PositionsShape::Deep,
    ];
    let shape = *lab.one_of(&shapes);
    start.datasets(&lab.folder.join("start.h5"), shape)?;
    lab.write("scene.toml", format!("{PLACED}path = 'start.h5'\n"))?;
    if shape == PositionsShape::Rows {
        return taken(lab, &start);
    }
    lab.run_refused(&RUN, "positions")
}

/// Requires that an unambiguous file is accepted.
fn taken(lab: &CaseEnvironment, start: &crate::start::WrittenSpheres) -> Result<ProcessEnd, Fault> {
    match lab.run(&RUN)? {
        ProcessEnd::Answered => {}
        ProcessEnd::Refused => return Err(lab.fault_of(&RUN, "it refused a file without a doubt")),
        ProcessEnd::Stopped => return Ok(ProcessEnd::Stopped),
    }
    let wrong = start.differs(&lab.folder.join("out/trajectory.h5"))?;
    wrong.map_or(Ok(ProcessEnd::Answered), |what| Err(lab.fault_of(&RUN, &what)))
}
