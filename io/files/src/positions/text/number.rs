//! Numbers in cells of text.

use scene::document::excerpt;

/// Parser of numbers with a common decimal mark: a point, or a comma where commas do not separate cells.
pub(super) struct NumberParser {
    may_be_comma: bool,
    mark: Option<char>,
}

impl NumberParser {
    /// Numbers with decimal points.
    pub(super) fn with_points() -> Self {
        Self { may_be_comma: false, mark: None }
    }

    /// Numbers with decimal points or decimal commas.
    pub(super) fn with_either() -> Self {
        Self { may_be_comma: true, mark: None }
    }

    /// The number in a cell of a line.
    pub(super) fn parse(&mut self, line: usize, cell: &str) -> Result<f64, String> {
        let wrong = || format!("line {line} has {} where a number should be", excerpt(cell));
        let commas = cell.matches(',').count();
        if commas == 0 {
            if cell.contains('.') {
                self.note('.', line)?;
            }
            return cell.parse().map_err(|_| wrong());
        }
        if commas > 1 || cell.contains('.') || !self.may_be_comma {
            return Err(wrong() + ": a comma may be a decimal mark only where semicolons or tabs separate cells");
        }
        self.note(',', line)?;
        cell.replace(',', ".").parse().map_err(|_| wrong())
    }

    fn note(&mut self, mark: char, line: usize) -> Result<(), String> {
        if *self.mark.get_or_insert(mark) == mark {
            return Ok(());
        }
        Err(format!(
            "line {line} has another decimal mark than lines before; write all with points, or all with commas"
        ))
    }
}

/// A non-negative whole number in a table, perhaps written as 1.0.
pub(super) fn whole(number: f64) -> Option<u32> {
    let found = number as u32;
    (f64::from(found).total_cmp(&number).is_eq() || number == 0.0).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_marks_are_all_alike() {
        let mut numbers = NumberParser::with_either();
        assert_eq!(numbers.parse(1, "3"), Ok(3.0));
        assert_eq!(numbers.parse(1, "1,5"), Ok(1.5));
        assert_eq!(numbers.parse(1, "-1,5e-3"), Ok(-1.5e-3));
        assert!(numbers.parse(2, "1.5").unwrap_err().contains("line 2 has another decimal mark"));
        for cell in ["1,000,000", "1.000,5", "a,b", ""] {
            assert!(NumberParser::with_either().parse(4, cell).unwrap_err().contains("line 4"), "{cell}");
        }
        assert!(NumberParser::with_points().parse(4, "1,5").unwrap_err().contains("decimal mark only where"));
        assert_eq!([0.0, -0.0, 2.0, 2.5, -1.0, f64::NAN].map(whole), [Some(0), Some(0), Some(2), None, None, None]);
    }
}
