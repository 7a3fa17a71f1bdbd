//! Ranks that share an evaluation, and the network between them.

use crate::plan::Plan;
use crate::plan::problem::Precision;
use domain::{ExpectedCounts, Place};

// Counted by `scripts/validate scale`, which fails if they differ.

/// Sums and ends of exchanges in an evaluation: each has as many messages as a tree of ranks has levels.
const SUMS: f64 = 4.0;

/// Messages of a rank to each rank within reach in an evaluation.
const EXCHANGES: f64 = 8.0;

/// Bytes sent in an evaluation for each image of a sphere on another rank: lists, loads and motions.
const IMAGE: f64 = 227.0;

/// Ranks on several machines for which a plan is made. Where bytes cost more than pairs, coarser grids with longer
/// cutoffs are faster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Network {
    /// Number of ranks.
    pub ranks: usize,
    /// Number of threads of each rank.
    pub threads: usize,
    /// Bytes that a rank sends in a second while all ranks send.
    pub bandwidth: f64,
    /// Seconds of a message.
    pub latency: f64,
}

/// Data that a rank sends in an evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traffic {
    /// Bytes.
    pub bytes: f64,
    /// Number of messages.
    pub messages: f64,
}

impl Network {
    /// Seconds in which a rank sends its data.
    pub fn seconds(&self, traffic: Traffic) -> f64 {
        traffic.bytes / self.bandwidth + traffic.messages * self.latency
    }

    /// Seconds of an evaluation by a plan for a single core: equal shares of its work, and what is sent.
    pub fn evaluation(&self, plan: &Plan, kinds: &[(f64, usize)]) -> f64 {
        plan.predicted_seconds / (self.ranks * self.threads).max(1) as f64
            + self.seconds(plan.traffic(kinds, self.ranks))
    }
}

impl Plan {
    /// Data that one of so many ranks sends in an evaluation of spheres of these radii and numbers: the grid, in both
    /// directions along each axis that is divided among ranks, and images.
    #[must_use]
    pub fn traffic(&self, kinds: &[(f64, usize)], ranks: usize) -> Traffic {
        if ranks <= 1 {
            return Traffic { bytes: 0.0, messages: 0.0 };
        }
        let place = self.place(ranks);
        let others = place.table().map(|parts| 1.0 - 1.0 / parts as f64).iter().sum::<f64>();
        let point = if self.precision == Precision::Single { 12.0 } else { 24.0 };
        let points: f64 = self.grid.iter().map(|&n| n as f64).product();
        let expected = ExpectedCounts::new(self.edges, kinds, &place);
        let images = expected.present(self.halo()) - expected.owned();
        let levels = f64::from(ranks.next_power_of_two().ilog2());
        Traffic {
            bytes: 2.0 * point * points * self.largest_share(ranks) * others + IMAGE * images,
            messages: SUMS * levels + EXCHANGES * self.ranks_within_reach(&place),
        }
    }

    /// Largest fraction of the grid's lines that one of so many ranks owns.
    #[must_use]
    pub fn largest_share(&self, ranks: usize) -> f64 {
        let place = self.place(ranks);
        let largest = |d: usize| place.lines()[d].div_ceil(place.table()[d]) as f64 / place.lines()[d] as f64;
        largest(0) * largest(1)
    }

    /// Number of ranks within reach of a rank.
    fn ranks_within_reach(&self, place: &Place) -> f64 {
        let within = |d: usize| {
            let parts = place.table()[d] as f64;
            (2.0 * (self.halo() * parts / self.edges[d + 1]).ceil() + 1.0).min(parts)
        };
        within(0) * within(1) - 1.0
    }

    /// Distance up to which a rank has images of others' spheres.
    fn halo(&self) -> f64 {
        self.cutoff().max(self.support.reach)
    }

    fn place(&self, ranks: usize) -> Place {
        Place::of(ranks, 0, [self.grid[1], self.grid[2]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::problem::Problem;
    use domain::Vector;

    /// 20,000 spheres at 12%, for one rank or for others with a network.
    fn planned(network: Option<Network>) -> Plan {
        let edge = 88.7;
        Plan::choose(&Problem {
            edges: Vector::splat(edge),
            volume: edge.powi(3),
            shortest_vector: edge,
            radii: vec![(1.0, 20_000)],
            network,
            ..Problem::of_five_spheres()
        })
        .unwrap()
    }

    /// A network that is slow against the work of a rank makes the grid coarser and the cutoff longer, within the
    /// tolerance, and never the evaluation slower.
    #[test]
    fn slower_networks_have_coarser_grids_for_the_same_tolerance() {
        let kinds = [(1.0, 20_000)];
        let on = |bandwidth| Network { ranks: 64, threads: 1, bandwidth, latency: 1.5e-6 };
        let usual = planned(None);
        let plans = [1e13, 1e9, 1e8, 1e7].map(|bandwidth| planned(Some(on(bandwidth))));
        assert_eq!(plans[0], usual, "on a network without cost");
        let points = plans.each_ref().map(|plan| plan.grid.iter().product::<usize>());
        assert!(points.is_sorted_by(|a, b| a >= b) && points[3] < points[1] && points[1] <= points[0], "{points:?}");
        for (plan, bandwidth) in plans.iter().zip([1e13, 1e9, 1e8, 1e7]) {
            assert!(plan.predicted_error <= 1e-3 && plan.cutoff() >= usual.cutoff(), "{plan:?}");
            let seconds = |plan: &Plan| on(bandwidth).evaluation(plan, &kinds);
            assert!(seconds(plan) <= seconds(&usual));
        }
        assert!(plans[3].cutoff() > 1.2 * usual.cutoff(), "{:?}", plans[3].split);
    }

    #[test]
    fn a_single_rank_sends_nothing() {
        let nothing = planned(None).traffic(&[(1.0, 20_000)], 1);
        assert_eq!(nothing, Traffic { bytes: 0.0, messages: 0.0 });
    }
}
