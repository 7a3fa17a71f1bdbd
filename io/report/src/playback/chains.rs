//! Contact forces as lines between centres.

use super::in_box;
use base64::prelude::{BASE64_STANDARD, Engine};
use domain::{Number, PeriodicBox, Vector};
use files::{RecordedContacts, TimedFrame};
use serde_json::{Value, json};
use simulation::ContactForce;

/// Largest number of bytes of the lines on a page; as text they take a third more.
const BYTES: usize = 20_000_000;
/// Bytes of a line: three coordinates of its start, three of the vector to its end, and its width.
const EACH: usize = 3 * 2 + 3 * 2 + 1;

/// The lines of each frame, the strongest first.
#[derive(Default)]
pub(super) struct Chains {
    /// Number of lines of each frame.
    counts: Vec<usize>,
    places: Vec<[u8; 12]>,
    /// Magnitudes of the normal forces.
    forces: Vec<f32>,
}

impl Chains {
    /// Adds the contacts of a frame, if they were written at its step; returns their damage, if there is any.
    pub(super) fn see(&mut self, recorded: &RecordedContacts, snapshot: &TimedFrame) -> Option<String> {
        let mut list = Vec::new();
        let damage = match recorded.of_step(snapshot.step) {
            Some(Ok(contacts)) => {
                list = contacts.list;
                None
            }
            Some(Err(error)) => Some(error.to_string()),
            None => None,
        };
        list.sort_by(|a, b| b.normal.abs().total_cmp(&a.normal.abs()));
        self.counts.push(list.len());
        self.places.extend(list.iter().map(|contact| line(&snapshot.frame.cell, contact)));
        self.forces.extend(list.iter().map(|contact| contact.normal.abs() as f32));
        damage
    }

    /// Keeps the strongest lines of each frame, as many as there is room for.
    pub(super) fn finish(&mut self) {
        let room = BYTES / EACH / self.counts.len().max(1);
        let before = std::mem::take(&mut self.counts);
        let (places, forces) = (std::mem::take(&mut self.places), std::mem::take(&mut self.forces));
        let mut first = 0;
        for count in before {
            let kept = first..first + count.min(room);
            self.places.extend_from_slice(&places[kept.clone()]);
            self.forces.extend_from_slice(&forces[kept]);
            self.counts.push(count.min(room));
            first += count;
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// Number of lines of each frame, and the largest force; `null` without lines.
    pub(super) fn described(&self) -> Value {
        if self.is_empty() {
            return Value::Null;
        }
        json!({"counts": self.counts, "largest": format!("{:.3}", Number(self.largest()))})
    }

    fn largest(&self) -> f64 {
        f64::from(self.forces.iter().copied().fold(0.0, f32::max))
    }

    /// Lists of bytes with the names of their elements.
    pub(super) fn lists(&self) -> Vec<(String, String)> {
        if self.is_empty() {
            return Vec::new();
        }
        let unit = 255.0 / self.largest().max(f64::MIN_POSITIVE);
        let widths: Vec<u8> = self.forces.iter().map(|&force| (f64::from(force) * unit).round() as u8).collect();
        vec![
            ("chains".to_owned(), BASE64_STANDARD.encode(self.places.as_flattened())),
            ("widths".to_owned(), BASE64_STANDARD.encode(&widths)),
        ]
    }
}

/// Box coordinates of the start in units of 1/65536, and of the vector to the end in units of 1/32768, two bytes each.
fn line(cell: &PeriodicBox, contact: &ContactForce) -> [u8; 12] {
    let mut bytes = [0; 12];
    bytes[..6].copy_from_slice(&in_box(cell, contact.position));
    let parts: Vector = cell.lattice_coordinates(contact.separation) / cell.edges() * 32768.0;
    for (axis, part) in parts.to_array().into_iter().enumerate() {
        bytes[6 + 2 * axis..][..2].copy_from_slice(&(part.round().clamp(-32768.0, 32767.0) as i16).to_le_bytes());
    }
    bytes
}
