//! The frames of a trajectory for the player of a page, in a compact form.

mod axes;
mod chains;
mod chosen;
mod colouring;
#[cfg(test)]
mod tests;

use axes::Axes;
use base64::prelude::{BASE64_STANDARD, Engine};
use chains::Chains;
use chosen::chosen;
pub(super) use colouring::Colours;
use colouring::{Colouring, columns_of};
use domain::{Number, PeriodicBox, Vector};
use files::{RecordedContacts, TimedFrame, TrajectoryReader};
use serde_json::{Value, json};
use simulation::Frame;

/// Frames of a trajectory in the form that the player needs.
pub(super) struct Playback {
    /// Number of frames of the trajectory.
    pub(super) recorded: usize,
    /// Damage of the damaged frames, which are left out.
    pub(super) damage: Vec<String>,
    frames: Vec<ShownFrame>,
    positions: Vec<u8>,
    radii: Vec<f32>,
    colourings: Vec<Colouring>,
    axes: Axes,
    chains: Chains,
    is_flat: bool,
    periodic: [bool; 3],
}

/// A frame that is shown.
struct ShownFrame {
    step: u64,
    time: f64,
    cell: PeriodicBox,
}

impl Playback {
    /// Reads as many equally spaced frames as a page can hold. `colours` has the data for colouring particles.
    pub(super) fn of(recorded: &TrajectoryReader, contacts: &RecordedContacts, colours: &Colours) -> Self {
        let count = recorded.species().len();
        let is_oriented = recorded.snapshot(0).is_ok_and(|first| axes::are_in(&first.frame.particles));
        let meant = chosen(recorded.times().len(), count, if is_oriented { axes::EACH } else { 0 });
        let mut playback = Self {
            recorded: recorded.times().len(),
            damage: Vec::new(),
            frames: Vec::new(),
            positions: Vec::new(),
            radii: Vec::new(),
            colourings: Vec::new(),
            axes: Axes::default(),
            chains: Chains::default(),
            is_flat: true,
            periodic: [false; 3],
        };
        let mut columns = columns_of(colours);
        for frame in meant {
            match recorded.snapshot(frame) {
                Ok(snapshot) => {
                    for column in &mut columns {
                        column.see(&snapshot.frame);
                    }
                    playback.see(&snapshot, colours);
                    playback.damage.extend(playback.chains.see(contacts, &snapshot));
                }
                Err(error) => playback.damage.push(error.to_string()),
            }
        }
        playback.colourings.extend(columns.into_iter().filter_map(colouring::ParticleColumn::finished));
        playback.chains.finish();
        // Colourings that do not distinguish particles come last.
        playback.colourings.sort_by_key(Colouring::is_of_one);
        playback
    }

    fn see(&mut self, snapshot: &TimedFrame, colours: &Colours) {
        let TimedFrame { step, time, frame: Frame { particles, cell, periodic } } = snapshot;
        if self.frames.is_empty() {
            self.radii = particles.radii.iter().map(|&radius| radius as f32).collect();
            self.colourings = colouring::fixed(particles, colours);
            self.periodic = *periodic;
        }
        self.is_flat &= particles.positions.iter().all(|position| position.z == 0.0);
        self.positions.extend(particles.positions.iter().flat_map(|&position| in_box(cell, position)));
        self.axes.see(particles);
        self.frames.push(ShownFrame { step: *step, time: *time, cell: *cell });
    }

    /// Edges of the box and its periodic axes. `None` if no frame is shown.
    pub(super) fn box_in_words(&self) -> Option<String> {
        let axes = if self.is_flat { 2 } else { 3 };
        let edges = self.frames.first()?.cell.edges().to_array();
        let edges: Vec<String> = edges[..axes].iter().map(|&edge| format!("{:.4}", Number(edge))).collect();
        let periodic: Vec<&str> =
            ["x", "y", "z"].into_iter().zip(self.periodic).filter(|axis| axis.1).map(|axis| axis.0).collect();
        let repeats =
            if periodic.is_empty() { "open".to_owned() } else { format!("periodic along {}", periodic.join(", ")) };
        Some(format!("{}, {repeats}", edges.join(" \u{d7} ")))
    }

    /// Whether there are contact forces to show.
    pub(super) fn has_chains(&self) -> bool {
        !self.chains.is_empty()
    }

    /// Whether there are axes to show.
    pub(super) fn has_axes(&self) -> bool {
        !self.axes.is_empty()
    }

    /// Number of frames that are shown.
    pub(super) fn shown(&self) -> usize {
        self.frames.len()
    }

    /// Data for the player: the description, and each list of bytes with the name of its element.
    pub(super) fn parts(&self, up: char) -> (Value, Vec<(String, String)>) {
        let edges = self.frames.iter().map(|frame| edges(&frame.cell));
        let description = json!({
            "count": self.radii.len(),
            "flat": self.is_flat,
            "up": up,
            "times": self.frames.iter().map(|frame| frame.time).collect::<Vec<_>>(),
            "steps": self.frames.iter().map(|frame| frame.step).collect::<Vec<_>>(),
            "edges": edges.collect::<Vec<_>>(),
            "colourings": self.colourings.iter().map(Colouring::described).collect::<Vec<_>>(),
            "oriented": self.has_axes(),
            "chains": self.chains.described(),
        });
        let radii: Vec<u8> = self.radii.iter().flat_map(|radius| radius.to_le_bytes()).collect();
        let lists = [
            ("radii".to_owned(), BASE64_STANDARD.encode(&radii)),
            ("positions".to_owned(), BASE64_STANDARD.encode(&self.positions)),
        ];
        let of_colours = self.colourings.iter().enumerate();
        let of_colours =
            of_colours.map(|(k, colouring)| (format!("colouring-{k}"), BASE64_STANDARD.encode(&colouring.values)));
        (description, lists.into_iter().chain(of_colours).chain(self.axes.list()).chain(self.chains.lists()).collect())
    }
}

/// Lattice vectors of a box, one after another.
fn edges(cell: &PeriodicBox) -> Vec<f64> {
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].iter().flat_map(|&steps| cell.lattice(steps).to_array()).collect()
}

/// Box coordinates in units of 1/65536, two bytes each. Positions outside of the box, e.g. beyond a
/// wall, are moved to its face.
fn in_box(cell: &PeriodicBox, position: Vector) -> [u8; 6] {
    let parts = cell.fractional_coordinates(position) * 65536.0;
    let [x, y, z] = parts.to_array().map(|part| (part.floor().clamp(0.0, 65535.0) as u16).to_le_bytes());
    [x[0], x[1], y[0], y[1], z[0], z[1]]
}
