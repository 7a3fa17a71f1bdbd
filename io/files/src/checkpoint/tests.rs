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
    State {
        step,
        strain: 0.1 + 0.2,
        plan: "direct, 64 x 64 x 64".into(),
        particles,
        statistics: vec![vec![1, 0, 255], Vec::new(), vec![7; 5], vec![0]],
    }
}

fn record() -> SceneRecord {
    let scene = scene::Scene::parse(scene::Template::named("settling").unwrap().text, "settling", &[]).unwrap();
    SceneRecord::new(scene.text(), scene.kind().output().unwrap())
}

#[test]
fn what_is_written_is_read_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    Checkpoints::write(&Manifest::of_test(folder.path()), &state(12), &record(), &Comm::alone()).unwrap();
    let Latest { state: found, scene, damaged } = Checkpoints::of(folder.path()).latest(&Comm::alone()).unwrap();
    assert_eq!((&found, scene), (&state(12), Some(record())));
    assert_eq!(found.particles.columns[0].values[7].to_bits(), (-0.0_f64).to_bits());
    assert!(damaged.is_empty());
}

/// Scalars are read bit for bit on all ranks; a state without scalars is stored as in versions before scalars.
#[test]
fn scalars_are_read_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let mut with = state(4);
    with.particles.scalars.set("strokes of a pump", &[1.0 / 3.0, -0.0, f64::NEG_INFINITY]);
    with.particles.scalars.set("seed", &[f64::from_bits(0x7ff8_0000_0000_0001)]);
    for (state, is_there) in [(state(2), false), (with, true)] {
        Checkpoints::write(&Manifest::of_test(folder.path()), &state, &record(), &Comm::alone()).unwrap();
        let bytes = std::fs::read(Checkpoints::of(folder.path()).path(state.step)).unwrap();
        assert_eq!(bytes.windows(7).any(|word| word == b"scalars"), is_there);
        assert_eq!(bytes.len(), bytes_of(&state, &record()));
        for scalars in
            Comm::threads(3, |comm| Checkpoints::of(folder.path()).latest(&comm).unwrap().state.particles.scalars)
        {
            let bits = |scalars: &domain::Scalars| {
                let bits = |scalar: &domain::Scalar| {
                    (scalar.name.clone(), scalar.values.iter().map(|value| value.to_bits()).collect::<Vec<_>>())
                };
                scalars.iter().map(bits).collect::<Vec<_>>()
            };
            assert_eq!(bits(&scalars), bits(&state.particles.scalars));
        }
    }
}

/// Pieces of the statistics of a rank.
fn pieces(whole: &State, comm: &Comm) -> Vec<Vec<u8>> {
    whole.statistics.iter().skip(comm.rank()).step_by(comm.size()).cloned().collect()
}

/// Statistics of a single piece are stored without a list of pieces, as in files of versions before pieces.
#[test]
fn one_piece_is_as_it_was() {
    for statistics in [Vec::new(), vec![vec![3, 4]]] {
        let folder = tempfile::tempdir().unwrap();
        let state = State { statistics, ..state(2) };
        Checkpoints::write(&Manifest::of_test(folder.path()), &state, &record(), &Comm::alone()).unwrap();
        let bytes = std::fs::read(Checkpoints::of(folder.path()).path(2)).unwrap();
        assert!(!bytes.windows(6).any(|word| word == b"pieces"));
        assert_eq!(bytes.len(), bytes_of(&state, &record()));
        assert_eq!(Checkpoints::of(folder.path()).latest(&Comm::alone()).unwrap().state, state);
    }
}

