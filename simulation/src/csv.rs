//! Cells of comma-separated values.

/// Characters that require quotes: separators in any locale, quotes and line ends.
const QUOTED: [char; 6] = [',', ';', '\t', '"', '\n', '\r'];

/// A word as a cell, in quotes if it could be mistaken for several cells.
pub fn csv_cell(word: &str) -> String {
    if word.contains(QUOTED) { format!("\"{}\"", word.replace('"', "\"\"")) } else { word.to_owned() }
}

/// Words as a line of cells, without the line end.
pub fn csv_line<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().map(csv_cell).collect::<Vec<_>>().join(",")
}

/// Words in a line of cells.
pub fn csv_words(line: &str) -> Vec<String> {
    let (mut words, mut in_quotes) = (vec![String::new()], false);
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '"' if in_quotes && characters.next_if_eq(&'"').is_some() => append(&mut words, '"'),
            '"' => in_quotes = !in_quotes,
            ',' if !in_quotes => words.push(String::new()),
            other => append(&mut words, other),
        }
    }
    words
}

fn append(words: &mut [String], character: char) {
    words.last_mut().expect("there is one from the beginning").push(character);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_come_back() {
        let words = ["plain", "silica, 2 um", "\"round\"", "a;b", "", "x\"y,z"];
        let line = csv_line(words);
        assert_eq!(line, "plain,\"silica, 2 um\",\"\"\"round\"\"\",\"a;b\",,\"x\"\"y,z\"");
        assert_eq!(csv_words(&line), words);
        assert_eq!(csv_words("a,b,,c"), ["a", "b", "", "c"]);
    }
}
