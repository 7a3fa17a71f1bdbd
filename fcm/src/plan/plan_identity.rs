//! Identity of plans: the values that decide how an evaluation is made, compared when a run goes on.

use crate::plan::Plan;
use crate::plan::method::{Method, Split};
use crate::plan::problem::Precision;
use domain::AxisRotation;

/// Values of a plan that decide the results of an evaluation, as opposed to expected errors and costs. The device
/// is not one: results differ by round-off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanIdentity {
    method: Method,
    split: Option<Split>,
    /// `None` with the dense method.
    grid: Option<GridIdentity>,
    /// Rounded to the digits that a description has.
    iteration_tolerance: f64,
}

/// Points of the grid and of stencils along the user's axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct GridIdentity {
    points: [usize; 3],
    support: [usize; 3],
    precision: Precision,
}

/// Relative difference of lengths that are equal: descriptions have five digits.
const DIGITS: f64 = 1e-3;

impl PlanIdentity {
    /// Identity of a plan in the user's axes, which `axes` maps to those of the box.
    pub fn of(plan: &Plan, axes: AxisRotation) -> Self {
        let grid = GridIdentity {
            points: axes.inverse().list(plan.grid),
            support: axes.inverse().list(plan.support.along_axes()),
            precision: plan.precision,
        };
        let rounded = format!("{:.1e}", plan.iteration_tolerance).parse();
        Self {
            method: plan.method,
            split: plan.split,
            grid: plan.has_grid().then_some(grid),
            iteration_tolerance: rounded.unwrap_or(plan.iteration_tolerance),
        }
    }

    /// Identity of the plan with a description by [`Plan::describe_for`], which is what files keep of it; `None` if
    /// that is no description.
    pub fn read(description: &str) -> Option<Self> {
        let line = |name: &str| description.lines().find_map(|line| line.strip_prefix(name).map(str::trim));
        let (name, parameters) = line("method")?.split_once(':')?;
        let method = Method::ALL.into_iter().find(|m| m.name() == name)?;
        let split = match method {
            Method::Split => {
                let [width, cutoff] = numbers(parameters).try_into().ok()?;
                Some(Split { width, cutoff })
            }
            _ => None,
        };
        let grid = match method {
            _ if method.gridless().is_some() => None,
            _ => Some(GridIdentity {
                points: counts(line("grid")?)?,
                support: counts(line("support")?)?,
                precision: if line("grid")?.ends_with("f32") { Precision::Single } else { Precision::Double },
            }),
        };
        let [iteration_tolerance] = numbers(line("iteration")?).try_into().ok()?;
        Some(Self { method, split, grid, iteration_tolerance })
    }

    /// Whether two plans evaluate in the same way, up to the digits of a description.
    pub fn is_same(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= DIGITS * a.abs().min(b.abs());
        let is_same_split = match (self.split, other.split) {
            (Some(one), Some(other)) => near(one.width, other.width) && near(one.cutoff, other.cutoff),
            (one, other) => one.is_none() && other.is_none(),
        };
        (self.method, self.grid) == (other.method, other.grid)
            && is_same_split
            && near(self.iteration_tolerance, other.iteration_tolerance)
    }
}

/// Words of a line that are numbers.
fn numbers(line: &str) -> Vec<f64> {
    line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

/// Three counts at the start of a line.
fn counts(line: &str) -> Option<[usize; 3]> {
    let counts: Vec<usize> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
    counts.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::problem::{Fixed, Problem};

    const PLAN: &str = "method     split: common Gaussian of width 1, pairs within 5.15\n\
        grid       14 x 14 x 14 points in f32\nsupport    8 x 6 x 6 points a particle\n\
        tolerance  1.0e-2 asked for, 2.0e-3 expected\niteration  to 2.5e-3 in the stresslets\n";

    fn is_same(one: &str, other: &str) -> bool {
        let [one, other] = [one, other].map(|text| PlanIdentity::read(text).unwrap());
        one.is_same(&other)
    }

    #[test]
    fn plans_are_alike_but_for_digits_and_what_is_expected() {
        assert!(is_same(PLAN, PLAN));
        let on_card = ("tolerance  1.0e-2", "device     gpu\ntolerance  1.0e-2");
        let alike =
            [on_card, ("width 1,", "width 1.0000,"), ("5.15", "5.1500"), ("2.0e-3 expected", "2.4e-3 expected")];
        for (now, then) in alike {
            assert!(is_same(PLAN, &PLAN.replace(now, then)), "{then}");
        }
    }

    #[test]
    fn other_ways_are_told_apart() {
        let others =
            [("14 points", "16 points"), ("f32", "f64"), ("5.15", "5.25"), ("2.5e-3", "2.0e-3"), ("8 x", "4 x")];
        for (now, then) in others {
            assert!(!is_same(PLAN, &PLAN.replace(now, then)), "{then}");
        }
        let split = "split: common Gaussian of width 1, pairs within 5.15";
        assert!(!is_same(PLAN, &PLAN.replace(split, "direct: every envelope on the grid")));
        let dense =
            "method     dense: matrix of exact sums over all pairs in f64\niteration  to 2.5e-3 in the stresslets\n";
        assert!(!is_same(PLAN, dense) && is_same(dense, dense));
        assert_eq!(PlanIdentity::read(""), None);
        assert_eq!(PlanIdentity::read(&PLAN.replace("split", "other")), None);
        let large = PLAN.replace("14", "1400");
        assert!(!is_same(&large, &large.replacen("1400", "1401", 1)));
    }

    /// The same as that of its own description, in any axes.
    #[test]
    fn a_description_keeps_the_identity() {
        let problem = Problem::of_five_spheres();
        for method in Method::ALL {
            let fixed = Fixed { method: Some(method), ..Fixed::default() };
            let plan = Plan::choose(&Problem { fixed, ..problem.clone() }).unwrap();
            for axes in [AxisRotation::default(), AxisRotation::to_last(0)] {
                let (now, then) =
                    (PlanIdentity::of(&plan, axes), PlanIdentity::read(&plan.describe_for(axes)).unwrap());
                assert!(now.is_same(&then) && then.is_same(&now), "{now:?} {then:?}");
            }
            let other = Plan { iteration_tolerance: 1.1 * plan.iteration_tolerance, ..plan.clone() };
            let axes = AxisRotation::default();
            assert!(!PlanIdentity::of(&plan, axes).is_same(&PlanIdentity::of(&other, axes)));
        }
    }
}
