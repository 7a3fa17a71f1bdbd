use super::{Comm, Incoming, Outgoing};

const RANKS: [usize; 8] = [1, 2, 3, 4, 7, 13, 16, 64];

#[test]
fn all_to_all_is_a_transposition() {
    for ranks in RANKS {
        let tables = Comm::threads(ranks, |comm| {
            let send: Vec<u64> = (0..ranks as u64).map(|to| 100 * comm.rank() as u64 + to).collect();
            let mut receive = vec![0; ranks];
            let ones = vec![1; ranks];
            comm.send_receive(
                Outgoing { values: &send, counts: &ones },
                Incoming { room: &mut receive, counts: &ones },
            );
            receive
        });
        for (to, row) in tables.iter().enumerate() {
            let expected: Vec<u64> = (0..ranks).map(|from| (100 * from + to) as u64).collect();
            assert_eq!(*row, expected);
        }
    }
}

#[test]
fn lists_of_unequal_length_arrive_whole() {
    for ranks in RANKS {
        Comm::threads(ranks, |comm| {
            let me = comm.rank();
            let lists: Vec<Vec<f64>> = (0..ranks).map(|to| vec![(me * 10 + to) as f64; me + 2 * to]).collect();
            for (from, list) in comm.exchange(&lists).into_iter().enumerate() {
                assert_eq!(list, vec![(from * 10 + me) as f64; from + 2 * me]);
            }
        });
    }
}

/// A rank that has nothing for most others sends them nothing: its messages are as many as its lists.
#[test]
fn only_lists_that_are_not_empty_are_sent() {
    for ranks in RANKS {
        Comm::threads(ranks, |comm| {
            let (me, next) = (comm.rank(), (comm.rank() + 1) % ranks);
            let before = (me + ranks - 1) % ranks;
            let mut lists = vec![Vec::new(); ranks];
            lists[next] = vec![me as u64; me + 1];
            let received = comm.exchange(&lists);
            for (from, list) in received.iter().enumerate() {
                assert_eq!(list, &if from == before { vec![before as u64; before + 1] } else { Vec::new() });
            }
            let counts: Vec<usize> = lists.iter().map(Vec::len).collect();
            let arriving = comm.exchange_counts(&counts);
            let mut room = vec![0; before + 1];
            let sent = Outgoing { values: &lists.concat(), counts: &counts };
            comm.send_receive(sent, Incoming { room: &mut room, counts: &arriving });
            assert_eq!(room, vec![before as u64; before + 1]);
            assert_eq!(comm.messages_sent(), if ranks == 1 { 0 } else { 3 });
        });
    }
}

/// Messages of a sum are those of a tree, not one for each rank.
#[test]
fn sums_take_as_many_messages_as_a_tree_has_levels() {
    for (ranks, levels) in [(1, 0), (2, 1), (7, 3), (64, 6)] {
        Comm::threads(ranks, |comm| {
            comm.sum(&mut [1.0, 2.0]);
            assert_eq!(comm.messages_sent(), levels);
        });
    }
}

#[test]
fn lists_of_all_ranks_are_kept_apart() {
    for ranks in RANKS {
        Comm::threads(ranks, |comm| {
            let lists = comm.all_gather_lists(&vec![comm.rank() as u32; comm.rank() % 3]);
            let expected: Vec<_> = (0..ranks).map(|rank| vec![rank as u32; rank % 3]).collect();
            assert_eq!(lists, expected);
        });
    }
}

#[test]
fn sums_are_the_same_bits_everywhere() {
    for ranks in RANKS {
        let sums = Comm::threads(ranks, |comm| {
            let mut values = [0.1 * (comm.rank() + 1) as f64, 1.0];
            comm.sum(&mut values);
            values
        });
        let by_hand = (1..=ranks).map(|r| 0.1 * r as f64).reduce(|a, b| a + b).unwrap();
        assert!(sums.iter().all(|s| s[0].to_bits() == by_hand.to_bits() && s[1] as usize == ranks));
    }
}

/// Also for more values than are sent to every rank directly.
#[test]
fn many_sums_have_the_bits_of_few() {
    let of_rank = |rank: usize| (0..10_007).map(move |k| 1.0 / (k * 17 % 101 + rank + 1) as f64);
    for ranks in RANKS {
        let expected: Vec<f64> = (0..ranks)
            .map(|rank| of_rank(rank).collect())
            .reduce(|a: Vec<f64>, b| a.iter().zip(b).map(|(a, b)| a + b).collect())
            .unwrap();
        Comm::threads(ranks, |comm| {
            let mut values: Vec<f64> = of_rank(comm.rank()).collect();
            comm.sum(&mut values);
            assert!(values == expected);
        });
    }
}

