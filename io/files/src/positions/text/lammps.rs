//! LAMMPS dumps: frames of sections that begin with `ITEM:`.

use super::columns::{self, ColumnNumbers, Labels, TableLine};
use super::lammps_box;
use super::number::NumberParser;
use crate::positions::{FileBox, StartFile, TakenFrame, frame};
use domain::Vector;
use scene::document::excerpt;
use std::borrow::Cow;

/// Names of coordinates, in order of preference, and whether they are fractions of the box.
const COORDINATES: [([&str; 3], bool); 4] =
    [(["x", "y", "z"], false), (["xu", "yu", "zu"], false), (["xs", "ys", "zs"], true), (["xsu", "ysu", "zsu"], true)];

/// Reads a frame of a dump, by default the last one.
pub(in crate::positions) fn read(text: &str, asked: Option<i64>) -> Result<StartFile, String> {
    let lines: Vec<&str> = text.lines().collect();
    let starts: Vec<usize> = (0..lines.len()).filter(|&line| lines[line].starts_with(TIMESTEP)).collect();
    let number = frame::pick(asked, starts.len())?;
    let end = starts.get(number + 1).copied().unwrap_or(lines.len());
    let mut file = LammpsFrame::of(&lines, starts[number]..end)?.read()?;
    file.frame.number = number;
    file.frame.count = starts.len();
    Ok(file)
}

const TIMESTEP: &str = "ITEM: TIMESTEP";

/// The sections of a frame.
#[derive(Default)]
struct LammpsFrame<'a> {
    step: Option<i64>,
    time: Option<f64>,
    count: Option<usize>,
    cell: Option<FileBox>,
    names: &'a str,
    atoms: &'a [&'a str],
    /// Index of the line after that of the names, from 0.
    first: usize,
}

impl<'a> LammpsFrame<'a> {
    fn of(lines: &'a [&'a str], range: std::ops::Range<usize>) -> Result<Self, String> {
        let mut frame = Self::default();
        let mut line = range.start;
        while line < range.end {
            let item = lines[line];
            let body = (line + 1..range.end).take_while(|&next| !lines[next].starts_with("ITEM:")).count();
            let content = &lines[line + 1..line + 1 + body];
            frame.add(item, content, line + 1)?;
            line += 1 + body;
        }
        Ok(frame)
    }

    fn add(&mut self, item: &'a str, content: &'a [&'a str], first: usize) -> Result<(), String> {
        let value = content.first().map(|line| line.trim()).unwrap_or_default();
        let wrong = || format!("line {first} is {}, after which {} can't be", excerpt(item), excerpt(value));
        if item.starts_with(TIMESTEP) {
            self.step = Some(value.parse().map_err(|_| wrong())?);
        } else if item.starts_with("ITEM: TIME") {
            self.time = Some(value.parse().map_err(|_| wrong())?);
        } else if item.starts_with("ITEM: NUMBER OF ATOMS") {
            self.count = Some(value.parse().map_err(|_| wrong())?);
        } else if let Some(words) = item.strip_prefix("ITEM: BOX BOUNDS") {
            let lines = <&[&str; 3]>::try_from(content).map_err(|_| "its BOX BOUNDS have no three lines")?;
            self.cell = Some(lammps_box::read(words, lines)?);
        } else if let Some(names) = item.strip_prefix("ITEM: ATOMS") {
            (self.names, self.atoms, self.first) = (names, content, first);
        }
        Ok(())
    }

    fn read(self) -> Result<StartFile, String> {
        let names: Vec<String> = self.names.split_whitespace().map(str::to_lowercase).collect();
        let (columns, are_parts) = columns(&names)?;
        let end = self.atoms.iter().rposition(|line| !line.trim().is_empty()).map_or(0, |last| last + 1);
        if self.count.is_some_and(|count| count != end) {
            let count = self.count.unwrap_or_default();
            return Err(format!(
                "its frame has {end} lines of ATOMS, but NUMBER OF ATOMS says {count}; it is not whole"
            ));
        }
        let rows = (0..end).map(|offset| row(self.first + offset + 1, self.atoms[offset], names.len()));
        let mut file = columns.read(rows, NumberParser::with_points())?;
        if are_parts {
            let cell = self.cell.ok_or("it has positions in parts of a box, but no BOX BOUNDS")?;
            let [a, b, c] = cell.vectors;
            let place = |part: Vector| cell.origin + a * part.x + b * part.y + c * part.z;
            file.positions.iter_mut().for_each(|position| *position = place(*position));
        }
        file.cell = self.cell;
        file.frame = TakenFrame { step: self.step, time: self.time, ..TakenFrame::default() };
        Ok(file)
    }
}

