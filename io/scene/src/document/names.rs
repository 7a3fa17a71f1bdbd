//! Suggestion of the nearest known name.

use strsim::osa_distance;

/// Largest number of letters of a name that may be a misspelling.
const LONGEST: usize = 60;

/// The one of `known` that `name` probably means: at most a third of its letters are wrong, swapped, missing or extra.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    if name.chars().nth(LONGEST).is_some() {
        return None;
    }
    let name = name.to_lowercase().replace('_', "-");
    let distance = |other: &str| osa_distance(&name, &other.to_lowercase().replace('_', "-"));
    let (best, edits) = known.iter().map(|&k| (k, distance(k))).min_by_key(|&(_, d)| d)?;
    (edits <= 1 + name.chars().count() / 3).then_some(best)
}

/// Advice about a name that is not one of the known ones.
pub fn known(name: &str, known: &[&str]) -> String {
    let all = known.join(", ");
    match nearest(name, known) {
        Some(best) => format!("did you mean \"{best}\"? Known here: {all}"),
        None => format!("known here: {all}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_the_pen_are_understood() {
        let names = ["radius", "count", "volume_fraction", "force"];
        assert_eq!(nearest("raduis", &names), Some("radius"));
        assert_eq!(nearest("volume-fraction", &names), Some("volume_fraction"));
        assert_eq!(nearest("colour", &names), None);
        assert_eq!([osa_distance("kitten", "sitting"), osa_distance("ab", "ba"), osa_distance("", "abc")], [3, 1, 3]);
    }
}
