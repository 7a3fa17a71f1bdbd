//! Scaling of the time of a step with the number of ranks.

use crate::evaluation::prepared::Planned;
use crate::flow::open_cell::follows;
use crate::model::Model;
use fcm::{Network, Traffic};

/// Assumed machine: ranks of a node share its port and its memory, in bytes per second.
pub struct AssumedNode {
    /// Threads of all ranks of a node.
    pub cores: usize,
    /// Bandwidth of its port, each way.
    pub port: f64,
    /// Bandwidth of its memory.
    pub memory: f64,
}

/// Node of the clusters whose published transforms the page on scale reproduces.
pub const NODE: AssumedNode = AssumedNode { cores: 40, port: 12.5e9, memory: 150e9 };

/// Assumed latency of a message in seconds.
pub const LATENCY: f64 = 1.5e-6;

/// Times that bytes for another rank are read and written in memory.
const COPIES: f64 = 4.0;

/// Parallel efficiency from which a number of ranks is worthwhile.
const WORTH: f64 = 0.5;

/// Largest number of ranks considered, a power of two.
const MOST: usize = 1 << 20;

impl AssumedNode {
    /// The network of ranks of so many threads each that fill such nodes.
    pub fn network(&self, ranks: usize, threads: usize) -> Network {
        let of_node = (self.cores / threads).clamp(1, ranks) as f64;
        let away = 1.0 - of_node / ranks as f64;
        let seconds = of_node * (away / self.port + COPIES / self.memory);
        Network { ranks, threads, bandwidth: 1.0 / seconds, latency: LATENCY }
    }
}

/// Model of the time of a step on any number of ranks.
pub struct Scaling {
    planned: Planned,
    /// Fraction of the time of an evaluation that is spent on the grid.
    of_grid: f64,
}

/// Measured step on one rank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepAlone {
    /// Time in seconds.
    pub seconds: f64,
    /// Number of threads of the rank.
    pub threads: usize,
}

impl Scaling {
    /// The scaling for a model that gives its number of spheres, in a box whose grid does not change; `None` for
    /// others.
    pub fn of(model: &Model) -> Option<Self> {
        if follows(model.cell.boundaries()) {
            return None;
        }
        let planned = Planned::of_model(model).ok()??;
        let parts = planned.plan.parts(planned.radii.count());
        let of_grid = parts.transforms / (parts.transforms + parts.stencils + parts.pairs);
        Some(Self { planned, of_grid })
    }

    /// Seconds of a step on ranks with as many threads each as in the measured step: the largest share of the work,
    /// plus communication. The communication is that of the number of evaluations that take as long as the step.
    ///
    /// ```text
    /// t(N) = t(1) [g G(N) + (1 - g) P(N)] + n [bytes(N) (a(N) / port + 4 / memory) + messages(N) latency]
    /// ```
    ///
    /// with the fraction `g` of work on the grid, the largest shares `G` of its lines and `P` of the spheres, `n`
    /// evaluations, the share `a` of the bytes that leave a node, and a rank's shares of the bandwidths of the port and
    /// the memory of its node.
    pub fn seconds(&self, alone: StepAlone, ranks: usize) -> f64 {
        alone.seconds * self.share(ranks) + self.evaluations(alone) * self.exchange(ranks, alone.threads)
    }

    /// Parallel efficiency: time on one rank over the time of all ranks together.
    pub fn efficiency(&self, alone: StepAlone, ranks: usize) -> f64 {
        alone.seconds / (ranks as f64 * self.seconds(alone, ranks))
    }

    /// Largest number of ranks with an efficiency of at least a half.
    pub fn ranks_worth(&self, alone: StepAlone) -> usize {
        let is_worth = |ranks: &usize| self.efficiency(alone, *ranks) >= WORTH;
        let power = (0..=MOST.ilog2()).map(|power| 1 << power).take_while(is_worth).last().unwrap_or(1);
        (1..=4 * power).rev().find(is_worth).unwrap_or(1)
    }

    /// Number of evaluations that take as long as the step.
    fn evaluations(&self, alone: StepAlone) -> f64 {
        (alone.seconds * alone.threads as f64 / self.planned.plan.predicted_seconds).max(1.0)
    }

