//! Check that the rows of a table have the cells that its first line names.

/// Refuses a table whose rows have other numbers of cells, or of which no column is named after a species and no row of
/// a column `species` is of it. Cells may be quoted.
pub fn of_cells(text: &str, species: &str) -> Result<(), String> {
    let rows: Vec<Vec<String>> = rows(text);
    let Some(names) = rows.first() else { return Ok(()) };
    let (is_named, kind) = match names.iter().position(|name| name == "species") {
        Some(column) => (rows.iter().skip(1).any(|row| row.get(column).is_some_and(|of| of == species)), "row is of"),
        None => (names.iter().any(|name| name.contains(&format!("[{species}]"))), "column is named after"),
    };
    if !is_named {
        return Err(format!("no {kind} the species {species:?}: {}", names.join(" | ")));
    }
    let other = rows.iter().position(|row| row.len() != names.len());
    other.map_or(Ok(()), |row| Err(format!("row {row} has {} cells for {} names", rows[row].len(), names.len())))
}

/// The cells of each row of a table that is not a comment, without their quotes.
pub fn rows(text: &str) -> Vec<Vec<String>> {
    let (mut rows, mut row, mut cell, mut is_quoted) = (Vec::new(), Vec::new(), String::new(), false);
    let mut characters =
        text.lines().filter(|line| !line.starts_with('#')).flat_map(|line| line.chars().chain(['\n'])).peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' if is_quoted && characters.peek() == Some(&'"') => cell.extend(characters.next()),
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => row.push(std::mem::take(&mut cell)),
            '\n' if !is_quoted => {
                row.push(std::mem::take(&mut cell));
                rows.push(std::mem::take(&mut row));
            }
            other => cell.push(other),
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_names_keep_their_commas() {
        assert_eq!(of_cells("time,\"v[a,b]\"\n0,1\n", "a,b"), Ok(()));
        assert_eq!(of_cells("time,\"v[a\"\"b]\"\n0,1\n", "a\"b"), Ok(()));
        assert_eq!(of_cells("quantity,species\nv,\"a,b\"\n", "a,b"), Ok(()));
    }

    #[test]
    fn broken_tables_are_found() {
        assert!(of_cells("time,v[a,b]\n0,1\n", "a,b").unwrap_err().contains("no column"));
        assert!(of_cells("time,v[a]\n0,1,2\n", "a").unwrap_err().contains("row 1 has 3 cells for 2 names"));
        assert!(of_cells("time,v[b]\n0,1\n", "a").is_err());
        assert!(of_cells("quantity,species\nv,b\n", "a").unwrap_err().contains("no row is of"));
    }
}
