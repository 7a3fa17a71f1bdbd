//! Check that an error message names its subject.

/// Names that an error message may refer to.
#[derive(Debug, Default, Clone)]
pub struct Names {
    /// Files and folders of a case, and words of its command line, which may be names of files.
    pub files: Vec<String>,
    /// Keys and sections of scenes and cases.
    pub keys: Vec<String>,
}

impl Names {
    /// Whether a message names a file, a key or an option. English words do not count, even if a key has the same
    /// name: a key has its section before it, or is in quotes or brackets, or is the subject of a clause.
    pub fn are_in(&self, message: &str) -> bool {
        message.split_whitespace().any(|word| self.has_key(word) || is_option(word))
            || message.split(": ").any(|clause| self.is_about_key(clause))
            || self.files.iter().any(|file| names_file(message, file))
    }

    fn is_key(&self, word: &str) -> bool {
        self.keys.iter().any(|key| key == word)
    }

    /// Whether a word is a key: `particles.area_fraction`, `species[0].radius`, `[[species]]`,
    /// `"radii"`, or with an underscore.
    fn has_key(&self, word: &str) -> bool {
        let word = word.trim_end_matches([',', '.', ':', ';', ')']).trim_start_matches('(');
        let bare = word.trim_matches(['`', '"', '\'', '[', ']']);
        let is_set_off = bare.len() < word.len() && !word.ends_with(|c: char| c.is_alphanumeric());
        let parts: Vec<String> = word.split('.').map(without_items).collect();
        let is_path = parts.len() > 1 && parts.iter().all(|part| self.is_key(part));
        is_path
            || self.is_key(bare) && (is_set_off || bare.contains('_'))
            || self.is_key(&parts[0]) && word.contains('[')
    }

    /// Whether a clause is about a key, like `radii has 3 numbers`.
    fn is_about_key(&self, clause: &str) -> bool {
        let mut words = clause.split_whitespace();
        let (first, second) = (words.next().unwrap_or_default(), words.next().unwrap_or_default());
        self.is_key(&without_items(first)) && ["is", "has", "needs", "are"].contains(&second)
    }
}

/// A part of a key without the index of an item: `species` of `species[0]`.
fn without_items(part: &str) -> String {
    part.split('[').next().unwrap_or_default().trim_matches(['`', '"', '\'']).to_owned()
}

/// Whether a word is an option like `--steps`, in quotes or not, with a value or not.
pub fn is_option(word: &str) -> bool {
    let name = word.trim_start_matches(['`', '"', '\'', '(']).strip_prefix("--");
    name.is_some_and(|name| name.starts_with(|c: char| c.is_ascii_lowercase()))
}

/// Whether a message names a file. A name with a dot or a slash counts wherever it is a separate word; any other name
/// could be an English word, and must be in quotes, or the subject of a clause.
fn names_file(message: &str, name: &str) -> bool {
    let name = name.chars().map(|c| if c.is_control() { c.escape_default().to_string() } else { c.to_string() });
    let name: String = name.collect();
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
    message.match_indices(name.as_str()).any(|(at, _)| {
        let (before, after) = (message[..at].chars().next_back(), message[at + name.len()..].chars().next());
        let stands_alone = !before.is_some_and(is_part) && !after.is_some_and(is_part);
        let is_quoted = before == after && before.is_some_and(|c| "`\"'".contains(c));
        let is_plain = !name.contains(['.', '/']);
        stands_alone && (!is_plain || is_quoted || after.is_some_and(|c| ":/".contains(c)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(message: &str) -> bool {
        let list = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        Names {
            files: list(&["scene.toml", "out", "a", "x\ny"]),
            keys: list(&["box", "edges", "species", "radius", "area_fraction", "time", "step"]),
        }
        .are_in(message)
    }

    #[test]
    fn keys_and_files_are_found() {
        for message in [
            "error: scene.toml:3: it is bad",
            "error: can't read out: No such file",
            "error: can't read /tmp/out/b: No such file",
            "error: can't read a: No such file",
            "error: can't read x\\ny: No such file",
            "error: box.edges[1] is -1",
            "error: species[0].radius is -1",
            "error: can't place the spheres of [[species]] at random",
            "error: [box] is missing",
            "error: unknown field `radius`, expected one of",
            "error: area_fraction is too large",
            "error: the case: radius is -1",
            "error: take fewer --particles",
        ] {
            assert!(names(message), "{message}");
        }
    }

    #[test]
    fn english_words_are_no_names() {
        for message in [
            "error: it is bad",
            "error: this time the box of a step went out",
            "error: two spheres overlap",
            "error: myscene.tomls are bad",
            "error: the box is bad",
            "error: a -- b",
            "error: edges",
        ] {
            assert!(!names(message), "{message}");
        }
    }
}