#[test]
fn a_split_keeps_the_order_and_the_groups_apart() {
    Comm::threads(7, |comm| {
        let part = comm.split(comm.rank() % 3);
        let mut count = [1.0];
        part.sum(&mut count);
        assert_eq!(part.rank(), comm.rank() / 3);
        assert_eq!(count[0] as usize, part.size());
        let members = part.all_gather(&[comm.rank() as u64]);
        assert!(members.iter().all(|&m| m as usize % 3 == comm.rank() % 3));
        assert!(members.is_sorted());
    });
}

#[test]
fn broadcast_and_gather_go_through_the_first_rank() {
    for ranks in RANKS {
        Comm::threads(ranks, |comm| {
            let text = if comm.is_first() { "a scene" } else { "" };
            assert_eq!(comm.broadcast_text(text), "a scene");
            let gathered = comm.gather(&vec![comm.rank() as u64; comm.rank() + 1]);
            let expected: Vec<u64> = (0..ranks as u64).flat_map(|r| vec![r; r as usize + 1]).collect();
            assert_eq!(gathered, if comm.is_first() { expected } else { Vec::new() });
        });
    }
}

#[test]
fn a_failure_on_one_rank_is_everybodys() {
    for ranks in RANKS {
        let last = ranks - 1;
        let results = Comm::threads(ranks, |comm| {
            let fine: Result<u32, String> = comm.agree(Ok::<_, String>(1)).map_err(|f| f.to_string());
            assert_eq!(fine, Ok(1));
            comm.agree(if comm.rank() == last { Err("disk full") } else { Ok(()) })
        });
        for result in results {
            let failure = result.expect_err("one rank failed");
            assert_eq!((failure.rank, failure.message.as_str()), (last, "disk full"));
        }
    }
}

#[test]
#[should_panic(expected = "a rank panicked")]
fn a_panic_does_not_hang_the_others() {
    Comm::threads(3, |comm| {
        assert!(comm.rank() != 1, "this rank gives up");
        comm.barrier();
    });
}

#[test]
fn ranks_on_one_machine_write_into_each_others_memory() {
    for ranks in RANKS {
        Comm::threads(ranks, |comm| {
            let me = comm.rank();
            let window = comm.window(ranks * size_of::<u64>());
            let number = |owner: usize, place: usize| unsafe { window.of::<u64>(owner).unwrap().add(place) };
            assert_eq!(unsafe { number(me, 0).read() }, 0);
            window.barrier();
            // Ranks 0 and 1, 2 and 3, and so on are on one machine.
            let reached: Vec<usize> = (0..ranks).filter(|&rank| window.of::<u64>(rank).is_some()).collect();
            assert_eq!(reached, (0..ranks).filter(|rank| rank / 2 == me / 2).collect::<Vec<_>>());
            assert_eq!(window.is_divided(), ranks > 2);
            for &other in &reached {
                unsafe { number(other, me).write(10 * other as u64 + me as u64) };
            }
            window.barrier();
            for &other in &reached {
                assert_eq!(unsafe { number(me, other).read() }, 10 * me as u64 + other as u64);
            }
        });
    }
}

#[test]
fn ranges_leave_places_free() {
    Comm::threads(3, |comm| {
        let me = comm.rank();
        let send: Vec<u32> = (0..6).map(|i| (10 * me + i) as u32).collect();
        let mut receive = [99_u32; 8];
        // No values go to the rank itself.
        let of = |rank: usize, wide: usize| if rank == me { 0..0 } else { wide * rank..wide * rank + 2 };
        let [from, into] = [2, 3].map(|wide| (0..3).map(|rank| of(rank, wide)).collect::<Vec<_>>());
        comm.all_to_all_ranges((&send, &from), (&mut receive, &into));
        for other in (0..3).filter(|&other| other != me) {
            assert_eq!(receive[3 * other..][..2], [0, 1].map(|i| (10 * other + 2 * me + i) as u32));
        }
        assert_eq!(receive[3 * me], 99);
        assert_eq!((receive[2], receive[5]), (99, 99));
    });
}
