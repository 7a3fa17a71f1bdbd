use super::*;
use crate::Observables;

fn provenance() -> Provenance {
    Provenance { scene: "a = 1".into(), program: "test 1".into(), plan: "none".into(), ranks: 1, seed: 2 }
}

#[test]
fn rows_go_to_both_files_and_none_is_doubled() {
    let folder = tempfile::tempdir().unwrap();
    let provenance = provenance();
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
    let mut series = Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, 1, 9).unwrap();
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
    let provenance = provenance();
    let quantities = [Quantity::number("gap", "length"), Quantity::vectors("mean", "length/time", &["a".into()])];
    let row = |step: u64| vec![vec![1.0 / (3.0 + step as f64)], vec![f64::NAN, -0.0, 1e300 * step as f64]];
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance, &quantities, 4).unwrap();
    for step in 0..4 {
        series.append((step, 0.1 * step as f64), &row(step)).unwrap();
    }
    drop(series);
    let (csv, h5) = (folder.path().join("observables.csv"), folder.path().join("observables.h5"));
    let (whole, frames) = (std::fs::read_to_string(&csv).unwrap(), std::fs::read(&h5).unwrap());
    let resume = || Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, 3, 4).unwrap();
    let second = whole.lines().nth(2).unwrap();
    for damaged in ["", "step,time\n", &whole[..50], &whole.replace(second, "?"), &whole.replace("0.1", "0.7")] {
        std::fs::write(&csv, damaged).unwrap();
        assert!(resume().damage().is_empty());
        assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    }
    std::fs::remove_file(&csv).unwrap();
    resume();
    assert_eq!(std::fs::read_to_string(&csv).unwrap(), whole);
    let older = Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, 1, 4).unwrap();
    drop(older);
    std::fs::write(&csv, &whole).unwrap();
    assert_eq!(resume().steps().unwrap(), [0, 1, 2, 3], "from the table, where the other is an older copy");
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

#[test]
fn names_with_separators_are_cells_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let provenance = provenance();
    let names = ["silica, 2 um".to_owned(), "a; \"b\"".to_owned()];
    let quantities = [Quantity::vectors("mean", "length/time", &names)];
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance, &quantities, 2).unwrap();
    series.append((0, 0.0), &[vec![1.0; 6]]).unwrap();
    drop(series);
    let csv = std::fs::read_to_string(folder.path().join("observables.csv")).unwrap();
    let lines: Vec<Vec<String>> = csv.lines().map(simulation::csv_words).collect();
    assert_eq!((lines[0].len(), lines[1].len()), (8, 8));
    assert_eq!((lines[0][2].as_str(), lines[0][5].as_str()), ("mean_x[silica, 2 um]", "mean_x[a; \"b\"]"));
    let series = Series::resume(&Manifest::none(folder.path()), &provenance, &quantities, 0, 2).unwrap();
    assert_eq!(series.last_step().unwrap(), Some(0));
    drop(series);
    assert_eq!(std::fs::read_to_string(folder.path().join("observables.csv")).unwrap(), csv);
    let file = hdf5::File::open(folder.path().join("observables.h5")).unwrap();
    let rows = file.group("observables/mean").unwrap().attr("rows").unwrap();
    let rows = rows.read_scalar::<hdf5::types::VarLenUnicode>().unwrap();
    assert_eq!(simulation::csv_words(&rows), names);
}

#[test]
fn a_row_that_is_being_written_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let provenance = provenance();
    let quantities = [Quantity::number("gap", "length"), Quantity::vectors("mean", "length/time", &["one".to_owned()])];
    let mut series = Series::create(&Manifest::none(folder.path()), &provenance, &quantities, 4).unwrap();
    for step in 0..4 {
        series.append((step, step as f64), &[vec![0.5], vec![1.0; 3]]).unwrap();
    }
    drop(series);
    let path = folder.path().join("observables.h5");
    let of_rows = |rows: usize| {
        let file = hdf5::File::open_rw(&path).unwrap();
        file.dataset("observables/mean/value").unwrap().resize((rows, 1, 3)).unwrap();
        drop(file);
        Observables::of_folder(folder.path(), &|_| true)
    };
    let whole = of_rows(4).unwrap().unwrap();
    assert_eq!((whole.times.len(), whole.last_step), (4, Some(3)));
    let short = of_rows(3).unwrap().unwrap();
    assert_eq!((short.times.len(), short.last_step, short.get("gap").unwrap().column(0, 0).count()), (3, Some(2), 3));
    assert!(of_rows(2).unwrap_err().to_string().contains("damaged"), "two rows are missing");
}

#[test]
fn a_file_that_changes_while_it_is_read_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    let provenance = provenance();
    let mut series =
        Series::create(&Manifest::none(folder.path()), &provenance, &[Quantity::number("gap", "length")], 4).unwrap();
    (0..4).for_each(|step| series.append((step, step as f64), &[vec![0.5]]).unwrap());
    drop(series);
    let path = folder.path().join("observables.h5");
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let read = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(std::time::Duration::from_millis(60));
            std::fs::write(&path, &whole).unwrap();
        });
        Observables::of_folder(folder.path(), &|_| true).unwrap().unwrap()
    });
    assert_eq!(read.times.len(), 4);
}
