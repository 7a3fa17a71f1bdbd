//! Ranges of lengths and their ratios that floating-point numbers can represent.

use domain::{Number, PeriodicBox};
use lubrication::two_sphere::LARGEST_RATIO;

/// Smallest radius over the longest edge of the box: positions have 16 digits, and gaps need some of them.
const LEAST_RADIUS: f64 = 1e-12;
/// Range of radii whose volumes, and products of volumes, are representable.
const RADII: [f64; 2] = [1e-50, 1e50];
/// Largest ratio of the box's edges with random motions.
const LONGEST_OF_NOISE: f64 = 1e4;

/// Refuses a radius that is too small for the box or out of the representable range.
pub fn check_radius(radius: f64, cell: &PeriodicBox) -> Result<(), String> {
    let (found, longest) = (Number(radius), cell.edges().max_element());
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(format!("is {found}; it needs to be a finite number above 0"));
    }
    if !(RADII[0]..=RADII[1]).contains(&radius) {
        let [least, most] = RADII.map(Number);
        return Err(format!("is {found}; it needs to be from {least} to {most}: take another unit of length"));
    }
    if radius < LEAST_RADIUS * longest {
        return Err(format!(
            "is {found}, less than {LEAST_RADIUS:e} of the longest edge of the box, {}: positions would not be exact \
             enough; take a smaller box, or larger spheres",
            Number(longest)
        ));
    }
    Ok(())
}

/// Refuses radii that differ too much for lubrication.
pub fn check_lubricated(smallest: f64, largest: f64) -> Result<(), String> {
    let ratio = largest / smallest;
    if ratio <= LARGEST_RATIO {
        return Ok(());
    }
    Err(format!(
        "is true, but the radii {} and {} differ by a factor of {:.4}; lubrication is known up to {}: leave it out, \
         or take radii nearer to each other",
        Number(smallest),
        Number(largest),
        Number(ratio),
        Number(LARGEST_RATIO)
    ))
}

/// Refuses a box so elongated that drawing random motions would never end.
pub fn check_box_of_noise(cell: &PeriodicBox) -> Result<(), String> {
    let (longest, shortest) = (cell.edges().max_element(), cell.edges().min_element());
    if longest <= LONGEST_OF_NOISE * shortest {
        return Ok(());
    }
    Err(format!(
        "has an edge of {}, {:.3} times the shortest; random motions need one of at most {} times the shortest, since \
         they are drawn of all waves that fit into the box: take a shorter box",
        Number(longest),
        Number(longest / shortest),
        Number(LONGEST_OF_NOISE)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;

    #[test]
    fn radii_that_a_box_is_too_large_for_are_refused() {
        let cell = PeriodicBox::new(Vector::new(8.0, 8.0, 20.0)).unwrap();
        for radius in [1e-300, 1e-51, 1e-12, 0.0, -1.0, f64::NAN, f64::INFINITY, 1e51] {
            assert!(check_radius(radius, &cell).is_err(), "{radius}");
        }
        assert!(check_radius(1e-10, &cell).is_ok() && check_radius(3.0, &cell).is_ok());
        let tiny = PeriodicBox::new(Vector::splat(8e-40)).unwrap();
        assert!(check_radius(1e-40, &tiny).is_ok() && check_radius(1e-53, &tiny).unwrap_err().contains("another unit"));
    }

    #[test]
    fn lubrication_is_known_up_to_a_ratio() {
        assert!(check_lubricated(0.05, 1.0).is_ok());
        assert!(check_lubricated(1.0, 50.0).unwrap_err().contains("the radii 1 and 50 differ by a factor of 50"));
    }

    #[test]
    fn noise_needs_a_box_that_is_not_too_long() {
        let of = |x: f64| check_box_of_noise(&PeriodicBox::new(Vector::new(x, 8.0, 6.0)).unwrap());
        assert!(of(6e4).is_ok());
        assert!(of(1e6).unwrap_err().contains("has an edge of 1000000, 166667 times the shortest"));
    }
}
