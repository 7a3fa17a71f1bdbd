#![allow(clippy::float_cmp, reason = "what was written is read, to the bit")]

use super::open::PAGE;
use super::*;
use crate::{checksum, text};
use std::os::unix::fs::FileExt;

fn elements() -> Vec<Element> {
    let element = |path: &str, shape, whole| Element { path: path.into(), shape, whole, unit: "length" };
    vec![
        element("all/position", Some([50, 3]), false),
        element("all/image", Some([50, 3]), true),
        element("all/strain", None, false),
    ]
}

fn kind(elements: &[Element], planned: u64) -> FileKind<'_> {
    FileKind { elements, planned, fixed: &|_| Ok(()) }
}

fn append(frames: &mut Frames, step: u64) {
    let (reals, integers) = (vec![step as f64; 150], vec![step as i32; 150]);
    let values = [reals.as_slice().into(), integers.as_slice().into(), (step as f64).into()];
    frames.append(&kind(&elements(), 20), (step, 0.5 * step as f64), &values).unwrap();
}

/// Reads the file like any reader, and returns its steps; the frames must be complete.
fn steps_of(path: &Path) -> Vec<u64> {
    let file = File::open(path).unwrap();
    let steps: Vec<u64> = file.dataset("all/position/step").unwrap().read_raw().unwrap();
    let positions: Vec<f64> = file.dataset("all/position/value").unwrap().read_raw().unwrap();
    let images: Vec<i32> = file.dataset("all/image/value").unwrap().read_raw().unwrap();
    let times: Vec<f64> = file.dataset("all/strain/time").unwrap().read_raw().unwrap();
    for (frame, &step) in steps.iter().enumerate() {
        assert!(positions[150 * frame..150 * (frame + 1)].iter().all(|&x| x == step as f64));
        assert!(images[150 * frame..150 * (frame + 1)].iter().all(|&x| x == step as i32));
        assert_eq!(times[frame], 0.5 * step as f64);
    }
    steps
}

/// End of the file according to the superblock.
fn said_end(path: &Path) -> u64 {
    u64::from_le_bytes(std::fs::read(path).unwrap()[28..36].try_into().unwrap())
}

#[test]
fn frames_are_in_the_file_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &kind(&elements(), 20)).unwrap();
    let size = || std::fs::metadata(&path).unwrap().len();
    assert_eq!(said_end(&path), size());
    for step in 0..20 {
        append(&mut frames, step);
        assert_eq!(said_end(&path), size());
        assert_eq!(steps_of(&path), (0..=step).collect::<Vec<_>>());
    }
    std::mem::forget(frames); // as a killed program does
    assert_eq!(steps_of(&path), (0..20).collect::<Vec<_>>());
}

/// Whatever the planned length of a run, its file has no more space than it needs, and chunks are
/// allocated one after another.
#[test]
fn files_grow_in_pieces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let element = Element { path: "a".into(), shape: Some([40_000, 3]), whole: false, unit: "" };
    let elements = [element];
    let kind = kind(&elements, 1_000_000_000);
    let mut frames = Frames::create(&path, &kind).unwrap();
    let size = || std::fs::metadata(&path).unwrap().len();
    let values = vec![1.0; 120_000];
    let mut written = 0;
    assert!(size() < 64_000_000, "{}", size());
    for step in 0..60 {
        frames.append(&kind, (step, 0.0), &[values.as_slice().into()]).unwrap();
        written += 8 * values.len() as u64;
        assert!(size() < written + 64_000_000, "{} of {written}", size());
    }
    assert_eq!(frames.frame(59).unwrap().1[0].reals(), values);
}

/// A full file is replaced by a larger one with the same frames, checksums and other content.
#[test]
fn full_files_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let fixed = |file: &File| text::write_dataset(&group(file, "parameters")?, "note", "of the run");
    let elements = elements();
    let kind = FileKind { elements: &elements, planned: 3, fixed: &fixed };
    let mut frames = Frames::create(&path, &kind).unwrap();
    for step in 0..50 {
        let (reals, integers) = (vec![step as f64; 150], vec![step as i32; 150]);
        let values = [reals.as_slice().into(), integers.as_slice().into(), (step as f64).into()];
        frames.append(&kind, (step, 0.5 * step as f64), &values).unwrap();
        assert!(!atomic_file::temporary(&path).exists());
        assert_eq!(steps_of(&path), (0..=step).collect::<Vec<_>>());
    }
    drop(frames);
    let file = File::open(&path).unwrap();
    assert_eq!(text::read_dataset(&file.group("parameters").unwrap(), "note").unwrap(), "of the run");
    let sums = FrameChecksums::open(&file).unwrap().unwrap();
    assert!((0..50).all(|frame| sums.damage(frame).is_none()));
}

