//! Box of a LAMMPS dump.

use crate::positions::FileBox;
use domain::Vector;
use scene::document::excerpt;

/// Box from the three lines after `ITEM: BOX BOUNDS`, and the other words of that line.
pub(super) fn read(words: &str, lines: &[&str; 3]) -> Result<FileBox, String> {
    let rows: Vec<Vec<f64>> = lines.iter().map(|line| numbers(line)).collect::<Result<_, _>>()?;
    let words: Vec<&str> = words.split_whitespace().collect();
    let (shape, ends): (Vec<&str>, Vec<&str>) = words.iter().partition(|word| SHAPES.contains(word));
    let needed = match shape[..] {
        [] => 2,
        ["xy", "xz", "yz"] => 3,
        ["abc", "origin"] => 4,
        _ => return Err(format!("its BOX BOUNDS {} are of no known shape", words.join(" "))),
    };
    if let Some(row) = rows.iter().find(|row| row.len() != needed) {
        return Err(format!("a line of its BOX BOUNDS has {} numbers; it needs {needed}", row.len()));
    }
    let cell = match needed {
        2 => tilted(&rows, [0.0; 3]),
        3 => tilted(&rows, [rows[0][2], rows[1][2], rows[2][2]]),
        _ => FileBox {
            origin: Vector::new(rows[0][3], rows[1][3], rows[2][3]),
            ..FileBox::lattice([0, 1, 2].map(|edge| Vector::from_slice(&rows[edge])))
        },
    };
    with_ends(cell, &ends).checked()
}

const SHAPES: [&str; 5] = ["xy", "xz", "yz", "abc", "origin"];

fn numbers(line: &str) -> Result<Vec<f64>, String> {
    let parsed = line.split_whitespace().map(|word| word.parse::<f64>().ok());
    parsed.collect::<Option<Vec<f64>>>().ok_or_else(|| format!("its BOX BOUNDS have the line {}", excerpt(line)))
}

/// A tilted box; the bounds are those of the orthogonal box around it.
fn tilted(rows: &[Vec<f64>], [xy, xz, yz]: [f64; 3]) -> FileBox {
    let leans = [0.0, xy, xz, xy + xz];
    let low = |values: &[f64]| values.iter().copied().fold(0.0, f64::min);
    let high = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let from = Vector::new(rows[0][0] - low(&leans), rows[1][0] - low(&[yz]), rows[2][0]);
    let until = Vector::new(rows[0][1] - high(&leans), rows[1][1] - high(&[yz]), rows[2][1]);
    let edges = until - from;
    let vectors = [Vector::X * edges.x, Vector::new(xy, edges.y, 0.0), Vector::new(xz, yz, edges.z)];
    FileBox { origin: from, ..FileBox::lattice(vectors) }
}

/// Applies the boundary words of each axis, such as `pp`. A bound that follows the particles is not the end of a box.
fn with_ends(mut cell: FileBox, ends: &[&str]) -> FileBox {
    for (axis, end) in ends.iter().enumerate().take(3) {
        cell.periodic[axis] = end.starts_with('p');
        if end.starts_with(['s', 'm']) {
            cell.origin[axis] = 0.0;
        }
    }
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_read_in_all_shapes() {
        let straight = read("pp pp ff", &["-5 5", "0 4", "1 7"]).unwrap();
        assert_eq!(straight.edges(), Vector::new(10.0, 4.0, 6.0));
        assert_eq!((straight.origin, straight.periodic), (Vector::new(-5.0, 0.0, 1.0), [true, true, false]));
        let tilted = read("xy xz yz pp pp pp", &["-3 10 -3", "0 10 0", "0 10 0"]).unwrap();
        assert_eq!(tilted.vectors, [[10.0, 0.0, 0.0], [-3.0, 10.0, 0.0], [0.0, 0.0, 10.0]].map(Vector::from_array));
        assert_eq!(tilted.origin, Vector::ZERO);
        let other = read("xy xz yz pp pp pp", &["0 13 3", "0 9 0", "0 10 -1"]).unwrap();
        assert_eq!((other.origin, other.edges()), (Vector::new(0.0, 1.0, 0.0), Vector::new(10.0, 8.0, 10.0)));
        let general = read("abc origin pp pp pp", &["4 0 0 1", "0 5 0 2", "0 0 6 3"]).unwrap();
        assert_eq!((general.origin, general.edges()), (Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, 5.0, 6.0)));
        assert_eq!(read("ss ss ss", &["-5 5", "0 4", "1 7"]).unwrap().origin, Vector::ZERO);
        assert_eq!(read("", &["0 5", "0 4", "0 7"]).unwrap().periodic, [true; 3]);
    }

    #[test]
    fn boxes_that_mean_nothing_are_refused() {
        assert!(read("pp pp pp", &["0 5", "0 4 1", "0 7"]).unwrap_err().contains("has 3 numbers; it needs 2"));
        assert!(read("pp pp pp", &["0 5", "0 a", "0 7"]).unwrap_err().contains("have the line 0 a"));
        assert!(read("xy pp pp pp", &["0 5", "0 4", "0 7"]).unwrap_err().contains("no known shape"));
        assert!(read("pp pp pp", &["5 5", "0 4", "0 7"]).unwrap_err().contains("its box"));
    }
}
