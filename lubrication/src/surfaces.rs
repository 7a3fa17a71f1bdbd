//! Which surfaces come near each other.

/// The surfaces of two spheres of some radii, or those of a sphere of a radius and a plane wall. Lengths and forces that laws
/// count in means of the radii have at a wall those of its flat limit where there is one: what is flat has no mean radius but
/// the sphere's own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surfaces {
    /// Two spheres.
    Spheres([f64; 2]),
    /// A sphere and a wall.
    Wall(f64),
}

impl From<[f64; 2]> for Surfaces {
    fn from(radii: [f64; 2]) -> Self {
        Self::Spheres(radii)
    }
}

impl Surfaces {
    /// The distance of the centres, or of the centre from the wall, where they touch.
    pub fn contact(&self) -> f64 {
        match self {
            Self::Spheres(radii) => radii[0] + radii[1],
            Self::Wall(radius) => *radius,
        }
    }

    /// The mean radius; at a wall that of the sphere.
    pub fn mean_radius(&self) -> f64 {
        match self {
            Self::Spheres(radii) => 0.5 * (radii[0] + radii[1]),
            Self::Wall(radius) => *radius,
        }
    }

    /// The harmonic mean radius `2 a_i a_j / (a_i + a_j)`; at a wall twice that of the sphere.
    pub fn harmonic_radius(&self) -> f64 {
        match self {
            Self::Spheres(radii) => 2.0 * radii[0] * radii[1] / (radii[0] + radii[1]),
            Self::Wall(radius) => 2.0 * radius,
        }
    }

    /// The distance where the gap is so many mean radii.
    pub fn at_gap(&self, gap: f64) -> f64 {
        match self {
            Self::Spheres(radii) => (radii[0] + radii[1]) * (1.0 + 0.5 * gap),
            Self::Wall(radius) => radius * (1.0 + gap),
        }
    }

    /// The same in other units of length.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Spheres(radii) => Self::Spheres(radii.map(|radius| radius * factor)),
            Self::Wall(radius) => Self::Wall(radius * factor),
        }
    }
}
