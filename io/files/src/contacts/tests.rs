use super::*;
use domain::Vector;
use simulation::ContactState;

/// Contacts of a step: their count is the step's number.
fn contacts(step: u64) -> ContactForces {
    let one = |k: u64| ContactForce {
        ids: [k, k + 7],
        position: Vector::new(0.1, 0.2, 1.0 / 3.0) * k as f64,
        separation: Vector::new(1.0, -1.0, 0.1),
        normal: 0.7 / (1.0 + k as f64),
        tangential: Vector::Z * k as f64,
        state: ContactState::ALL[k as usize % 4],
    };
    let lattice = [Vector::X * 9.0, Vector::new(1.0, 8.0, 0.0), Vector::Z * 7.0];
    ContactForces { step, time: 0.1 * step as f64, lattice, list: (0..step).map(one).collect() }
}

fn written(folder: &Path) {
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 2 };
    (0..5).for_each(|step| write_contacts(&contacts(step), &Manifest::of_test(folder), &provenance).unwrap());
}

#[test]
fn contacts_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    assert!(RecordedContacts::of(folder.path()).unwrap().clocks().is_empty());
    written(folder.path());
    let recorded = RecordedContacts::of(folder.path()).unwrap();
    assert_eq!(recorded.clocks().iter().map(|clock| clock.0).collect::<Vec<_>>(), [0, 1, 2, 3, 4]);
    for step in 0..5 {
        assert_eq!(recorded.of_step(step).unwrap().unwrap(), contacts(step), "none at step 0");
    }
    assert!(recorded.of_step(5).is_none());
}

#[test]
fn contacts_after_the_step_of_a_checkpoint_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    drop_contacts_after(&Manifest::of_test(folder.path()), 2).unwrap();
    written(folder.path());
    drop_contacts_after(&Manifest::of_test(folder.path()), 2).unwrap();
    let recorded = RecordedContacts::of(folder.path()).unwrap();
    assert_eq!(recorded.clocks().iter().map(|clock| clock.0).collect::<Vec<_>>(), [0, 1, 2]);
}

#[test]
fn damage_is_found() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path());
    let path = folder.path().join(FOLDER).join(name(3));
    let mut bytes = std::fs::read(&path).unwrap();
    let place = bytes.windows(8).position(|bytes| bytes == 0.35_f64.to_le_bytes()).unwrap();
    bytes[place] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let error = RecordedContacts::of(folder.path()).unwrap().of_step(3).unwrap().unwrap_err().to_string();
    assert!(error.contains("normal_force does not fit its checksum"), "{error}");
}