/// After a power failure lists of chunks may be on the disk without the chunks; a kill while a file is cut leaves it
/// shorter than it states. In both cases the frames before the last sync are kept, and later frames are complete.
#[test]
fn pieces_that_were_lost_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    for rows in [4000, 100_000] {
        let elements = [Element { path: "a".into(), shape: Some([rows, 3]), whole: false, unit: "" }];
        let kind = kind(&elements, 100_000);
        let mut frames = Frames::create(&path, &kind).unwrap();
        let append = |frames: &mut Frames, step: u64| {
            let values = vec![step as f64; 3 * rows];
            frames.append(&kind, (step, 0.0), &[values.as_slice().into()]).unwrap();
        };
        (0..40).for_each(|step| append(&mut frames, step));
        let end = std::fs::read(&path).unwrap()[..48].to_vec();
        let length = std::fs::metadata(&path).unwrap().len();
        assert_eq!(length > SMALL, rows == 100_000);
        (40..80).for_each(|step| append(&mut frames, step));
        drop(frames);
        let file = std::fs::File::options().write(true).open(&path).unwrap();
        file.write_all_at(&end, 0).unwrap();
        file.set_len(length).unwrap();
        for is_cut in [false, rows == 100_000] {
            if is_cut {
                let file = std::fs::File::options().read(true).write(true).open(&path).unwrap();
                let length = file.metadata().unwrap().len();
                end_of_file::extend_to(&file, length + 5000).unwrap();
                file.set_len(length).unwrap();
                assert!(File::open(&path).is_err());
            }
            let mut frames = Frames::resume(&path, &kind, 20).unwrap();
            assert_eq!((frames.steps_written().unwrap(), frames.damage()), ((0..21).collect(), &[][..]));
            (21..25).for_each(|step| append(&mut frames, step));
            for frame in [0, 1, 20, 21, 24] {
                assert_eq!(frames.frame(frame).unwrap().1[0].reals(), vec![frame as f64; 3 * rows]);
            }
        }
    }
}

/// Values written in blocks are stored as if written at once, with the same checksums.
#[test]
fn blocks_of_rows_make_up_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    for rows in [1, 7, 50] {
        let path = folder.path().join(format!("in-blocks-of-{rows}.h5"));
        let mut frames = Frames::create(&path, &kind(&elements(), 4)).unwrap();
        let (reals, integers): (Vec<f64>, Vec<i32>) = (0..150).map(|k| (0.1 * f64::from(k), k)).unzip();
        for step in 0..3 {
            let values = [
                NewValue::InBlocks(Box::new(|each| reals.chunks(3 * rows).try_for_each(|part| each(&part.into())))),
                NewValue::InBlocks(Box::new(|each| integers.chunks(3 * rows).try_for_each(|part| each(&part.into())))),
                NewValue::Whole(7.0.into()),
            ];
            frames.append_blocks(&kind(&elements(), 4), (step, 0.5), &values).unwrap();
        }
        let ((step, time), values) = frames.frame(1).unwrap();
        assert_eq!((step, time, &values[..2]), (1, 0.5, &[reals.as_slice().into(), integers.as_slice().into()][..]));
        assert_eq!(
            FrameChecksums::open(&File::open(&path).unwrap()).unwrap().unwrap().read(1).unwrap()[1],
            checksum::of(&reals)
        );
        let short =
            [NewValue::Whole(reals[..3].into()), NewValue::Whole(integers[..].into()), NewValue::Whole(7.0.into())];
        let error = frames.append_blocks(&kind(&elements(), 4), (3, 0.5), &short).unwrap_err().to_string();
        assert!(error.contains("1 rows of a value of the shape Some([50, 3])"), "{error}");
    }
}

#[test]
fn a_resumed_file_has_no_frame_twice_and_grows_where_it_must() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &kind(&elements(), 8)).unwrap();
    for step in 0..8 {
        append(&mut frames, 10 * step);
    }
    drop(frames);
    for capacity in [8, 30] {
        let mut frames = Frames::resume(&path, &kind(&elements(), capacity), 45).unwrap();
        assert_eq!(frames.steps_written().unwrap(), [0, 10, 20, 30, 40]);
        for step in 5..capacity {
            append(&mut frames, 10 * step);
        }
        drop(frames);
        assert_eq!(steps_of(&path), (0..capacity).map(|s| 10 * s).collect::<Vec<_>>());
    }
}

#[test]
fn a_damaged_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    drop(Frames::create(&path, &kind(&elements(), 8)).unwrap());
    let whole = std::fs::read(&path).unwrap();
    for damaged in [&whole[..whole.len() / 100], b"no HDF5 at all".as_slice(), b""] {
        std::fs::write(&path, damaged).unwrap();
        let message = Frames::resume(&path, &kind(&elements(), 8), 0).err().unwrap().to_string();
        assert!(message.contains("frames.h5 is damaged"), "{message}");
    }
}

