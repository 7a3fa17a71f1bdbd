use super::*;
use domain::Particles;
use files::{Provenance, Trajectory, write_contacts};
use simulation::{ContactForce, ContactForces, ContactState};
use std::path::Path;

/// Writes a trajectory of two particles, one of which moves, in a box with increasing shear; returns its frames.
fn written(path: &Path, frames: u32) -> Vec<Frame> {
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 2 };
    let frame = |k: u32| {
        let mut particles = Particles::default();
        particles.push(0, Vector::new(0.1, 2.0, 3.0), 0.5, 0);
        particles.push(1, Vector::new(0.0, 3.9999, 4.0), 1.25, 1);
        particles.vectors("velocity")[1] = Vector::X * f64::from(k);
        let cell = PeriodicBox::sheared(Vector::new(8.0, 4.0, 5.0), 0.25 * f64::from(k % 4)).unwrap();
        particles.positions[1].x = 0.7 * f64::from(k);
        particles.positions.iter_mut().for_each(|position| *position = cell.wrap(*position).0);
        Frame { particles, cell, periodic: [true; 3] }
    };
    let mut trajectory = Trajectory::create(path, &provenance, &frame(0), u64::from(frames)).unwrap();
    let frames: Vec<Frame> = (0..frames).map(frame).collect();
    for (k, frame) in frames.iter().enumerate() {
        trajectory.append((10 * k as u64, 0.1 * k as f64), frame).unwrap();
    }
    frames
}

fn played(path: &Path) -> Playback {
    let colours = Colours { species: vec!["a".into()], flow: None };
    let contacts = RecordedContacts::of(path.parent().unwrap()).unwrap();
    Playback::of(&TrajectoryReader::open(path).unwrap(), &contacts, &colours)
}

#[test]
fn positions_are_those_of_the_trajectory_to_16_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.h5");
    let frames = written(&path, 12);
    let playback = played(&path);
    let coordinates: Vec<f64> = playback
        .positions
        .chunks_exact(2)
        .map(|bytes| (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])) + 0.5) / 65536.0)
        .collect();
    assert_eq!(coordinates.len(), 12 * 2 * 3);
    for (coordinates, frame) in coordinates.chunks_exact(6).zip(&frames) {
        let corner = |axis: usize| frame.cell.lattice([0, 1, 2].map(|other| i32::from(other == axis)));
        for (part, &position) in coordinates.chunks_exact(3).zip(&frame.particles.positions) {
            let decoded: Vector = (0..3).map(|axis| corner(axis) * part[axis]).sum();
            let off = decoded - position;
            // Half of 1/65536 of each lattice vector at most; the second one is tilted.
            let least = frame.cell.edges() * 0.5 / 65536.0 * (1.0 + 1e-9);
            assert!(off.x.abs() <= least.x + least.y && off.y.abs() <= least.y && off.z.abs() <= least.z, "{off}");
        }
    }
}

#[test]
fn the_player_is_told_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.h5");
    written(&path, 3);
    let (told, lists) = played(&path).parts('y');
    assert_eq!((&told["count"], &told["flat"], &told["up"]), (&json!(2), &json!(false), &json!("y")));
    assert_eq!(
        (&told["steps"], &told["edges"][1]),
        (&json!([0, 10, 20]), &json!([8.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 5.0]))
    );
    let colourings = told["colourings"].as_array().unwrap();
    assert_eq!(colourings[0], json!({"name": "species", "fixed": true, "names": ["a", "1"]}));
    assert_eq!(colourings[1]["range"], json!(["0", "2"]));
    let names: Vec<&str> = lists.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["radii", "positions", "colouring-0", "colouring-1"]);
    // 0.5 and 1.25 in single precision, little-endian; species 0 and 1; speeds 0 0, 0 1, 0 2 relative to 2.
    assert_eq!((lists[0].1.as_str(), lists[2].1.as_str(), lists[3].1.as_str()), ("AAAAPwAAoD8=", "AAE=", "AAAAgAD/"));
}

/// Only the frame at step 10 has contacts: lines as thick as their forces, the thickest first.
#[test]
fn contacts_are_lines() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.h5");
    let frames = written(&path, 3);
    assert!(!played(&path).has_chains());
    assert_eq!(played(&path).parts('y').0["chains"], Value::Null);
    let contact = |normal: f64| ContactForce {
        ids: [0, 1],
        position: Vector::new(1.1, 2.0, 3.0),
        separation: Vector::new(0.0, -1.0, 0.5),
        normal,
        tangential: Vector::ZERO,
        state: ContactState::Sticking,
    };
    let lattice = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|steps| frames[1].cell.lattice(steps));
    let list = vec![contact(1.0), contact(-2.0)];
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 2 };
    write_contacts(
        &ContactForces { step: 10, time: 0.1, lattice, list },
        &files::Manifest::begin(folder.path(), "", None).unwrap(),
        &provenance,
    )
    .unwrap();
    let playback = played(&path);
    let (told, lists) = playback.parts('y');
    assert_eq!(told["chains"], json!({"counts": [0, 2, 0], "largest": "2"}));
    let names: Vec<&str> = lists.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names[names.len() - 2..], ["chains", "widths"]);
    // 255 and 128.
    assert_eq!(lists[names.len() - 1].1, "/4A=");
    // The box is 8, 4, 5 and sheared by 1/4: 2 up is half of its height and 0.5 to the right.
    let parts = [(1.1 - 0.5) / 8.0, 0.5, 0.6].map(|part| (part * 65536.0) as u16);
    let steps = [0.25 / 8.0, -0.25, 0.1].map(|part| (part * 32768.0_f64).round() as i16);
    let expected: Vec<u8> =
        parts.into_iter().flat_map(u16::to_le_bytes).chain(steps.into_iter().flat_map(i16::to_le_bytes)).collect();
    assert_eq!(lists[names.len() - 2].1, BASE64_STANDARD.encode(expected.repeat(2)));
}

#[test]
fn a_frame_that_is_damaged_is_left_out_and_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.h5");
    written(&path, 3);
    let mut bytes = std::fs::read(&path).unwrap();
    let place = bytes.windows(8).position(|bytes| bytes == 3.9999_f64.to_le_bytes()).unwrap();
    bytes[place] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let playback = played(&path);
    assert_eq!((playback.recorded, playback.shown(), playback.damage.len()), (3, 2, 1));
    let words = "trajectory.h5 is damaged: frame 0 does not fit its checksums: particles/all/position";
    assert!(playback.damage[0].contains(words), "{:?}", playback.damage);
}

#[test]
fn coordinates_stay_within_their_range() {
    let cell = PeriodicBox::new(Vector::new(1.0, 2.0, 3.0)).unwrap();
    let coordinates = |place: Vector| {
        let bytes = in_box(&cell, place);
        [0, 2, 4].map(|k| u16::from_le_bytes([bytes[k], bytes[k + 1]]))
    };
    assert_eq!(coordinates(Vector::new(0.0, 1.0, 3.0)), [0, 32768, 65535]);
    assert_eq!(coordinates(Vector::new(-0.1, 2.0 - 1e-12, 9.0)), [0, 65535, 65535]);
}
