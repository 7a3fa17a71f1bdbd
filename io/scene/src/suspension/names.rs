//! Names of species, which appear in tables of results.

use super::KeyError;
use crate::document::excerpt;

/// Name of the rows about all spheres in tables.
const RESERVED: &str = "all";
/// Names that programs read as a missing value or an infinite number, in any case and in this one.
const MISSING: [&str; 5] = ["nan", "null", "none", "inf", "infinity"];
const NOT_AVAILABLE: [&str; 3] = ["NA", "N/A", "n/a"];
/// Largest number of characters of a name.
const LONGEST: usize = 100;
/// Programs that open tables take a cell that begins with one of these as a formula.
const FORMULAS: [char; 8] = ['=', '+', '-', '@', '\u{ff1d}', '\u{ff0b}', '\u{ff0d}', '\u{ff20}'];

/// Refuses a name of a section, as `species[0]`, that would make a table ambiguous or unreadable.
pub(super) fn check(name: Option<&str>, section: &str) -> Result<(), KeyError> {
    let Some(name) = name else { return Ok(()) };
    let shown = excerpt(name);
    let message = if name.trim().is_empty() {
        format!("is \"{shown}\"; a name needs at least one letter or digit, or leave it out")
    } else if name.trim() != name {
        format!("is \"{shown}\", with a blank at one of its ends; leave that out")
    } else if name.chars().any(is_invisible) {
        format!("is \"{shown}\", with a line break or another character that can't be seen; leave that out")
    } else if name.starts_with(FORMULAS) {
        format!("is \"{shown}\", which is a formula to programs that open tables; begin it with a letter or a digit")
    } else if name.to_lowercase() == RESERVED {
        format!("is \"{shown}\", which tables call all species together; take another one")
    } else if MISSING.contains(&name.to_lowercase().as_str()) || NOT_AVAILABLE.contains(&name) {
        format!("is \"{shown}\", which programs that open tables take for a missing value; take another one")
    } else if name.chars().nth(LONGEST).is_some() {
        format!("is \"{shown}\"; a name has at most {LONGEST} characters")
    } else {
        return Ok(());
    };
    Err(KeyError::new(format!("{section}.name"), message))
}

/// Control characters, line and paragraph separators, direction marks and zero-width joiners.
fn is_invisible(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_break_tables_are_refused() {
        for name in ["", " ", "\t", " a", "a ", "a\nb", "a\tb", "a\u{2028}b", "a\u{202e}b", "\u{feff}a", "all", "All"] {
            assert!(check(Some(name), "species[0]").is_err(), "{name:?}");
        }
        for formula in ["=cmd|'/C calc'!A0", "+1", "-1", "@SUM(1)", "\u{ff1d}1"] {
            assert!(check(Some(formula), "species[0]").is_err(), "{formula:?}");
        }
        for missing in ["nan", "NaN", "NULL", "None", "inf", "NA", "n/a"] {
            assert!(check(Some(missing), "species[0]").is_err(), "{missing:?}");
        }
        assert!(check(Some(&"x".repeat(101)), "species[0]").is_err());
        for name in
            ["Na", "nanotube", "silica, 2 um", "\"round\"", "a;b", "1", "all of it", "Å", "x".repeat(100).as_str()]
        {
            assert!(check(Some(name), "species[0]").is_ok(), "{name:?}");
        }
        assert!(check(None, "species[0]").is_ok());
    }
}
