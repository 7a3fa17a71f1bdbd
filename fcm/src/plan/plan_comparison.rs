//! Comparison of plans by their printed descriptions, which runs store.

/// Lines of a description that decide the evaluation, as opposed to expected errors and costs.
const COUNTS: [&str; 4] = ["method", "grid", "support", "iteration"];

/// Whether two descriptions by [`Plan::describe`](crate::Plan::describe) stand for the same way to evaluate, up to
/// the digits printed and whatever the expected errors.
pub fn is_same_plan(one: &str, other: &str) -> bool {
    let (one, other) = (what_counts(one), what_counts(other));
    one.len() == other.len() && one.iter().zip(&other).all(|(a, b)| are_equal(a, b))
}

fn what_counts(plan: &str) -> Vec<&str> {
    let lines = plan.lines().filter(|line| COUNTS.iter().any(|name| line.starts_with(name)));
    lines.flat_map(str::split_whitespace).map(|word| word.trim_end_matches(',')).collect()
}

/// Whether two words are equal, or numbers with a fraction that agree to one unit in the fourth digit.
fn are_equal(one: &str, other: &str) -> bool {
    let number = |word: &str| word.parse::<f64>().ok();
    let are_near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-3 * a.abs().min(b.abs());
    let has_fraction = [one, other].iter().any(|word| word.contains('.'));
    one == other || has_fraction && number(one).zip(number(other)).is_some_and(are_near)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAN: &str = "method     split: common Gaussian of width 1, pairs within 5.15\n\
        grid       14 x 14 x 14 points in f32\nsupport    8 x 6 x 6 points a particle\n\
        tolerance  1.0e-2 asked for, 2.0e-3 expected\niteration  to 2.5e-3 in the stresslets\n";

    #[test]
    fn plans_are_alike_but_for_digits_and_what_is_expected() {
        assert!(is_same_plan(PLAN, PLAN));
        let alike = [("width 1,", "width 1.0000,"), ("5.15", "5.1500"), ("2.0e-3 expected", "2.4e-3 expected")];
        for (now, then) in alike {
            assert!(is_same_plan(PLAN, &PLAN.replace(now, then)), "{then}");
        }
    }

    #[test]
    fn other_ways_are_told_apart() {
        let others =
            [("14 points", "16 points"), ("f32", "f64"), ("5.15", "5.25"), ("2.5e-3", "2.0e-3"), ("8 x", "4 x")];
        for (now, then) in others {
            assert!(!is_same_plan(PLAN, &PLAN.replace(now, then)), "{then}");
        }
        let direct = "direct: every envelope on the grid";
        assert!(!is_same_plan(PLAN, &PLAN.replace("split: common Gaussian of width 1, pairs within 5.15", direct)));
        assert!(!is_same_plan(PLAN, ""));
        let large = PLAN.replace("14", "1400");
        assert!(!is_same_plan(&large, &large.replacen("1400", "1401", 1)));
    }
}
