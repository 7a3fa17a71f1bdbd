//! Costs of evaluations on a card, for the planner.

use crate::plan::costs::Costs;
use std::sync::OnceLock;

/// Class of cards with similar costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CardClass {
    /// Cards for servers, of compute capability 9.0 to 11.
    Server,
    /// Cards for servers, of 7.0 and 8.0.
    OlderServer,
    /// Cards for desktops, which are slow in `f64`.
    Desktop,
}

/// Work of an evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CardWork {
    /// Grid points of all stencils.
    pub stencil_points: f64,
    /// Points of the grid.
    pub grid_points: f64,
    /// Pairs within the cutoff, each of which counts twice.
    pub pairs: f64,
    /// In `f32`.
    pub is_single: bool,
}

/// Seconds of a part of an evaluation that has hardly any work: that of its launches.
const LATENCY: f64 = 1.5e-5;

/// Seconds per grid point of a stencil, per point of the grid and per pair, in `f32` and in `f64`.
struct ClassCosts {
    single: Costs,
    double: Costs,
}

/// Fitted to times of similar kernels on an H200, which take twice as long in `f64`.
const SERVER: ClassCosts = ClassCosts {
    single: Costs { stencils: 1.05e-11, transforms: 5.4e-11, pairs: 1.8e-11 },
    double: Costs { stencils: 2.1e-11, transforms: 1.08e-10, pairs: 3.6e-11 },
};

/// The same by the data sheet of an A100: memory of 2/5 of the bandwidth, 2/7 of the operations in a second.
const OLDER_SERVER: ClassCosts = ClassCosts {
    single: Costs { stencils: 3.7e-11, transforms: 1.35e-10, pairs: 6.3e-11 },
    double: Costs { stencils: 7.4e-11, transforms: 2.7e-10, pairs: 1.26e-10 },
};

/// The same by the data sheet of an RTX 4090: memory of 1/5 of the bandwidth, and 1/64 of the operations in `f64`.
const DESKTOP: ClassCosts = ClassCosts {
    single: Costs { stencils: 1.05e-11, transforms: 2.6e-10, pairs: 1.8e-11 },
    double: Costs { stencils: 3.4e-10, transforms: 8e-10, pairs: 5.8e-10 },
};

impl CardClass {
    /// Class of a compute capability.
    fn of([major, minor]: [i32; 2]) -> Self {
        match (major, minor) {
            (9..=11, _) => Self::Server,
            (7 | 8, 0) => Self::OlderServer,
            _ => Self::Desktop,
        }
    }

    /// Class of the first card of this machine; without one, the first.
    pub fn present() -> Self {
        static CLASS: OnceLock<CardClass> = OnceLock::new();
        *CLASS.get_or_init(|| gpu::Cuda::capability().map_or(Self::Server, Self::of))
    }

    /// Seconds of the parts of an evaluation.
    pub fn seconds(self, work: &CardWork) -> Costs {
        let ClassCosts { single, double } = match self {
            Self::Server => SERVER,
            Self::OlderServer => OLDER_SERVER,
            Self::Desktop => DESKTOP,
        };
        let each = if work.is_single { single } else { double };
        Costs {
            stencils: LATENCY + work.stencil_points * each.stencils,
            transforms: LATENCY + work.grid_points * each.transforms,
            pairs: LATENCY + work.pairs * each.pairs,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_are_those_of_the_capability() {
        let classes = [[9, 0], [10, 0], [8, 0], [7, 0], [7, 5], [8, 6], [8, 9], [12, 0]].map(CardClass::of);
        let [server, older, desktop] = [CardClass::Server, CardClass::OlderServer, CardClass::Desktop];
        assert_eq!(classes, [server, server, older, older, desktop, desktop, desktop, desktop]);
    }

    /// Milliseconds on an H200 of stencils, transforms and pairs: spheres at 12%, windows of 6 points.
    #[test]
    fn costs_are_close_to_the_measured_ones() {
        let measured = [
            (3200.0, 64.0_f64, 14.0, [0.028, 0.038, 0.010]),
            (1e5, 128.0, 56.0, [0.267, 0.113, 0.114]),
            (1e6, 256.0, 72.0, [2.185, 0.91, 1.24]),
        ];
        for (particles, edge, neighbours, times) in measured {
            let work = CardWork {
                stencil_points: 216.0 * particles,
                grid_points: edge.powi(3),
                pairs: particles * neighbours,
                is_single: true,
            };
            let Costs { stencils, transforms, pairs } = CardClass::Server.seconds(&work);
            for (found, time) in [stencils, transforms, pairs].into_iter().zip(times) {
                assert!((1e3 * found / time).ln().abs() < 0.6, "{found} s for {time} ms");
            }
        }
    }
}
