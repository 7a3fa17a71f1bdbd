use super::*;

fn chart(points: &[[f64; 2]], errors: &[f64]) -> Chart {
    let mut chart = Chart::new("a < b", ("time", "time"), ("speed & more", "length/time^2"));
    chart.add("<one>", points.to_vec(), errors.to_vec());
    chart
}

#[test]
fn a_line_goes_through_its_points() {
    let svg = svg(&chart(&[[0.0, 0.0], [1.0, 1.0]], &[])).unwrap();
    // The plot area is 66 to 504 across and 280 to 32 up, with a margin of 1/27 of it at either end.
    assert!(svg.contains("d=\"M82.2 270.8L487.8 41.2\""), "{svg}");
    assert!(
        svg.contains("<path d=\"M66.0 12.0H88.0\"") && svg.contains("<text x=\"93.0\" y=\"16.0\">&lt;one"),
        "{svg}"
    );
    assert!(svg.contains("speed &amp; more (length/time²)") && svg.contains("&lt;one&gt;") && !svg.contains("<one>"));
}

#[test]
fn no_number_is_without_value() {
    let wild = [[0.0, f64::NAN], [f64::INFINITY, 1.0], [1.0, 2.0], [2.0, f64::NEG_INFINITY], [3.0, -1e308], [4.0, 3.0]];
    for log in [[false, false], [true, false], [false, true], [true, true]] {
        let chart = Chart { log, level: Some(0.0), ..chart(&wild, &[f64::NAN, 0.1, f64::INFINITY, 0.1, 1e308, 5.0]) };
        let svg = svg(&chart).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
    }
    let svg = svg(&chart(&wild, &[])).unwrap();
    let line = svg.lines().nth_back(1).unwrap();
    assert_eq!((line.matches('M').count(), line.matches('L').count()), (2, 0), "the line is broken: {line}");
}

#[test]
fn nothing_is_drawn_of_nothing() {
    assert_eq!(svg(&chart(&[], &[])), None);
    assert_eq!(svg(&chart(&[[1.0, f64::NAN]], &[])), None);
    let negative = Chart { log: [false, true], ..chart(&[[1.0, -1.0]], &[]) };
    assert_eq!(svg(&negative), None);
}

#[test]
fn errors_are_bars_within_the_picture() {
    let svg = svg(&chart(&[[0.0, 1.0], [1.0, 1.0]], &[0.5, 0.0])).unwrap();
    assert!(svg.contains("d=\"M82.2 270.8V41.2\""), "{svg}");
}
