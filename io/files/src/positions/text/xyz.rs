//! Plain and extended XYZ: for each frame the number of particles, a line of keys, and one line per particle.

use super::columns::TableLine;
use super::number::NumberParser;
use super::xyz_header::{Properties, XyzHeader};
use crate::positions::{StartFile, TakenFrame, frame};
use scene::document::excerpt;
use std::borrow::Cow;

/// Reads a frame of a file, by default the last one.
pub(in crate::positions) fn read(text: &str, asked: Option<i64>) -> Result<StartFile, String> {
    let lines: Vec<&str> = text.lines().collect();
    let frames = frames(&lines)?;
    let number = frame::pick(asked, frames.len())?;
    let XyzFrame { first, count } = frames[number];
    let header = XyzHeader::of(lines[first + 1])?;
    let Properties { columns, width } = header.properties()?;
    let row = |offset: usize| row(first + 2 + offset + 1, lines[first + 2 + offset], width);
    let mut file = columns.read((0..count).map(row), NumberParser::with_points())?;
    file.cell = header.cell()?;
    let (step, time) = (header.number(&["step", "timestep", "frame"]), header.number(&["time"]));
    file.frame = TakenFrame { number, count: frames.len(), step, time };
    Ok(file)
}

/// A frame and the line on which it begins.
struct XyzFrame {
    first: usize,
    count: usize,
}

fn frames(lines: &[&str]) -> Result<Vec<XyzFrame>, String> {
    let end = lines.iter().rposition(|line| !line.trim().is_empty()).map_or(0, |last| last + 1);
    let (mut frames, mut first) = (Vec::new(), 0);
    while first < end {
        let count = lines[first].trim().parse::<usize>();
        let count = count.map_err(|_| match first {
            0 => "its first line is not the number of particles".to_owned(),
            _ => format!(
                "line {} is {}; after the particles of a frame the number of those of the next belongs there",
                first + 1,
                excerpt(lines[first])
            ),
        })?;
        // A frame without particles may end with its line of keys.
        let left = lines.len().saturating_sub(first + 2);
        if count > left || first + 1 >= lines.len() {
            return Err(format!("it has {left} particles, its line {} says {count}", first + 1));
        }
        frames.push(XyzFrame { first, count });
        first += count.saturating_add(2);
    }
    Ok(frames)
}

fn row(line: usize, text: &str, width: usize) -> Result<TableLine<'_>, String> {
    let cells: Vec<Cow<str>> = text.split_whitespace().map(Cow::Borrowed).collect();
    if cells.len() == width {
        return Ok(TableLine { line, cells });
    }
    Err(format!(
        "line {line} has {} cells, but the line of keys has Properties of {width}; without these a line has a name, \
         x, y and z",
        cells.len()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;

    const TWO: &str = "1\nTime=0 Step=3\nA 1 2 3\n2\nplain\nA 4 5 6\nB 7 8 9\n\n";

    #[test]
    fn the_last_frame_or_the_one_asked_for_is_read() {
        let last = read(TWO, None).unwrap();
        assert_eq!(last.positions, [Vector::new(4.0, 5.0, 6.0), Vector::new(7.0, 8.0, 9.0)]);
        assert_eq!(last.frame, TakenFrame { number: 1, count: 2, step: None, time: None });
        let first = read(TWO, Some(-2)).unwrap();
        assert_eq!(first.frame, TakenFrame { number: 0, count: 2, step: Some(3), time: Some(0.0) });
        assert!(read(TWO, Some(2)).unwrap_err().contains("has 2 frames"));
    }

    #[test]
    fn lines_that_do_not_fit_are_refused() {
        let message = |text: &str| read(text, None).unwrap_err();
        assert!(message("many\n").contains("not the number of particles"));
        assert!(message("3\n\nA 1 2 3\n").contains("it has 1 particles, its line 1 says 3"));
        assert!(message("1\n\nA 1 2 3\nA 4 5 6\n").contains("line 4 is A 4 5 6"));
        assert!(message("1\n\nA 1 2 3 4\n").contains("line 3 has 5 cells"));
        assert!(message("1\n\nA 1 2\n").contains("line 3 has 3 cells"));
        assert!(message("1\nProperties=pos:R:3\n1 2 3 4\n").contains("line 3 has 4 cells"));
        assert!(message("1\n\nA 1,5 2 3\n").contains("1,5 where a number"));
        assert!(message("18446744073709551615\n\nA 1 2 3\n").contains("says 18446744073709551615"));
        assert!(message("").contains("no frame"));
    }

    #[test]
    fn properties_are_found_by_their_names() {
        let text = "1\nProperties=id:I:1:velo:R:3:pos:R:3:radius:R:1:type:I:1\n7 0 0 0 1 2 3 4 2\n";
        let file = read(text, None).unwrap();
        assert_eq!(
            (file.positions[0], file.radii, file.ids),
            (Vector::new(1.0, 2.0, 3.0), Some(vec![4.0]), Some(vec![7]))
        );
        let message = |properties: &str| read(&format!("1\nProperties={properties}\nA 1 2 3\n"), None).unwrap_err();
        assert!(message("species:S:1").contains("no pos:R:3"));
        assert!(message("species:S:1:pos:R:2:a:R:1").contains("pos with 2 columns; it needs 3"));
        assert!(message("species:S:1:pos").contains("are not name:type:columns"));
        assert!(message("a:S:18446744073709551615:pos:R:3").contains("are not name:type:columns"));
        assert!(message("species:S:1:pos:R:3:pos:R:3").contains("twice"));
    }
}
