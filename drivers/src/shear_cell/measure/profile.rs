//! Profiles across the gap, averaged over the volume of the grains in each layer and over time.

use super::super::{Grains, Model, numbers::Numbers};
use domain::Vector;
use std::f64::consts::PI;

/// A layer between two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Height of its middle.
    pub y: f64,
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Mean velocity. Not a number in a layer that stayed empty.
    pub velocity: Vector,
    /// Granular temperature: a third of the mean squared velocity relative to the layer's mean.
    pub temperature: f64,
}

/// Sums over samples, layer by layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    height: f64,
    area: f64,
    samples: u64,
    volumes: Vec<f64>,
    velocities: Vec<Vector>,
    squares: Vec<f64>,
}

impl Profile {
    /// `layers` of equal thickness from the bottom to `height`.
    pub fn new(model: &Model, height: f64, layers: usize) -> Self {
        let edges = model.edges();
        Self {
            height,
            area: edges.x * edges.z,
            samples: 0,
            volumes: vec![0.0; layers],
            velocities: vec![Vector::ZERO; layers],
            squares: vec![0.0; layers],
        }
    }

    /// Adds a sample. A grain counts in each layer by the volume that it has there.
    pub fn add(&mut self, model: &Model, grains: &Grains) {
        let (radius, layers) = (model.radius(), self.volumes.len());
        let thickness = self.height / layers as f64;
        // Volume of a sphere below a plane at t above its centre.
        let below = |t: f64| {
            let h = (t + radius).clamp(0.0, 2.0 * radius);
            PI * h * h * (radius - h / 3.0)
        };
        for (x, motion) in grains.positions.iter().zip(&grains.motions) {
            let first = ((x.y - radius) / thickness).max(0.0) as usize;
            let last = (((x.y + radius) / thickness) as usize).min(layers - 1);
            for layer in first..=last {
                let low = layer as f64 * thickness - x.y;
                let volume = below(low + thickness) - below(low);
                self.volumes[layer] += volume;
                self.velocities[layer] += motion.velocity * volume;
                self.squares[layer] += motion.velocity.length_squared() * volume;
            }
        }
        self.samples += 1;
    }

    pub(in super::super) fn keep(&self, numbers: &mut Numbers) {
        numbers.put(&[self.samples as f64]);
        numbers.list(&self.volumes);
        numbers.vectors(&self.velocities);
        numbers.list(&self.squares);
    }

    pub(in super::super) fn recall(&mut self, numbers: &mut Numbers) {
        let [samples] = numbers.take();
        self.samples = samples as u64;
        self.volumes = numbers.take_list();
        self.velocities = numbers.take_vectors();
        self.squares = numbers.take_list();
    }

    /// The layers from the bottom up.
    pub fn layers(&self) -> Vec<Layer> {
        let thickness = self.height / self.volumes.len() as f64;
        let layer = |k: usize| {
            let velocity = self.velocities[k] / self.volumes[k];
            Layer {
                y: (k as f64 + 0.5) * thickness,
                solid_fraction: self.volumes[k] / (self.samples as f64 * self.area * thickness),
                velocity,
                temperature: (self.squares[k] / self.volumes[k] - velocity.length_squared()) / 3.0,
            }
        };
        (0..self.volumes.len()).map(layer).collect()
    }

    /// Granular temperature relative to the profile, averaged over all grains.
    pub fn temperature(&self) -> f64 {
        let weighted: f64 =
            self.layers().iter().zip(&self.volumes).filter(|(_, v)| **v > 0.0).map(|(l, v)| l.temperature * v).sum();
        weighted / self.volumes.iter().sum::<f64>()
    }
}
