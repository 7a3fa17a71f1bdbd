//! Command lines suggested to the user.

use std::path::Path;

/// Command line that continues the run in a folder.
pub fn resume_command(folder: &Path, steps: Option<u64>) -> String {
    let folder = quoted(&folder.display().to_string());
    let steps = steps.map_or_else(String::new, |steps| format!(" --steps {steps}"));
    format!("fcm-solve resume {folder}{steps}")
}

/// A word quoted for a shell where it needs quotes.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_./=+-:,@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        assert_eq!(quoted("results/my-run_1.toml"), "results/my-run_1.toml");
        assert_eq!(quoted("species[0].count=3"), "'species[0].count=3'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