    /// Largest share of the work of any rank.
    fn share(&self, ranks: usize) -> f64 {
        if ranks == 1 {
            return 1.0;
        }
        let lines = self.planned.plan.largest_share(ranks);
        let count = self.planned.radii.count() as f64;
        let expected = count * lines;
        // Expected maximum over the ranks of the number of spheres, whose standard deviation is the square root of its
        // mean.
        let most = expected + (2.0 * (ranks as f64).ln() * expected).sqrt();
        self.of_grid * lines + (1.0 - self.of_grid) * (most.max(1.0) / count).min(1.0)
    }

    /// Seconds of communication of a rank of so many threads in an evaluation.
    fn exchange(&self, ranks: usize, threads: usize) -> f64 {
        NODE.network(ranks, threads).seconds(self.traffic(ranks))
    }

    /// Data that a rank sends in an evaluation.
    fn traffic(&self, ranks: usize) -> Traffic {
        self.planned.plan.traffic(self.planned.radii.kinds(), ranks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{PeriodicBox, Vector};

    fn scaling(count: u64, edge: f64) -> Scaling {
        let force = Vector::new(0.0, 0.0, -1.0);
        let spheres = Species { force, ..Species::new("spheres", 1.0, count) };
        let cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
        Scaling::of(&Model::new(Parameters::new(cell, 1.0, vec![spheres], 0.1, 10)).unwrap()).unwrap()
    }

    /// 20,000 spheres at 12%.
    fn counted() -> Scaling {
        scaling(20_000, 88.70)
    }

    #[test]
    fn one_rank_takes_the_time_that_it_takes() {
        for threads in [1, 2, 16] {
            let alone = StepAlone { seconds: 0.07, threads };
            let found = [counted().seconds(alone, 1), counted().efficiency(alone, 1)];
            assert_eq!(found.map(f64::to_bits), [0.07_f64, 1.0].map(f64::to_bits));
        }
    }

    /// Within 35% of the counts of `fcm-solve bench` on one machine, which leave out the messages of barriers.
    #[test]
    fn bytes_and_messages_are_those_counted() {
        let scaling = counted();
        for (ranks, megabytes, messages) in
            [(2, 8.24, 10.0), (4, 6.32, 20.0), (8, 4.04, 22.0), (16, 1.85, 40.0), (32, 1.53, 74.0), (64, 1.23, 76.0)]
        {
            let Traffic { bytes, messages: found } = scaling.traffic(ranks);
            let bytes = bytes / 1e6;
            assert!((bytes / megabytes - 1.0).abs() < 0.35, "{bytes} for {megabytes} MB on {ranks} ranks");
            assert!((found / messages - 1.0).abs() < 0.3, "{found} for {messages} on {ranks} ranks");
        }
    }

    /// Up to the worthwhile number of ranks, each doubling shortens a step, and never by more than half.
    #[test]
    fn a_step_gets_shorter_with_the_ranks_while_they_are_worth_it() {
        for (scaling, seconds) in [(counted(), 0.07), (scaling(200_000, 191.0), 0.8), (scaling(300, 21.9), 1e-3)] {
            let alone = StepAlone { seconds, threads: 1 };
            let worth = scaling.ranks_worth(alone);
            assert!(scaling.efficiency(alone, worth) >= WORTH);
            assert!((worth + 1..3 * worth).all(|ranks| scaling.efficiency(alone, ranks) < WORTH), "{worth}");
            let powers: Vec<usize> = (0..20).map(|power| 1 << power).take_while(|&ranks| ranks <= worth).collect();
            for pair in powers.windows(2) {
                let [few, many] = [pair[0], pair[1]].map(|ranks| scaling.seconds(alone, ranks));
                assert!(many < few && many >= 0.5 * few, "{few} on {pair:?} ranks becomes {many}");
            }
        }
    }

    #[test]
    fn more_spheres_are_worth_more_ranks() {
        let worth = |count, edge, seconds| scaling(count, edge).ranks_worth(StepAlone { seconds, threads: 1 });
        let found = [worth(300, 21.9, 1e-3), worth(20_000, 88.7, 0.07), worth(200_000, 191.0, 0.8)];
        assert!(found.is_sorted_by(|few, many| few < many), "{found:?}");
    }
}
