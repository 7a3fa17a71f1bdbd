//! Profiles across the gap, averaged over the volume of the grains in each layer and over time.

use super::super::{CellModel, Grains};
use bytemuck::{Pod, Zeroable};
use domain::Vector;
use statistics::{Blocks, State, Store};
use std::f64::consts::PI;

/// A layer between two heights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Height of its centre.
    pub y: f64,
    /// Solid fraction.
    pub solid_fraction: f64,
    /// Mean velocity. NaN in a layer that stayed empty.
    pub velocity: Vector,
    /// Granular temperature: one third of the mean squared velocity relative to the layer's mean.
    pub temperature: f64,
    /// Standard errors, by blocks of samples, of solid fraction, velocity along the flow and temperature.
    pub errors: [f64; 3],
}

/// Bytes of a profile with `layers` layers and of a map with `pixels` pixels.
pub fn profile_bytes(layers: usize, pixels: [usize; 2]) -> f64 {
    let layer = size_of::<LayerSums>() + size_of::<[Blocks; 3]>() + 3 * Blocks::MOST_BYTES;
    layers as f64 * layer as f64 + pixels.iter().map(|&n| n as f64).product::<f64>() * size_of::<f64>() as f64
}

/// Sums over samples, layer by layer.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerProfile {
    height: f64,
    area: f64,
    samples: u64,
    layers: Vec<LayerSums>,
    /// Time series of solid fraction, velocity along the flow and temperature of each layer.
    series: Vec<[Blocks; 3]>,
}

/// Sums over the grains of a layer: volume, and volume times velocity and times squared velocity.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
struct LayerSums {
    volume: f64,
    velocity: Vector,
    square: f64,
}

impl LayerSums {
    /// Mean velocity and granular temperature; NaN without grains.
    fn means(&self) -> (Vector, f64) {
        let velocity = self.velocity / self.volume;
        (velocity, (self.square / self.volume - velocity.length_squared()) / 3.0)
    }
}

impl LayerProfile {
    /// `layers` of equal thickness from the bottom to `height`.
    pub fn new(model: &CellModel, height: f64, layers: usize) -> Self {
        let edges = model.edges();
        Self {
            height,
            area: edges.x * edges.z,
            samples: 0,
            layers: vec![LayerSums::default(); layers],
            series: vec![Default::default(); layers],
        }
    }

    /// Adds a sample. A grain counts in each layer with its volume in that layer.
    pub fn add(&mut self, model: &CellModel, grains: &Grains) {
        let sample = self.sums(model.radius(), grains);
        let room = self.area * self.thickness();
        for ((all, now), [fraction, velocity, temperature]) in self.layers.iter_mut().zip(sample).zip(&mut self.series)
        {
            all.volume += now.volume;
            all.velocity += now.velocity;
            all.square += now.square;
            fraction.add(now.volume / room);
            if now.volume > 0.0 {
                let (mean, granular) = now.means();
                velocity.add(mean.x);
                temperature.add(granular);
            }
        }
        self.samples += 1;
    }

    fn thickness(&self) -> f64 {
        self.height / self.layers.len() as f64
    }

    fn sums(&self, radius: f64, grains: &Grains) -> Vec<LayerSums> {
        let (thickness, top) = (self.thickness(), self.layers.len() - 1);
        // Volume of the part of a sphere below a plane at t above its centre.
        let below = |t: f64| {
            let h = (t + radius).clamp(0.0, 2.0 * radius);
            PI * h * h * (radius - h / 3.0)
        };
        let mut layers = vec![LayerSums::default(); self.layers.len()];
        for (x, motion) in grains.positions.iter().zip(&grains.motions) {
            let first = ((x.y - radius) / thickness).max(0.0) as usize;
            let last = (((x.y + radius) / thickness) as usize).min(top);
            for layer in first..=last {
                let low = layer as f64 * thickness - x.y;
                let volume = below(low + thickness) - below(low);
                let sums = &mut layers[layer];
                sums.volume += volume;
                sums.velocity += motion.velocity * volume;
                sums.square += motion.velocity.length_squared() * volume;
            }
        }
        layers
    }

    /// The layers from the bottom up.
    pub fn layers(&self) -> Vec<Layer> {
        let thickness = self.thickness();
        let layer = |(k, (sums, series)): (usize, (&LayerSums, &[Blocks; 3]))| {
            let (velocity, temperature) = sums.means();
            Layer {
                y: (k as f64 + 0.5) * thickness,
                solid_fraction: sums.volume / (self.samples as f64 * self.area * thickness),
                velocity,
                temperature,
                errors: series.each_ref().map(|blocks| blocks.estimate().error),
            }
        };
        self.layers.iter().zip(&self.series).enumerate().map(layer).collect()
    }

    /// Granular temperature relative to the profile, averaged over all grains.
    pub fn temperature(&self) -> f64 {
        let filled = || self.layers.iter().filter(|sums| sums.volume > 0.0);
        let weighted: f64 = filled().map(|sums| sums.means().1 * sums.volume).sum();
        weighted / filled().map(|sums| sums.volume).sum::<f64>()
    }
}

impl State for LayerProfile {
    fn visit(&mut self, store: &mut dyn Store) {
        store.count(&mut self.samples);
        self.layers[..].visit(store);
        self.series.as_flattened_mut().visit(store);
    }
}
