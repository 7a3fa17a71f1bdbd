//! Cells of a line of CSV.

use std::borrow::Cow;

/// Separator of the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    Blanks,
}

impl Separator {
    pub(super) const ALL: [Self; 4] = [Self::Comma, Self::Semicolon, Self::Tab, Self::Blanks];

    fn character(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
            Self::Blanks => ' ',
        }
    }

    /// Cells of a line, without surrounding blanks and quotes.
    pub(super) fn cells(self, line: &str) -> Result<Vec<Cow<'_, str>>, String> {
        if !line.contains('"') {
            let trimmed = |cell| Cow::Borrowed(str::trim(cell));
            return Ok(match self {
                Self::Blanks => line.split_whitespace().map(trimmed).collect(),
                _ => line.split(self.character()).map(trimmed).collect(),
            });
        }
        let (mut cells, mut rest) = (Vec::new(), line);
        loop {
            let (cell, after) = self.first(rest.trim_start_matches(' '))?;
            cells.push(cell);
            match after {
                Some(after) => rest = after,
                None => return Ok(cells),
            }
        }
    }

    /// The first cell, and the rest after the separator.
    fn first(self, line: &str) -> Result<(Cow<'_, str>, Option<&str>), String> {
        let Some(quoted) = line.strip_prefix('"') else {
            return Ok(match line.split_once(self.character()) {
                Some((cell, after)) => (Cow::Borrowed(cell.trim()), Some(after)),
                None => (Cow::Borrowed(line.trim()), None),
            });
        };
        let mut cell = String::new();
        let mut rest = quoted;
        loop {
            let (part, after) = rest.split_once('"').ok_or("a quote that does not end")?;
            cell += part;
            if let Some(further) = after.strip_prefix('"') {
                cell.push('"');
                rest = further;
                continue;
            }
            let after = after.trim_start_matches(' ');
            let next = after.strip_prefix(self.character());
            let is_end = next.is_some() || after.is_empty() || self == Self::Blanks;
            let after = if is_end { next } else { return Err("something behind a quote".to_owned()) };
            return Ok((Cow::Owned(cell.trim().to_owned()), after));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_hold_cells_together() {
        let cells = |separator: Separator, line| separator.cells(line).map(|cells| cells.join("|"));
        assert_eq!(cells(Separator::Comma, "a, b ,,c"), Ok("a|b||c".to_owned()));
        assert_eq!(cells(Separator::Comma, r#""a,b", "c""d" ,e"#), Ok("a,b|c\"d|e".to_owned()));
        assert_eq!(cells(Separator::Semicolon, r#""1,5";2,5;"""#), Ok("1,5|2,5|".to_owned()));
        assert_eq!(cells(Separator::Tab, "a\t\"b\""), Ok("a|b".to_owned()));
        assert_eq!(cells(Separator::Blanks, "  a   b "), Ok("a|b".to_owned()));
        assert!(cells(Separator::Comma, "\"a,b").is_err() && cells(Separator::Comma, "\"a\"b,c").is_err());
    }
}
