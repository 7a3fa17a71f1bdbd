//! Gaps and overlaps in messages.

use domain::Number;
use std::fmt::{Display, Formatter};

/// A gap or an overlap. Messages show it in radii as well, since the unit of length is unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// The length.
    pub length: f64,
    /// Smallest radius.
    pub radius: f64,
}

impl Display for Gap {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let in_radii = self.length / self.radius;
        write!(f, "{:.3}", Number(self.length))?;
        if in_radii.is_finite() { write!(f, " ({:.3} of the smallest radius)", Number(in_radii)) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_gaps_are_shown_in_radii_too() {
        let gap = Gap { length: 5.2e-8, radius: 5e-6 };
        assert_eq!(gap.to_string(), "5.2e-8 (0.0104 of the smallest radius)");
        assert_eq!(Gap { length: 3.0, radius: 1e-310 }.to_string(), "3");
    }
}
