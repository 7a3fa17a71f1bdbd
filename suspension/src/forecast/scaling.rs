//! Scaling of the time of a step with the number of ranks.

use crate::evaluation::prepared::Planned;
use crate::flow::open_cell::follows;
use crate::model::Model;
use domain::{ExpectedCounts, Place};
use fcm::Precision;

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

/// Sums and ends of exchanges in an evaluation, as counted: each has as many messages as a tree of ranks has levels.
const SUMS: f64 = 4.0;

/// Messages of a rank to each rank within reach in an evaluation, as counted.
const EXCHANGES: f64 = 8.0;

/// Bytes sent in an evaluation for each image of a sphere on another rank, as counted: lists, loads and motions.
const IMAGE: f64 = 190.0;

/// Parallel efficiency from which a number of ranks is worthwhile.
const WORTH: f64 = 0.5;

/// Largest number of ranks considered, a power of two.
const MOST: usize = 1 << 20;

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
        let lines = self.largest_share(ranks);
        let count = self.planned.radii.count() as f64;
        let expected = count * lines;
        // Expected maximum over the ranks of the number of spheres, whose standard deviation is the square root of its
        // mean.
        let most = expected + (2.0 * (ranks as f64).ln() * expected).sqrt();
        self.of_grid * lines + (1.0 - self.of_grid) * (most.max(1.0) / count).min(1.0)
    }

    /// Seconds of communication of a rank of so many threads in an evaluation.
    fn exchange(&self, ranks: usize, threads: usize) -> f64 {
        if ranks == 1 {
            return 0.0;
        }
        let of_node = (NODE.cores / threads).clamp(1, ranks) as f64;
        let away = 1.0 - of_node / ranks as f64;
        let of_byte = of_node * (away / NODE.port + COPIES / NODE.memory);
        self.bytes(ranks) * of_byte + self.messages(ranks) * LATENCY
    }

    /// Number of messages that a rank sends in an evaluation.
    fn messages(&self, ranks: usize) -> f64 {
        SUMS * f64::from(ranks.next_power_of_two().ilog2()) + EXCHANGES * self.neighbours(ranks)
    }

    /// Number of ranks within reach of a rank.
    fn neighbours(&self, ranks: usize) -> f64 {
        let (plan, table) = (&self.planned.plan, self.place(ranks).table());
        let within = |d: usize| {
            let parts = table[d] as f64;
            (2.0 * (self.reach() * parts / plan.edges[d + 1]).ceil() + 1.0).min(parts)
        };
        within(0) * within(1) - 1.0
    }

    /// Distance up to which a rank has images of others' spheres.
    fn reach(&self) -> f64 {
        self.planned.plan.cutoff().max(self.planned.plan.support.reach)
    }

    /// Bytes that a rank sends in an evaluation: the grid, in both directions along each axis that is divided among
    /// ranks, and images.
    fn bytes(&self, ranks: usize) -> f64 {
        let plan = &self.planned.plan;
        let place = self.place(ranks);
        let others = place.table().map(|parts| 1.0 - 1.0 / parts as f64).iter().sum::<f64>();
        let point = if plan.precision == Precision::Single { 12.0 } else { 24.0 };
        let points: f64 = plan.grid.iter().map(|&n| n as f64).product();
        let expected = ExpectedCounts::new(plan.edges, self.planned.radii.kinds(), &place);
        let images = expected.present(self.reach()) - expected.owned();
        2.0 * point * points * self.largest_share(ranks) * others + IMAGE * images
    }

    /// Largest fraction of the grid's lines that a rank owns.
    fn largest_share(&self, ranks: usize) -> f64 {
        let place = self.place(ranks);
        let largest = |d: usize| place.lines()[d].div_ceil(place.table()[d]) as f64 / place.lines()[d] as f64;
        largest(0) * largest(1)
    }

    fn place(&self, ranks: usize) -> Place {
        Place::of(ranks, 0, [self.planned.plan.grid[1], self.planned.plan.grid[2]])
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
            let bytes = scaling.bytes(ranks) / 1e6;
            assert!((bytes / megabytes - 1.0).abs() < 0.35, "{bytes} for {megabytes} MB on {ranks} ranks");
            let found = scaling.messages(ranks);
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