/// The columns, and whether positions are fractions of the box.
fn columns(names: &[String]) -> Result<(ColumnNumbers, bool), String> {
    let has = |name: &str| names.iter().any(|n| n == name);
    let found = COORDINATES.into_iter().find(|(coordinates, _)| coordinates.iter().all(|name| has(name)));
    let Some((coordinates, are_parts)) = found else {
        let names = excerpt(&names.join(" "));
        return Err(format!(
            "its ATOMS have the columns {names}, but none of x y z, xu yu zu, xs ys zs or xsu ysu zsu"
        ));
    };
    let mut columns = columns::named(names, coordinates, Labels::NamesOrIndices)?;
    if let Some(column) = names.iter().position(|name| name == "type") {
        columns.species = Some((column, Labels::Types));
    } else if let (None, Some(column)) = (columns.species, names.iter().position(|name| name == "element")) {
        columns.species = Some((column, Labels::Names));
    }
    // Unwrapped positions include their images.
    if coordinates[0].ends_with('u') {
        columns.images = None;
    }
    Ok((columns, are_parts))
}

fn row(line: usize, text: &str, width: usize) -> Result<TableLine<'_>, String> {
    let cells: Vec<Cow<str>> = text.split_whitespace().map(Cow::Borrowed).collect();
    let found = cells.len();
    if found == width {
        Ok(TableLine { line, cells })
    } else {
        Err(format!("line {line} has {found} cells, ATOMS have {width} columns"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dump(step: u32, bounds: &str, atoms: &str) -> String {
        let count = atoms.lines().count() - 1;
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{count}\nITEM: BOX BOUNDS {bounds}\nITEM: ATOMS {atoms}\n"
        )
    }

    const STRAIGHT: &str = "pp pp pp\n-4 4\n0 4\n0 4";

    #[test]
    fn the_last_frame_or_the_one_asked_for_is_read() {
        let text =
            dump(0, STRAIGHT, "id type x y z\n1 1 1 2 3") + &dump(50, STRAIGHT, "id type x y z\n2 1 1 2 3\n1 2 3 2 1");
        let last = read(&text, None).unwrap();
        assert_eq!(last.frame, TakenFrame { number: 1, count: 2, step: Some(50), time: None });
        assert_eq!((last.ids, last.cell.unwrap().origin), (Some(vec![2, 1]), Vector::new(-4.0, 0.0, 0.0)));
        let first = read(&text, Some(0)).unwrap();
        assert_eq!((first.positions, first.frame.step), (vec![Vector::new(1.0, 2.0, 3.0)], Some(0)));
    }

    #[test]
    fn positions_may_be_in_parts_of_the_box_or_not_wrapped() {
        let tilted = "xy xz yz pp pp pp\n0 10 2\n0 4 0\n0 4 0";
        let of = |atoms: &str| read(&dump(0, tilted, atoms), None).unwrap();
        assert_eq!(of("id xs ys zs\n1 0.5 0.5 0.25").positions, [Vector::new(5.0, 2.0, 1.0)]);
        let unwrapped = of("id xu yu zu ix iy iz\n1 12 2 1 1 0 0");
        assert_eq!((unwrapped.positions[0], unwrapped.images), (Vector::new(12.0, 2.0, 1.0), None));
        assert_eq!(of("id x y z ix iy iz\n1 2 2 1 1 0 -1").images, Some(vec![[1, 0, -1]]));
    }

    #[test]
    fn dumps_that_are_not_whole_are_refused() {
        let message = |text: &str| read(text, None).unwrap_err();
        let cut = dump(0, STRAIGHT, "id x y z\n1 1 2 3\n2 1 2 3").replace("2 1 2 3\n", "");
        assert!(message(&cut).contains("has 1 lines of ATOMS, but NUMBER OF ATOMS says 2"));
        assert!(message(&dump(0, STRAIGHT, "id x y z\n1 1 2")).contains("line 10 has 3 cells, ATOMS have 4"));
        assert!(message(&dump(0, STRAIGHT, "id x y\n1 1 2")).contains("columns id x y, but none of x y z"));
        assert!(message("ITEM: TIMESTEP\nsoon\n").contains("line 1 is ITEM: TIMESTEP, after which soon can't be"));
        assert!(message("ITEM: ATOMS id x y z\n1 1 2 3\n").contains("no frame"));
    }
}
