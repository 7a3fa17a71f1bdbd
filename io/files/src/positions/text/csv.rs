//! Tables of values under a line of names.

use super::columns::{self, ColumnNumbers, Labels, TableLine};
use super::csv_cells::Separator;
use super::number::NumberParser;
use crate::positions::{StartFile, TakenFrame, frame};
use scene::document::excerpt;

/// Reads values under a line of names; lines that start with # are skipped. Cells are separated by commas,
/// semicolons, tabs or blanks: by whichever makes x, y and z columns.
pub(in crate::positions) fn read(text: &str, asked: Option<i64>) -> Result<StartFile, String> {
    frame::pick(asked, 1)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let (_, first) = lines.next().ok_or("it is empty")?;
    let header = NameLine::of(first)?;
    let numbers = match header.separator {
        Separator::Comma => NumberParser::with_points(),
        _ => NumberParser::with_either(),
    };
    let mut file = header.columns.read(lines.map(|(number, line)| header.row(number + 1, line)), numbers)?;
    file.frame = TakenFrame { count: 1, ..TakenFrame::default() };
    Ok(file)
}

/// The line of names.
struct NameLine {
    separator: Separator,
    columns: ColumnNumbers,
    names: Vec<String>,
}

impl NameLine {
    fn of(line: &str) -> Result<Self, String> {
        let split = |separator: Separator| {
            let cells = separator.cells(line).ok()?;
            let names: Vec<String> = cells.iter().map(|cell| cell.to_lowercase()).collect();
            ["x", "y", "z"].iter().all(|&name| names.iter().any(|n| n == name)).then_some((separator, names))
        };
        let Some((separator, names)) = Separator::ALL.into_iter().find_map(split) else {
            return Err(format!(
                "it has no columns x, y, z: its first line is {}; names of columns belong there, separated by commas, \
                 semicolons or tabs",
                excerpt(line)
            ));
        };
        let columns = columns::named(&names, ["x", "y", "z"], Labels::NamesOrIndices)?;
        Ok(Self { separator, columns, names })
    }

    /// Cells of a line, one for each name.
    fn row<'a>(&self, line: usize, text: &'a str) -> Result<TableLine<'a>, String> {
        let cells = self.separator.cells(text).map_err(|what| format!("line {line} has {what}"))?;
        let (found, needed) = (cells.len(), self.names.len());
        if found == needed {
            return Ok(TableLine { line, cells });
        }
        let advice = match self.separator {
            Separator::Comma if found > needed => "; where decimals have commas, separate cells by semicolons",
            _ => "",
        };
        let names = excerpt(&self.names.join(", "));
        Err(format!("line {line} has {found} cells, the header has {needed} ({names}){advice}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;

    fn places(text: &str) -> Result<Vec<Vector>, String> {
        read(text, None).map(|file| file.positions)
    }

    #[test]
    fn tables_of_spreadsheets_are_read() {
        let expected = vec![Vector::new(1.5, 2.0, 3.0), Vector::new(4.0, 5.25, 6.0)];
        for text in [
            "x,y,z\n1.5,2,3\n4,5.25,6\n",
            "X;Y;Z\n1,5;2,0;3\n4;5,25;6\n",
            "\"X\";\"Y\";\"Z\"\n\"1,5\";2;3\n4;\"5,25\";6\n",
            "x\ty\tz\n1,5\t2\t3\n4\t5,25\t6\n",
            "x;y;z\n1.5;2.0;3\n4;5.25;6\n",
            "\n# by hand\n x , y , z \n1.5 , 2 , 3\n\n4,5.25,6",
            "x y  z\n1.5 2 3\n4  5.25 6\n",
            "\"name\",\"x\",\"y\",\"z\"\n\"a, b\",\"1.5\",2,3\n\"c\",4,5.25,6\n",
        ] {
            assert_eq!(places(text), Ok(expected.clone()), "{text}");
        }
    }

    #[test]
    fn rows_of_another_length_are_refused() {
        let message = places("x,y,z\n1,5,2,0,3,1\n6,0,2,0,3,1\n").unwrap_err();
        assert!(
            message.contains("line 2 has 6 cells, the header has 3 (x, y, z); where decimals have commas"),
            "{message}"
        );
        assert!(places("x,y,z\n1,2,3\n1,2,3,4\n").unwrap_err().contains("line 3 has 4 cells"));
        assert!(places("x,y,z\n1,2,3,\n").unwrap_err().contains("line 2 has 4 cells"));
        assert!(places("x;y;z\n1;2\n").unwrap_err().contains("line 2 has 2 cells, the header has 3"));
        assert!(places("x,y,z\n1;2;3\n").unwrap_err().contains("line 2 has 1 cells"));
    }

    #[test]
    fn doubtful_numbers_are_refused() {
        assert!(places("x,y,z\n\"1,5\",2,3\n").unwrap_err().contains("line 2 has 1,5 where a number"));
        assert!(places("x;y;z\n1,5;2.5;3\n").unwrap_err().contains("another decimal mark"));
        assert!(places("x;y;z\n1.234,5;2;3\n").unwrap_err().contains("line 2 has 1.234,5"));
        assert!(places("x;y;z\n1;;3\n").unwrap_err().contains("line 2 has "));
    }

    #[test]
    fn names_are_needed() {
        assert!(
            places("1,2,3\n4,5,6\n").unwrap_err().contains("its first line is 1,2,3; names of columns belong there")
        );
        assert!(places("x,y\n1,2\n").unwrap_err().contains("no columns x, y, z"));
        assert!(places("x,y,z,X\n1,2,3,4\n").unwrap_err().contains("two columns x"));
        assert!(places("").unwrap_err().contains("it is empty"));
        assert!(read("x,y,z\n1,2,3\n", Some(1)).unwrap_err().contains("has one frame"));
    }
}
