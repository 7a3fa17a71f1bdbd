//! Thinning of lines with more points than are visible.

/// Largest number of points of a drawn line.
const MOST: usize = 1000;

/// A line through the minimum and the maximum of each group of neighbours, if there are more points than are
/// distinguishable. A group without finite points stays as a gap of the line.
pub(super) fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= MOST {
        return points.to_vec();
    }
    let group = points.len().div_ceil(MOST / 2);
    points.chunks(group).flat_map(ends).collect()
}

/// The lowest and the highest point of a group in the order of the line.
fn ends(group: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let finite = || group.iter().enumerate().filter(|(_, point)| point[1].is_finite());
    let by_height = |a: &(usize, &[f64; 2]), b: &(usize, &[f64; 2])| a.1[1].total_cmp(&b.1[1]);
    let Some(((low, _), (high, _))) = finite().min_by(by_height).zip(finite().max_by(by_height)) else {
        return vec![group[0]];
    };
    let (first, second) = (low.min(high), low.max(high));
    if first == second { vec![group[first]] } else { vec![group[first], group[second]] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_stay() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [f64::from(k), (f64::from(k) * 1e-4).sin()]).collect();
        points[31_415][1] = 9.0;
        points[60_000][1] = -9.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST && thin.contains(&[31_415.0, 9.0]) && thin.contains(&[60_000.0, -9.0]));
        assert!(thin.is_sorted_by(|a, b| a[0] < b[0]));
        assert_eq!(thinned(&points[..5]), points[..5]);
    }

    #[test]
    fn gaps_stay() {
        let mut points: Vec<[f64; 2]> = (0..10_000).map(|k| [f64::from(k), 1.0]).collect();
        points[2000..4000].iter_mut().for_each(|point| point[1] = f64::NAN);
        let thin = thinned(&points);
        assert!(thin.iter().any(|point| point[1].is_nan()));
        assert!(thin.len() <= MOST);
    }
}
