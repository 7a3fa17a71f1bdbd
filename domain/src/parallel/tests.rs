#![allow(clippy::float_cmp, reason = "seconds of these tests are whole")]

use super::*;
use rayon::prelude::*;
use std::cell::Cell;
use std::time::Duration;

thread_local! {
    /// Seconds that the work of a test claims to have taken.
    static NOW: Cell<u64> = const { Cell::new(0) };
}

fn clock() -> Duration {
    Duration::from_secs(NOW.get())
}

fn work(seconds: u64) {
    NOW.set(NOW.get() + seconds);
}

/// A profile of work on a pool of one thread.
fn measured(computation: impl FnOnce() + Send) -> ParallelProfile {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| measure(clock, computation)).1
}

/// Calls a function on pools of several numbers of threads.
pub(super) fn on_threads(check: impl Fn(usize) + Sync) {
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| check(threads));
    }
}

fn two_stages() {
    work(1);
    let mut stage = stage("first");
    work(2);
    (0..10).into_par_iter().measured().for_each(|i| work(if i == 9 { 7 } else { 1 }));
    work(4);
    stage.next("second");
    (0..4).into_par_iter().moving(800).for_each(|_| work(5));
    work(3);
}

#[test]
fn seconds_are_counted_inside_and_outside_of_loops() {
    let profile = measured(two_stages);
    let of = |name: &str| profile.stages().iter().find(|stage| stage.name == name).unwrap();
    assert_eq!([of("other"), of("first"), of("second")].map(|stage| stage.serial), [1.0, 6.0, 3.0]);
    assert_eq!([of("other"), of("first"), of("second")].map(StageProfile::parallel), [0.0, 16.0, 20.0]);
    let [first, second] = [&of("first").loops[0], &of("second").loops[0]];
    assert_eq!((first.runs, first.tasks, first.work, first.largest), (1, 10, 16.0, 7.0));
    assert_eq!((second.tasks, second.bytes), (4, 800));
    assert!((first.imbalance() - 7.0 / 1.6).abs() < 1e-15, "{}", first.imbalance());
    assert_eq!((profile.serial(), profile.seconds()), (10.0, 46.0));
    let longest = profile.pieces()[0];
    assert_eq!((longest.stage, longest.seconds), ("first", 4.0));
    let [after, before] = longest.between();
    assert!(after.starts_with("domain/src/parallel/tests.rs:") && before == "start of second", "{after} {before}");
}

#[test]
fn a_loop_on_more_threads_is_bounded_by_its_largest_task_and_by_memory() {
    let profile = measured(two_stages);
    let machine = Machine { cores: 1, bandwidth_of_one: 1e9, bandwidth: 1e9, wake_up: 0.0 };
    assert_eq!(profile.seconds_on(1, &machine), 46.0);
    assert_eq!(profile.seconds_on(2, &machine), 10.0 + 8.0 + 10.0);
    assert_eq!(profile.seconds_on(4, &machine), 10.0 + 7.0 + 5.0);
    let slow = Machine { bandwidth_of_one: 20.0, bandwidth: 40.0, cores: 2, ..machine };
    assert_eq!(profile.seconds_on(2, &slow), 10.0 + 8.0 + 20.0);
    let slow = Machine { wake_up: 1.0, ..machine };
    assert_eq!(profile.seconds_on(4, &slow), 10.0 + 7.0 + 5.0 + 4.0);
}

#[test]
fn runs_of_different_numbers_of_tasks_have_no_largest_task_below_the_mean() {
    let profile = measured(|| {
        for tasks in [1_u32, 9] {
            (0..tasks).into_par_iter().measured().for_each(|_| work(tasks.into()));
        }
    });
    let of_loop = &profile.stages()[0].loops[0];
    assert_eq!((of_loop.runs, of_loop.tasks, of_loop.largest, of_loop.mean), (2, 10, 10.0, 10.0));
    assert_eq!(profile.clone().least(&profile).stages()[0].loops[0].imbalance(), 1.0);
}

/// A loop in a task of another one belongs to that task.
#[test]
fn nested_loops_and_stages_are_not_counted_twice() {
    let profile = measured(|| {
        (0..3).into_par_iter().measured().for_each(|_| {
            let _inner = stage("inner");
            (0..2).into_par_iter().measured().for_each(|_| work(1));
        });
    });
    let [other] = profile.stages() else { panic!("{:?}", profile.stages()) };
    assert_eq!((other.serial, other.parallel(), other.loops.len()), (0.0, 6.0, 1));
}

#[test]
fn results_are_the_same_whether_loops_are_measured() {
    let computed = || {
        let squares: Vec<u64> = (0..5000_u32).into_par_iter().map(|i| u64::from(i) * 7919).measured().collect();
        let mut sorted = squares.clone();
        sort(sorted.len(), || sorted.par_sort_unstable_by_key(|&value| value % 1009));
        let rows = (0..sorted.len()).into_par_iter().measured();
        let evens = rows.filter(|row| sorted[*row].is_multiple_of(2)).collect::<Vec<_>>();
        (sorted, evens)
    };
    assert_eq!(computed(), measure(wall_clock, computed).0);
}
