#![allow(clippy::float_cmp, reason = "what was written is read, to the bit")]

use super::*;

fn elements() -> Vec<Element> {
    let element = |path: &str, shape, whole| Element { path: path.into(), shape, whole, unit: "length" };
    vec![
        element("all/position", Some([50, 3]), false),
        element("all/image", Some([50, 3]), true),
        element("all/strain", None, false),
    ]
}

fn append(frames: &mut Frames, step: u64) {
    let (reals, integers) = (vec![step as f64; 150], vec![step as i32; 150]);
    let values = [reals.as_slice().into(), integers.as_slice().into(), (step as f64).into()];
    frames.append((step, 0.5 * step as f64), &values).unwrap();
}

/// Reads the file as any reader would, and returns its steps; the frames must be whole.
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

#[test]
fn frames_are_in_the_file_at_once_and_their_room_from_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &elements(), 20).unwrap();
    let size = std::fs::metadata(&path).unwrap().len();
    let before = std::fs::read(&path).unwrap();
    for step in 0..20 {
        append(&mut frames, step);
    }
    std::mem::forget(frames.file.clone()); // as a killed program does
    assert_eq!(steps_of(&path), (0..20).collect::<Vec<_>>());
    assert_eq!(std::fs::metadata(&path).unwrap().len(), size);
    let superblock = 0..48;
    assert_eq!(std::fs::read(&path).unwrap()[superblock.clone()], before[superblock]);
}

#[test]
fn a_resumed_file_has_no_frame_twice_and_grows_where_it_must() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let mut frames = Frames::create(&path, &elements(), 8).unwrap();
    for step in 0..8 {
        append(&mut frames, 10 * step);
    }
    drop(frames);
    for capacity in [8, 30] {
        let anew = |path: &Path| Frames::create(path, &elements(), capacity);
        let mut frames = Frames::resume(&path, &elements(), (45, capacity), anew).unwrap();
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
    drop(Frames::create(&path, &elements(), 8).unwrap());
    let whole = std::fs::read(&path).unwrap();
    let anew = |path: &Path| Frames::create(path, &elements(), 8);
    for damaged in [&whole[..whole.len() / 100], b"no HDF5 at all".as_slice(), b""] {
        std::fs::write(&path, damaged).unwrap();
        let message = Frames::resume(&path, &elements(), (0, 8), anew).err().unwrap().to_string();
        assert!(message.contains("frames.h5 is damaged"), "{message}");
    }
}

/// A kill ends a write between two pages of memory. So a header, which has a checksum, must not straddle two.
#[test]
fn headers_begin_at_pages() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.h5");
    let element = |path: &str, shape| Element { path: path.into(), shape, whole: false, unit: "length" };
    let elements = [element("a/b", Some([3, 5])), element("a/c", None), element("d", Some([700, 3]))];
    let mut frames = Frames::create(&path, &elements, 10).unwrap();
    for step in 0..10 {
        let values = [vec![1.0; 15], vec![2.0], vec![3.0; 2100]];
        let values: Vec<Values> = values.iter().map(|v| v.as_slice().into()).collect();
        frames.append((step, step as f64), &values).unwrap();
    }
    drop(frames);
    let bytes = std::fs::read(&path).unwrap();
    for signature in [b"OHDR", b"OCHK"] {
        let found: Vec<usize> = (0..bytes.len() - 4).filter(|&at| bytes[at..at + 4] == *signature).collect();
        assert!(found.iter().all(|at| at % PAGE as usize == 0), "{found:?}");
        assert!(!found.is_empty() || signature == b"OCHK");
    }
}
