//! Quantities for colouring particles.

use domain::{Number, Particles, Quaternion, Vector};
use serde_json::{Value, json};
use simulation::Frame;

/// Data of the scene for colouring.
pub(crate) struct Colours {
    /// Names of the species.
    pub(crate) species: Vec<String>,
    /// The flow relative to which velocities are shown, if there is one.
    pub(crate) flow: Option<Box<dyn Fn(Vector) -> Vector>>,
}

/// Colours of all particles.
pub(super) struct Colouring {
    name: &'static str,
    key: Key,
    /// Whether the colours are the same in each frame.
    is_fixed: bool,
    /// One byte per particle; if not fixed, for each frame in turn.
    pub(super) values: Vec<u8>,
}

/// Meaning of the bytes.
enum Key {
    /// Indices of these names.
    Names(Vec<String>),
    /// Numbers from the first to the second, with a label.
    Range([f64; 2], &'static str),
}

impl Colouring {
    /// Whether all particles have the same colour.
    pub(super) fn is_of_one(&self) -> bool {
        matches!(&self.key, Key::Names(names) if names.len() == 1)
    }

    /// Description of the colours for the player.
    pub(super) fn described(&self) -> Value {
        match &self.key {
            Key::Names(names) => json!({"name": self.name, "fixed": self.is_fixed, "names": names}),
            Key::Range(range, label) => {
                let range = range.map(|end| format!("{:.3}", Number(end)));
                json!({"name": self.name, "fixed": self.is_fixed, "range": range, "label": label})
            }
        }
    }
}

/// Colours that do not change: by species, and by radius if there are many radii.
pub(super) fn fixed(particles: &Particles, colours: &Colours) -> Vec<Colouring> {
    let species = particles.species.iter().map(|&species| species as u8).collect();
    let last = particles.species.iter().max().map_or(0, |&last| last as usize);
    let name = |species: usize| colours.species.get(species).cloned().unwrap_or_else(|| species.to_string());
    let names = Key::Names((0..=last.min(255)).map(name).collect());
    let by_species = Colouring { name: "species", key: names, is_fixed: true, values: species };
    let mut radii: Vec<f64> = particles.radii.clone();
    radii.sort_by(f64::total_cmp);
    radii.dedup();
    if radii.len() <= last + 1 {
        return vec![by_species];
    }
    let range = [radii[0], radii[radii.len() - 1]];
    let values = particles.radii.iter().map(|&radius| byte(radius, range)).collect();
    let by_radius = Colouring { name: "radius", key: Key::Range(range, "radius (length)"), is_fixed: true, values };
    // If species do not have one size each, they are only ranges of radii.
    vec![by_radius, by_species]
}

/// One number per particle, if the frame has it.
type ParticleNumbers<'a> = dyn Fn(&Particles) -> Option<Vec<f32>> + 'a;

/// One number per particle in each frame.
pub(super) struct ParticleColumn<'a> {
    name: &'static str,
    label: &'static str,
    of: Box<ParticleNumbers<'a>>,
    values: Vec<f32>,
    is_whole: bool,
}

/// Quantities for colouring.
pub(super) fn columns_of(colours: &Colours) -> Vec<ParticleColumn<'_>> {
    let speed = if colours.flow.is_some() { "speed relative to the flow (length/time)" } else { "speed (length/time)" };
    let column = |name, label, of| ParticleColumn { name, label, of, values: Vec::new(), is_whole: true };
    vec![
        column("speed", speed, Box::new(|particles: &Particles| speeds(particles, colours))),
        column("stress", "size of the stresslet (force length)", Box::new(stresses)),
        column("axis", "axis along z", Box::new(axes)),
    ]
}

/// Rows of the column of this name.
fn rows<'a>(particles: &'a Particles, name: &str) -> Option<std::slice::ChunksExact<'a, f64>> {
    let column = particles.columns.iter().find(|column| column.name == name)?;
    Some(column.values.chunks_exact(column.width))
}

fn speeds(particles: &Particles, colours: &Colours) -> Option<Vec<f32>> {
    let flow = |place: Vector| colours.flow.as_ref().map_or(Vector::ZERO, |flow| flow(place));
    let velocities = rows(particles, "velocity")?.map(Vector::from_slice);
    Some(velocities.zip(&particles.positions).map(|(v, &place)| (v - flow(place)).length() as f32).collect())
}

