//! Map of the solid fraction across the cell, averaged along the flow and over time.

use super::super::{CellModel, Grains};
use statistics::{State, Store};

/// Sample points of the solid fraction along each edge of a pixel.
const POINTS: usize = 3;

/// Solid fraction on a grid over the width (z) and the height (y).
#[derive(Debug, Clone, PartialEq)]
pub struct DensityMap {
    /// Pixels along z and along y.
    pub pixels: [usize; 2],
    width: f64,
    height: f64,
    samples: u64,
    sums: Vec<f64>,
}

impl DensityMap {
    /// An empty map up to `height`.
    pub fn new(model: &CellModel, height: f64, pixels: [usize; 2]) -> Self {
        Self { pixels, width: model.edges().z, height, samples: 0, sums: vec![0.0; pixels[0] * pixels[1]] }
    }

    /// Adds a sample. A line along the flow through a grain at the distance `r` from its centre has a chord of
    /// `2 sqrt(R^2 - r^2)`, so the average along the flow is exact.
    pub fn add(&mut self, model: &CellModel, grains: &Grains) {
        let radius = model.radius();
        let counts = self.pixels.map(|n| n * POINTS);
        let [dz, dy] = [self.width / counts[0] as f64, self.height / counts[1] as f64];
        let share = 2.0 / (model.edges().x * (POINTS * POINTS) as f64);
        let within = |x: f64, d: f64, n: usize| {
            let first = ((x - radius) / d - 0.5).ceil().max(0.0) as usize;
            let last = ((x + radius) / d - 0.5).floor().min(n as f64 - 1.0);
            first..(last + 1.0).max(0.0) as usize
        };
        for x in &grains.positions {
            for iy in within(x.y, dy, counts[1]) {
                let y = (iy as f64 + 0.5) * dy - x.y;
                for iz in within(x.z, dz, counts[0]) {
                    let z = (iz as f64 + 0.5) * dz - x.z;
                    let square = radius * radius - y * y - z * z;
                    if square > 0.0 {
                        self.sums[iy / POINTS * self.pixels[0] + iz / POINTS] += share * square.sqrt();
                    }
                }
            }
        }
        self.samples += 1;
    }

    /// Centres of the pixels along z and along y.
    pub fn middles(&self) -> [Vec<f64>; 2] {
        let middles =
            |count: usize, length: f64| (0..count).map(|k| (k as f64 + 0.5) * length / count as f64).collect();
        [middles(self.pixels[0], self.width), middles(self.pixels[1], self.height)]
    }

    /// Solid fractions, a row of pixels along z for each height, from the bottom up.
    pub fn solid_fractions(&self) -> Vec<f64> {
        self.sums.iter().map(|s| s / self.samples as f64).collect()
    }
}

impl State for DensityMap {
    fn visit(&mut self, store: &mut dyn Store) {
        store.count(&mut self.samples);
        store.numbers(&mut self.sums);
    }
}
