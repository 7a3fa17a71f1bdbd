//! Bessel functions of the first kind, for several arguments at once.

/// Number of arguments evaluated together.
pub(crate) const LANES: usize = 8;

/// Number of orders, from `J_0` on.
pub(crate) const ORDERS: usize = 5;

/// `J_0` to `J_4` of equally spaced arguments `first + i step` by Miller's algorithm: downward recurrence from orders
/// that are negligible, normalised by `J_0 + 2 (J_2 + J_4 + ...) = 1`.
#[inline(always)]
pub(crate) fn bessel([first, step]: [f64; 2]) -> [[f64; LANES]; ORDERS] {
    let mut values = [[0.0; LANES]; ORDERS];
    if first == 0.0 {
        values[0] = [1.0; LANES];
        return values;
    }
    let (mut above, mut here, mut sum, mut inverse) = ([0.0; LANES], [1e-200; LANES], [0.0; LANES], [0.0; LANES]);
    for lane in 0..LANES {
        // Below that the recurrence would overflow; the bound changes no function by more than this.
        inverse[lane] = 2.0 / (first + lane as f64 * step).max(1e-5);
    }
    let highest = 2 * (9 + (0.55 * (first + LANES as f64 * step)) as usize);
    for order in (0..highest).rev() {
        // `here` is the function of the next higher order.
        let number = (order + 1) as f64;
        for lane in 0..LANES {
            let next = (number * inverse[lane]).mul_add(here[lane], -above[lane]);
            above[lane] = here[lane];
            here[lane] = next;
        }
        if order < ORDERS {
            values[order] = here;
        }
        if order % 2 == 0 {
            let times = if order > 0 { 2.0 } else { 1.0 };
            for lane in 0..LANES {
                sum[lane] = here[lane].mul_add(times, sum[lane]);
            }
        }
    }
    for of_order in &mut values {
        for lane in 0..LANES {
            of_order[lane] /= sum[lane];
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_are_those_of_the_library() {
        for (first, step) in [(0.0, 0.0), (1e-6, 1e-6), (0.01, 0.02), (0.3, 0.5), (2.0, 1.0), (9.0, 3.0), (40.0, 2.0)] {
            let found = bessel([first, step]);
            for (order, lane) in (0..ORDERS).flat_map(|order| (0..LANES).map(move |lane| (order, lane))) {
                let x = first + lane as f64 * step;
                let value = libm::jn(order as i32, x);
                assert!(
                    (found[order][lane] - value).abs() < 1e-5,
                    "J_{order}({x}): {}, not {value}",
                    found[order][lane]
                );
            }
        }
    }
}