/// `(S : S)^(1/2)` of traceless stresslets with the components xx, xy, xz, yy and yz.
fn stresses(particles: &Particles) -> Option<Vec<f32>> {
    let size = |s: &[f64]| {
        let zz = -s[0] - s[3];
        (s[0] * s[0] + s[3] * s[3] + zz * zz + 2.0 * (s[1] * s[1] + s[2] * s[2] + s[4] * s[4])).sqrt() as f32
    };
    Some(rows(particles, "stresslet")?.map(size).collect())
}

/// Components along z of the axes of spheres with orientations.
fn axes(particles: &Particles) -> Option<Vec<f32>> {
    let along = |q: &[f64]| Quaternion::from_array([q[0], q[1], q[2], q[3]]).axis().z as f32;
    Some(rows(particles, "orientation")?.map(along).collect())
}

impl ParticleColumn<'_> {
    /// Adds a frame.
    pub(super) fn see(&mut self, frame: &Frame) {
        match (self.of)(&frame.particles) {
            Some(values) => self.values.extend(values),
            None => self.is_whole = false,
        }
    }

    /// The colours; `None` if some frame lacks the number, or all values are equal.
    pub(super) fn finished(self) -> Option<Colouring> {
        let range = spread(&self.values).filter(|_| self.is_whole)?;
        let values = self.values.iter().map(|&value| byte(f64::from(value), range)).collect();
        Some(Colouring { name: self.name, key: Key::Range(range, self.label), is_fixed: false, values })
    }
}

/// The width of a range over its ends from which these differ in the three digits of the legend.
const SEEN: f64 = 2e-3;

/// The range that all values but the least and the greatest hundredth are in: a few that are far off would leave all
/// others one colour. `None` if that is no range, or one whose ends are the same in the digits that are shown.
fn spread(values: &[f32]) -> Option<[f64; 2]> {
    let mut values = values.to_vec();
    let last = values.len().checked_sub(1)?;
    let [low, high] =
        [last / 100, last - last / 100].map(|k| f64::from(*values.select_nth_unstable_by(k, f32::total_cmp).1));
    let width = high - low;
    (width > SEEN * low.abs().max(high.abs()) && width.is_finite()).then_some([low, high])
}

/// A value as a byte, 0 at the start of the range and 255 at its end.
fn byte(value: f64, [low, high]: [f64; 2]) -> u8 {
    ((value - low) / (high - low) * 255.0).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_a_stresslet_is_its_norm() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        assert_eq!(stresses(&particles), None);
        let values = vec![1.0, 2.0, 0.0, -3.0, 1.0];
        particles.columns.push(domain::Column { name: "stresslet".into(), width: 5, values: values.into() });
        // The tensor with the rows (1 2 0), (2 -3 1), (0 1 2).
        assert_eq!(stresses(&particles), Some(vec![24_f32.sqrt()]));
    }

    #[test]
    fn the_axis_of_a_sphere_is_that_of_its_orientation() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        particles.push(1, Vector::ZERO, 1.0, 0);
        assert_eq!(axes(&particles), None);
        let values = [Quaternion::between(Vector::Z, -Vector::Z), Quaternion::between(Vector::Z, Vector::X)];
        let values = values.map(Quaternion::to_array).concat();
        particles.columns.push(domain::Column { name: "orientation".into(), width: 4, values: values.into() });
        let found = axes(&particles).unwrap();
        assert!((found[0] + 1.0).abs() < 1e-6 && found[1].abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_few_that_are_far_off_change_no_colours() {
        let mut values: Vec<f32> = (0..1000_u16).map(f32::from).collect();
        values[0] = 1e30;
        let [low, high] = spread(&values).unwrap();
        assert!((9.0..12.0).contains(&low) && (985.0..995.0).contains(&high), "{low} to {high}");
        assert_eq!((byte(low, [low, high]), byte(high, [low, high]), byte(1e30, [low, high])), (0, 255, 255));
        assert_eq!((spread(&[]), spread(&[3.0; 9])), (None, None));
        assert_eq!((spread(&[1.09, 1.090_001]), spread(&[0.0; 9])), (None, None));
        assert!(spread(&[1.09, 1.1]).is_some() && spread(&[-1e-9, 1e-9]).is_some());
    }
}