/// The file has the same bytes for any distribution of the particles, and is read in shares that add up to the whole.
#[test]
fn ranks_write_one_file_and_read_shares_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, alone) = (state(3), folder.path().join("alone"));
    std::fs::create_dir(&alone).unwrap();
    Checkpoints::write(&Manifest::of_test(&alone), &whole, &record(), &Comm::alone()).unwrap();
    for ranks in [1, 2, 3, 7, 9] {
        let shares = Comm::threads(ranks, |comm| {
            let rows: Vec<usize> = (0..7).rev().filter(|row| row % ranks == comm.rank()).collect();
            let statistics = pieces(&whole, &comm);
            let share = State { particles: whole.particles.selected(&rows), statistics, ..whole.clone() };
            Checkpoints::write(&Manifest::of_test(folder.path()), &share, &record(), &comm).unwrap();
            let found = Checkpoints::of(folder.path()).latest(&comm).unwrap().state;
            assert_eq!(found.statistics, pieces(&whole, &comm));
            found
        });
        let bytes = [folder.path(), &alone].map(|folder| std::fs::read(Checkpoints::of(folder).path(3)).unwrap());
        assert!(bytes[0] == bytes[1], "{ranks} ranks");
        let ids: Vec<u64> = shares.iter().flat_map(|share| share.particles.ids.clone()).collect();
        assert_eq!(ids, whole.particles.ids);
        let most = shares.iter().map(|share| share.particles.len()).max();
        assert_eq!(most, Some(7_usize.div_ceil(ranks)));
        for share in &shares {
            share.particles.check().unwrap();
            assert_eq!((share.step, share.strain.to_bits(), &share.plan), (3, whole.strain.to_bits(), &whole.plan));
            let rows: Vec<usize> = share.particles.ids.iter().map(|&id| id as usize).collect();
            assert_eq!(share.particles, whole.particles.selected(&rows));
        }
    }
}

/// Arrays of more rows than an exchange has are read in shares as well, with a number of messages that depends on the
/// bytes, not on the ranks.
#[test]
fn large_files_are_read_in_few_exchanges() {
    let folder = tempfile::tempdir().unwrap();
    let mut whole = state(3);
    (7..150_001).for_each(|id| whole.particles.push(id, Vector::splat(id as f64), 1.0, 0));
    whole.statistics = vec![(0..200_000_u32).map(|byte| byte as u8).collect(), vec![5; 70_000], Vec::new(), vec![1]];
    Checkpoints::write(&Manifest::of_test(folder.path()), &whole, &record(), &Comm::alone()).unwrap();
    let sent = Comm::threads(5, |comm| {
        let before = comm.messages_sent();
        let found = Checkpoints::of(folder.path()).latest(&comm).unwrap().state;
        let ids = domain::block(150_001, 5, comm.rank());
        assert_eq!(found.particles, whole.particles.selected(&ids.collect::<Vec<_>>()));
        assert_eq!(found.statistics, pieces(&whole, &comm));
        comm.messages_sent() - before
    });
    assert!(sent[0] < 200, "{sent:?}");
}

#[test]
fn the_last_two_are_kept_and_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("checkpoint-0000000099.bin"), "of somebody else").unwrap();
    for step in [0, 5, 10, 100_000] {
        Checkpoints::write(&Manifest::of_test(folder.path()), &state(step), &record(), &Comm::alone()).unwrap();
    }
    let mut names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(
        names,
        ["checkpoint-0000000010.bin", "checkpoint-0000000099.bin", "checkpoint-0000100000.bin", "manifest.jsonl"]
    );
}

#[test]
fn any_damage_to_the_last_one_is_seen_and_the_one_before_serves() {
    let folder = tempfile::tempdir().unwrap();
    Checkpoints::write(&Manifest::of_test(folder.path()), &state(1), &record(), &Comm::alone()).unwrap();
    Checkpoints::write(&Manifest::of_test(folder.path()), &state(2), &record(), &Comm::alone()).unwrap();
    let last = Checkpoints::of(folder.path()).path(2);
    let whole = std::fs::read(&last).unwrap();
    let mut changed = whole.clone();
    changed[whole.len() / 2] ^= 1;
    for damaged in [&whole[..whole.len() - 1], &whole[..10], &[], &changed] {
        std::fs::write(&last, damaged).unwrap();
        let Latest { state: found, damaged, .. } = Checkpoints::of(folder.path()).latest(&Comm::alone()).unwrap();
        assert_eq!(found.step, 1);
        assert!(damaged[0].to_string().contains("checkpoint-0000000002.bin is damaged"), "{}", damaged[0]);
    }
}

#[test]
fn a_folder_without_checkpoints_says_so() {
    let folder = tempfile::tempdir().unwrap();
    assert!(
        Checkpoints::of(folder.path())
            .latest(&Comm::alone())
            .unwrap_err()
            .to_string()
            .contains("stopped before the first")
    );
    assert!(Checkpoints::of(&folder.path().join("nowhere")).latest(&Comm::alone()).is_err());
    std::fs::write(folder.path().join("checkpoint-0000000002.bin"), "?").unwrap();
    assert!(Checkpoints::of(folder.path()).latest(&Comm::alone()).unwrap_err().to_string().contains("is damaged"));
}