/// A kill ends a write between two pages of memory. So a header, which has a checksum, must not
/// straddle a page boundary.
#[test]
fn headers_begin_at_pages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let element = |path: &str, shape| Element { path: path.into(), shape, whole: false, unit: "length" };
    let elements = [element("a/b", Some([3, 5])), element("a/c", None), element("d", Some([700, 3]))];
    let mut frames = Frames::create(&path, &kind(&elements, 10)).unwrap();
    for step in 0..10 {
        let values = [vec![1.0; 15], vec![2.0], vec![3.0; 2100]];
        let values: Vec<Values> = values.iter().map(|v| v.as_slice().into()).collect();
        frames.append(&kind(&elements, 10), (step, step as f64), &values).unwrap();
    }
    drop(frames);
    let bytes = std::fs::read(&path).unwrap();
    for signature in [b"OHDR", b"OCHK", b"FAHD", b"FADB"] {
        let found: Vec<usize> = (0..bytes.len() - 4).filter(|&at| bytes[at..at + 4] == *signature).collect();
        assert!(found.iter().all(|at| at % PAGE as usize == 0), "{found:?}");
        assert!(!found.is_empty() || signature == b"OCHK", "{}", String::from_utf8_lossy(signature));
    }
}

/// Position of the bytes of a number in a file, in which it occurs once.
fn place_of(bytes: &[u8], number: [u8; 8]) -> usize {
    let places: Vec<usize> = bytes.windows(8).enumerate().filter(|(_, w)| *w == number).map(|(at, _)| at).collect();
    assert_eq!(places.len(), 1, "{places:?}");
    places[0]
}

#[test]
fn a_bit_flipped_in_any_element_is_seen_and_the_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let elements = elements();
    let mut frames = Frames::create(&path, &kind(&elements, 9)).unwrap();
    for step in 0..4 {
        let (mut reals, integers) = (vec![0.5; 150], vec![step as i32; 150]);
        reals[70] = 1000.25 + step as f64;
        let values = [reals.as_slice().into(), integers.as_slice().into(), (2000.25 + step as f64).into()];
        frames.append(&kind(&elements, 9), (3_000_000_000 + step, 4000.25 + step as f64), &values).unwrap();
    }
    drop(frames);
    let whole = std::fs::read(&path).unwrap();
    let clock = "step and time";
    for (number, frame, element) in [
        (1000.25_f64.to_le_bytes(), 0, "all/position"),
        (2002.25_f64.to_le_bytes(), 2, "all/strain"),
        (4001.25_f64.to_le_bytes(), 1, clock),
        (3_000_000_003_u64.to_le_bytes(), 3, clock),
    ] {
        let mut damaged = whole.clone();
        damaged[place_of(&whole, number)] ^= 1;
        std::fs::write(&path, damaged).unwrap();
        for capacity in [9, 20] {
            let mut frames = Frames::resume(&path, &kind(&elements, capacity), 3_000_000_009).unwrap();
            let damage = Damage { frame, elements: vec![element.to_owned()] };
            // The step of the last frame is damaged, so the frame is dropped.
            let (kept, damage) = if frame == 3 { (3, vec![]) } else { (4, vec![damage]) };
            assert_eq!(frames.damage(), damage);
            assert_eq!(frames.steps_written().unwrap().len(), kept);
            append(&mut frames, 3_000_000_010);
            drop(frames);
            let sums = FrameChecksums::open(&File::open(&path).unwrap()).unwrap().unwrap();
            let found: Vec<Damage> = (0..=kept).filter_map(|frame| sums.damage(frame)).collect();
            assert_eq!(found, damage);
        }
    }
}

#[test]
fn files_without_checksums_are_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &kind(&elements(), 8)).unwrap();
    append(&mut frames, 0);
    drop(frames);
    File::open_rw(&path).unwrap().group("parameters").unwrap().unlink("checksums").unwrap();
    for capacity in [8, 12] {
        let mut frames = Frames::resume(&path, &kind(&elements(), capacity), capacity).unwrap();
        append(&mut frames, capacity);
    }
    assert_eq!(steps_of(&path), [0, 8, 12]);
}

#[test]
fn a_failed_write_ends_the_writing_and_leaves_the_frames_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &kind(&elements(), 8)).unwrap();
    append(&mut frames, 0);
    let failed = frames.attempt(|_, _| Err::<(), _>("no room".into())).unwrap_err().to_string();
    assert!(failed.contains("frames.h5: no room"), "{failed}");
    let again = frames.append(&kind(&elements(), 8), (1, 0.5), &[]).unwrap_err().to_string();
    assert!(again.contains("frames.h5: a write to it has failed before"), "{again}");
    drop(frames);
    assert_eq!(steps_of(&path), [0]);
}
