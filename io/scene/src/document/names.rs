//! Suggestion of the nearest known name.

/// Largest number of letters of a name that may be a misspelling.
const LONGEST: usize = 60;

/// The one of `known` that `name` probably means: at most a third of its letters are wrong, swapped, missing or extra.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    if name.chars().nth(LONGEST).is_some() {
        return None;
    }
    let name = name.to_lowercase().replace('_', "-");
    let distance = |other: &str| edits(&name, &other.to_lowercase().replace('_', "-"));
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

/// Number of letters to insert, delete, replace or swap with their neighbour (Damerau's distance,
/// each letter touched once).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<_>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut least = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
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
        assert_eq!((edits("kitten", "sitting"), edits("ab", "ba"), edits("", "abc")), (3, 1, 3));
    }
}
