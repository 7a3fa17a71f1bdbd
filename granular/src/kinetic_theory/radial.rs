//! Radial distribution of spheres at contact.

use super::jet::Jet;

/// Solid fraction at which the diverging forms end: random close packing of equal spheres (the paper's 0.65).
const PACKED: f64 = 0.65;

/// Radial distribution at contact `g0(v)`: the collision rate of spheres over that of points. The paper does not say
/// which form it uses; these are the candidates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RadialDistribution {
    /// `(2 - v) / (2 (1 - v)^3)` (Carnahan and Starling 1969); does not diverge at random packing.
    CarnahanStarling,
    /// `(1 - v/v0)^(-2.5 v0)` (Lun and Savage 1987).
    LunSavage,
    /// `1 / (1 - (v/v0)^(1/3))` (Johnson and Jackson 1987).
    JohnsonJackson,
    /// Three fifths of Johnson and Jackson's (Sinclair and Jackson 1989).
    #[default]
    SinclairJackson,
    /// Ma and Ahmadi 1986, with its own packed fraction 0.64356.
    MaAhmadi,
    /// Carnahan and Starling's up to 0.49, then `g(0.49) (v0 - 0.49) / (v0 - v)` (Torquato 1995).
    Torquato,
}

impl RadialDistribution {
    /// All forms.
    pub const ALL: [Self; 6] = [
        Self::CarnahanStarling,
        Self::LunSavage,
        Self::JohnsonJackson,
        Self::SinclairJackson,
        Self::MaAhmadi,
        Self::Torquato,
    ];

    /// Solid fraction at which the form diverges.
    pub fn packed(self) -> f64 {
        match self {
            Self::CarnahanStarling => 1.0,
            Self::MaAhmadi => 0.64356,
            _ => PACKED,
        }
    }

    /// Value at a solid fraction in `(0, packed)`.
    pub fn at(self, solid_fraction: f64) -> f64 {
        self.jet(Jet::variable(solid_fraction)).value()
    }

    pub(super) fn jet(self, v: Jet) -> Jet {
        let one = Jet::constant(1.0);
        match self {
            Self::CarnahanStarling => (-v + 2.0) * 0.5 / (-v + 1.0).power(3.0),
            Self::LunSavage => (one - v * (1.0 / PACKED)).power(-2.5 * PACKED),
            Self::JohnsonJackson => one / (one - (v * (1.0 / PACKED)).power(1.0 / 3.0)),
            Self::SinclairJackson => Self::JohnsonJackson.jet(v) * 0.6,
            Self::MaAhmadi => {
                let series = v * 2.5 + v * v * 4.5904 + v * v * v * 4.515439 + 1.0;
                series / (one - (v * (1.0 / 0.64356)).power(3.0)).power(0.67802)
            }
            Self::Torquato if v.value() < 0.49 => Self::CarnahanStarling.jet(v),
            Self::Torquato => Jet::constant(Self::CarnahanStarling.at(0.49) * (PACKED - 0.49)) / (-v + PACKED),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The forms as they are printed.
    fn printed(radial: RadialDistribution, v: f64) -> f64 {
        let dilute = |v: f64| (2.0 - v) / (2.0 * (1.0 - v).powi(3));
        match radial {
            RadialDistribution::CarnahanStarling => dilute(v),
            RadialDistribution::LunSavage => (1.0 - v / 0.65).powf(-1.625),
            RadialDistribution::JohnsonJackson => 1.0 / (1.0 - (v / 0.65).cbrt()),
            RadialDistribution::SinclairJackson => 0.6 / (1.0 - (v / 0.65).cbrt()),
            RadialDistribution::MaAhmadi => {
                (1.0 + 2.5 * v + 4.5904 * v.powi(2) + 4.515439 * v.powi(3))
                    / (1.0 - (v / 0.64356).powi(3)).powf(0.67802)
            }
            RadialDistribution::Torquato if v < 0.49 => dilute(v),
            RadialDistribution::Torquato => dilute(0.49) * 0.16 / (0.65 - v),
        }
    }

    #[test]
    fn values_and_derivatives_are_those_of_the_printed_forms() {
        for radial in RadialDistribution::ALL {
            for v in [0.01, 0.2, 0.45, 0.48, 0.5, 0.55, 0.62] {
                let jet = radial.jet(Jet::variable(v));
                let (f, h) = (|v| printed(radial, v), 1e-5 * v.min(0.64 - v));
                assert!((radial.at(v) / f(v) - 1.0).abs() < 1e-13, "{radial:?} at {v}: {} for {}", radial.at(v), f(v));
                // Central differences: error at most h^2 over the squared distance from 0 or
                // from packing, and round-off.
                let slope = (f(v + h) - f(v - h)) / (2.0 * h);
                assert!(
                    (jet.slope() - slope).abs() < 1e-7 * f(v) / v.min(0.64 - v),
                    "{radial:?} at {v}: {}",
                    jet.slope()
                );
                let h = 100.0 * h;
                let curvature = (f(v + h) - 2.0 * f(v) + f(v - h)) / (h * h);
                let found = jet.derivative().slope();
                assert!(
                    (found - curvature).abs() < 1e-4 * f(v) / v.min(0.64 - v).powi(2),
                    "{radial:?} at {v}: {found}"
                );
            }
        }
        let [below, beyond] =
            [0.4899, 0.4901].map(|v| RadialDistribution::Torquato.at(v) / printed(RadialDistribution::Torquato, v));
        assert!((below - 1.0).abs() < 1e-13 && (beyond - 1.0).abs() < 1e-13);
    }
}
