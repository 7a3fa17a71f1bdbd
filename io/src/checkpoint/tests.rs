use super::*;
use domain::{Particles, Vector};

fn state(step: u64) -> State {
    let mut particles = Particles::default();
    for id in 0..7 {
        particles.push(id, Vector::splat(0.1 * id as f64), 1.0 + id as f64, (id % 2) as u32);
    }
    particles.steps[3] = [1, -2, 3];
    particles.vectors("past velocity 1")[2] = Vector::new(f64::MIN_POSITIVE, -0.0, 1.0 / 3.0);
    particles.column("stresslet", 5).values[4] = 1e-300;
    State { step, strain: 0.1 + 0.2, plan: "direct, 64 x 64 x 64".into(), particles, statistics: vec![1, 0, 255] }
}

#[test]
fn what_is_written_is_read_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    Checkpoints::of(folder.path()).write(&state(12)).unwrap();
    let (found, damaged) = Checkpoints::of(folder.path()).latest().unwrap();
    assert_eq!(found, state(12));
    assert_eq!(found.particles.columns[0].values[7].to_bits(), (-0.0_f64).to_bits());
    assert!(damaged.is_empty());
}

#[test]
fn the_last_two_are_kept_and_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    for step in [0, 5, 10, 100_000] {
        Checkpoints::of(folder.path()).write(&state(step)).unwrap();
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["checkpoint-0000000010.bin", "checkpoint-0000100000.bin"]);
}

#[test]
fn any_damage_to_the_last_one_is_seen_and_the_one_before_serves() {
    let folder = tempfile::tempdir().unwrap();
    Checkpoints::of(folder.path()).write(&state(1)).unwrap();
    let last = Checkpoints::of(folder.path()).write(&state(2)).unwrap();
    let whole = std::fs::read(&last).unwrap();
    let mut changed = whole.clone();
    changed[whole.len() / 2] ^= 1;
    for damaged in [&whole[..whole.len() - 1], &whole[..10], &[], &changed] {
        std::fs::write(&last, damaged).unwrap();
        let (found, errors) = Checkpoints::of(folder.path()).latest().unwrap();
        assert_eq!(found.step, 1);
        assert!(errors[0].to_string().contains("checkpoint-0000000002.bin is damaged"), "{}", errors[0]);
    }
}

#[test]
fn a_folder_without_checkpoints_says_so() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Checkpoints::of(folder.path()).latest().unwrap_err().to_string().contains("stopped before the first"));
    assert!(Checkpoints::of(&folder.path().join("nowhere")).latest().is_err());
    std::fs::write(folder.path().join("checkpoint-0000000002.bin"), "?").unwrap();
    assert!(Checkpoints::of(folder.path()).latest().unwrap_err().to_string().contains("is damaged"));
}
