//! Measured bandwidth and latency between ranks.

use domain::{Comm, Incoming, Outgoing};
use fcm::Network;
use std::time::Instant;

/// Numbers that a rank sends in an exchange by which the bandwidth is measured: 8 MB.
const NUMBERS: usize = 1 << 20;

/// Number of exchanges, of which the median time counts.
const REPEATS: usize = 9;

/// The present ranks, the bandwidth at which each sends equal parts to all others, as transpositions do, and the
/// latency of a message in a sum over all ranks; `None` for one rank. Collective.
pub fn measured_network(comm: &Comm) -> Option<Network> {
    let ranks = comm.size();
    if ranks == 1 {
        return None;
    }
    let part = (NUMBERS / ranks).max(1);
    let (sent, counts) = (vec![1.0_f64; part * ranks], vec![part; ranks]);
    let mut received = sent.clone();
    let exchange = || {
        let room = Incoming { room: &mut received, counts: &counts };
        comm.send_receive(Outgoing { values: &sent, counts: &counts }, room);
    };
    let of_exchange = median_time(comm, exchange);
    let of_sum = median_time(comm, || comm.sum(&mut [1.0]));
    Some(Network {
        ranks,
        threads: rayon::current_num_threads(),
        bandwidth: (size_of::<f64>() * part * (ranks - 1)) as f64 / of_exchange,
        latency: of_sum / f64::from(ranks.next_power_of_two().ilog2()),
    })
}

/// Median over repetitions of the time of the slowest rank in seconds. Collective.
fn median_time(comm: &Comm, mut once: impl FnMut()) -> f64 {
    let mut times: Vec<f64> = (0..REPEATS)
        .map(|_| {
            comm.barrier();
            let start = Instant::now();
            once();
            start.elapsed().as_secs_f64()
        })
        .collect();
    comm.max(&mut times);
    times.sort_by(f64::total_cmp);
    times[REPEATS / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_ranks_measure_the_same() {
        assert!(measured_network(&Comm::alone()).is_none());
        let found = Comm::threads(3, |comm| measured_network(&comm).unwrap());
        assert!(found.iter().all(|network| network == &found[0]), "{found:?}");
        let Network { ranks, bandwidth, latency, .. } = found[0];
        assert!(ranks == 3 && bandwidth > 1e3 && (0.0..1.0).contains(&latency), "{found:?}");
    }
}
