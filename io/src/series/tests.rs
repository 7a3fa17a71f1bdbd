use super::*;

#[test]
fn rows_go_to_both_files_and_none_is_doubled() {
    let folder = tempfile::tempdir().unwrap();
    let provenance =
        Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "none".into(), ranks: 1, seed: 2 };
    let quantities =
        [Quantity::number("gap", "length"), Quantity::vectors("mean", "length/time", &["a".into(), "b".into()])];
    let row = |step: u64| vec![vec![step as f64], (0..6).map(|i| 0.1 * f64::from(i) + step as f64).collect()];
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance, &quantities, 4).unwrap();
    for step in 0..4 {
        series.append((step, 0.1 * step as f64), &row(step)).unwrap();
    }
    drop(series);
    let csv = folder.path().join("observables.csv");
    let whole = std::fs::read_to_string(&csv).unwrap();
    assert!(whole.starts_with("step,time,gap,mean_x[a],mean_y[a],mean_z[a],mean_x[b],mean_y[b],mean_z[b]\n"));
    std::fs::write(&csv, whole.clone() + "4,0.").unwrap(); // cut short
    let mut series = Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, (1, 9)).unwrap();
    assert_eq!(series.last_step().unwrap(), Some(1));
    for step in 2..4 {
        series.append((step, 0.1 * step as f64), &row(step)).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    drop(series);
    let file = hdf5::File::open(folder.path().join("observables.h5")).unwrap();
    let means: Vec<f64> = file.dataset("observables/mean/value").unwrap().read_raw().unwrap();
    assert_eq!(means, (0..4).flat_map(|step| row(step)[1].clone()).collect::<Vec<_>>());
}

#[test]
fn each_of_the_two_files_is_mended_from_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let provenance =
        Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "none".into(), ranks: 1, seed: 2 };
    let quantities = [Quantity::number("gap", "length"), Quantity::vectors("mean", "length/time", &["a".into()])];
    let row = |step: u64| vec![vec![1.0 / (3.0 + step as f64)], vec![f64::NAN, -0.0, 1e300 * step as f64]];
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance, &quantities, 4).unwrap();
    for step in 0..4 {
        series.append((step, 0.1 * step as f64), &row(step)).unwrap();
    }
    drop(series);
    let (csv, h5) = (folder.path().join("observables.csv"), folder.path().join("observables.h5"));
    let (whole, frames) = (std::fs::read_to_string(&csv).unwrap(), std::fs::read(&h5).unwrap());
    let resume = || Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, (3, 4)).unwrap();
    let second = whole.lines().nth(2).unwrap();
    for damaged in ["", "step,time\n", &whole[..50], &whole.replace(second, "?"), &whole.replace("0.1", "0.7")] {
        std::fs::write(&csv, damaged).unwrap();
        assert!(resume().damage().is_empty());
        assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    }
    std::fs::remove_file(&csv).unwrap();
    resume();
    assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    std::fs::remove_file(&h5).unwrap();
    assert_eq!(resume().last_step().unwrap(), Some(3));
    assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    let number = 0.25_f64.to_le_bytes();
    let place = frames.windows(8).position(|bytes| bytes == number).unwrap();
    let mut damaged = frames;
    damaged[place + 3] ^= 8;
    std::fs::write(&h5, damaged).unwrap();
    assert_eq!(resume().damage()[0].elements, ["observables/gap"]);
    assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
}
