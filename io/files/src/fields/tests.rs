#![allow(clippy::float_cmp, reason = "what was written is read, to the bit")]

use super::*;
use domain::{PeriodicBox, Vector};
use ndarray::Array4;

fn provenance() -> Provenance {
    Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 }
}

/// Writes fields of 4 x 3 x 2 points, at the times 0.1 STEP, with the numbers of the points as velocities.
fn write(folder: &Path, steps_and_strains: &[(u64, f64)]) {
    let values: Vec<Vector> = (0..24).map(|i| Vector::splat(f64::from(i))).collect();
    for &(step, strain) in steps_and_strains {
        let cell = PeriodicBox::sheared(Vector::new(4.0, 6.0, 1.0), strain).unwrap();
        let time = 0.1 * step as f64;
        let spacing = Vector::new(1.0, 2.0, 0.5);
        let (first, periodic) = (Vector::ZERO, [true; 3]);
        let field = VelocityField {
            step,
            time,
            cell,
            origin: first,
            spacing,
            points: [4, 3, 2],
            periodic,
            values: values.clone(),
            note: "",
        };
        write_field(&field, &Manifest::of_test(folder), &provenance()).unwrap();
    }
}

fn index(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("fields.xdmf")).unwrap()
}

fn read(folder: &Path, step: u64, dataset: &str) -> Array4<f64> {
    File::open(folder.join(format!("fields/velocity-{step:010}.h5"))).unwrap().dataset(dataset).unwrap().read().unwrap()
}

#[test]
fn straight_boxes_are_straight_meshes() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(5, 0.0), (10, 0.0)]);
    let xdmf = index(folder.path());
    assert_eq!(xdmf.matches("TopologyType=\"3DCoRectMesh\" Dimensions=\"3 4 5\"").count(), 2);
    assert_eq!(xdmf.matches(">0.5 2.0 1.0<").count(), 2, "spacings along z, y and x: {xdmf}");
    assert!(xdmf.contains("<Time Value=\"0.5\"/>") && xdmf.contains("<Time Value=\"1.0\"/>"));
    assert!(xdmf.contains("Dimensions=\"3 4 5 3\">fields/velocity-0000000005.h5:/repeated/velocity"));
    assert!(!xdmf.contains("3DSMesh"));
}

#[test]
fn one_sheared_frame_makes_all_of_them_curved_meshes() {
    let folder = tempfile::tempdir().unwrap();
    // The strain is zero again after a full lattice period, in the middle of a run.
    write(folder.path(), &[(0, 0.0), (10, 0.2), (20, 0.0)]);
    let xdmf = index(folder.path());
    assert_eq!(xdmf.matches("3DSMesh").count(), 3);
    assert!(!xdmf.contains("3DCoRectMesh"));
    for step in [0, 10, 20] {
        assert!(xdmf.contains(&format!("fields/velocity-{step:010}.h5:/repeated/position")));
        assert_eq!(read(folder.path(), step, "repeated/position").dim(), (3, 4, 5, 3));
    }
    let names = std::fs::read_dir(folder.path().join("fields")).unwrap();
    assert_eq!(names.count(), 3, "nothing temporary is left");
}

#[test]
fn places_shear_with_the_box() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(10, 0.125)]);
    let places = read(folder.path(), 10, "repeated/position");
    for ((k, j, i, component), &place) in places.indexed_iter() {
        let y = 2.0 * j as f64;
        // All of these are short binary fractions.
        assert_eq!(place, [i as f64 + 0.125 * y, y, 0.5 * k as f64][component]);
    }
    let shown = read(folder.path(), 10, "position");
    assert_eq!(shown, places.slice(ndarray::s![..2, ..3, ..4, ..]));
}

#[test]
fn the_first_planes_come_again_at_the_ends() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(0, 0.0)]);
    let (velocity, repeated) = (read(folder.path(), 0, "velocity"), read(folder.path(), 0, "repeated/velocity"));
    assert_eq!((velocity.dim(), repeated.dim()), ((2, 3, 4, 3), (3, 4, 5, 3)));
    for ((k, j, i, component), &value) in repeated.indexed_iter() {
        assert_eq!(value, velocity[[k % 2, j % 3, i % 4, component]]);
    }
}

#[test]
fn an_index_that_grows_is_that_of_all_files() {
    for strains in [[0.0; 4], [0.0, 0.2, 0.0, 0.1], [0.2, 0.0, 0.0, 0.0]] {
        let folder = tempfile::tempdir().unwrap();
        for (step, strain) in strains.into_iter().enumerate() {
            write(folder.path(), &[(step as u64, strain)]);
        }
        let grown = index(folder.path());
        drop_fields_after(&Manifest::of_test(folder.path()), 3).unwrap();
        assert_eq!(grown, index(folder.path()), "{strains:?}");
    }
}

/// An index that lacks fields, as after a failure between a field and its index, or that was cut.
#[test]
fn an_index_that_does_not_fit_is_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(0, 0.0)]);
    let short = index(folder.path());
    write(folder.path(), &[(1, 0.0)]);
    for broken in [short.as_str(), &short[..short.len() / 2], ""] {
        std::fs::write(folder.path().join("fields.xdmf"), broken).unwrap();
        write(folder.path(), &[(2, 0.0)]);
        assert_eq!(index(folder.path()).matches("<Time").count(), 3, "{broken}");
    }
}

/// Adding to the index reads no earlier fields: they may even be damaged.
#[test]
fn a_field_is_indexed_without_those_before() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(0, 0.0)]);
    std::fs::write(folder.path().join("fields/velocity-0000000000.h5"), "nothing").unwrap();
    write(folder.path(), &[(1, 0.0)]);
    assert_eq!(index(folder.path()).matches("<Time").count(), 2);
}

#[test]
fn files_of_before_are_completed() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(0, 0.0), (10, 0.2)]);
    for step in [0, 10] {
        let file = File::open_rw(folder.path().join(format!("fields/velocity-{step:010}.h5"))).unwrap();
        file.unlink("repeated").unwrap();
        file.unlink("position").unwrap();
    }
    // As in a resumed run.
    drop_fields_after(&Manifest::of_test(folder.path()), 10).unwrap();
    write(folder.path(), &[(20, 0.3)]);
    for step in [0, 10, 20] {
        let places = read(folder.path(), step, "repeated/position");
        assert_eq!(places[[0, 3, 0, 0]], 6.0 * [0.0, 0.2, 0.3][step as usize / 10]);
        assert_eq!(read(folder.path(), step, "repeated/velocity")[[2, 3, 4, 0]], 0.0);
    }
}

#[test]
fn frames_of_another_grid_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(0, 0.0), (10, 0.0)]);
    let old = File::open_rw(folder.path().join("fields/velocity-0000000000.h5")).unwrap();
    for name in ["velocity", "repeated"] {
        old.unlink(name).unwrap();
    }
    old.new_dataset::<f64>().shape((2, 5, 4, 3)).create("velocity").unwrap();
    drop(old);
    drop_fields_after(&Manifest::of_test(folder.path()), 10).unwrap();
    write(folder.path(), &[(20, 0.0)]);
    let xdmf = index(folder.path());
    assert_eq!(xdmf.matches("<Time").count(), 2);
    assert!(xdmf.contains("<!-- left out, of another grid: velocity-0000000000.h5 -->"));
}

#[test]
fn late_fields_are_dropped() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &[(5, 0.0), (10, 0.2)]);
    drop_fields_after(&Manifest::of_test(folder.path()), 5).unwrap();
    let xdmf = index(folder.path());
    assert_eq!(xdmf.matches("<Time").count(), 1);
    assert!(xdmf.contains("velocity-0000000005.h5"));
}

#[test]
fn places_take_little_room() {
    let folder = tempfile::tempdir().unwrap();
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 };
    let values = vec![Vector::ZERO; 48 * 48 * 48];
    let cell = PeriodicBox::sheared(Vector::new(17.0, 19.0, 23.0), 0.1234567).unwrap();
    let field = VelocityField {
        step: 0,
        time: 0.0,
        cell,
        origin: Vector::ZERO,
        spacing: cell.edges() / 48.0,
        points: [48; 3],
        periodic: [true; 3],
        values: values.clone(),
        note: "",
    };
    write_field(&field, &Manifest::of_test(folder.path()), &provenance).unwrap();
    let size = std::fs::metadata(folder.path().join("fields/velocity-0000000000.h5")).unwrap().len();
    let velocities = 48 * 48 * 48 * 24;
    assert!(size < velocities * 11 / 10, "{size} bytes for {velocities} of velocities");
}

/// Writes fields with the given numbers of points and origins, in a box that is not periodic
/// along z, at times 0.1 STEP.
fn write_bounded(folder: &Path, frames: &[(u64, [usize; 3], f64)]) {
    for &(step, points, origin) in frames {
        let values = (0..points.iter().product()).map(|i: usize| Vector::splat(i as f64)).collect();
        let cell = PeriodicBox::new(Vector::new(4.0, 6.0, 1.0)).unwrap();
        let (first, spacing) = (Vector::new(0.0, 0.0, origin), Vector::new(1.0, 2.0, 0.25));
        let (time, periodic) = (0.1 * step as f64, [true, true, false]);
        let field = VelocityField { step, time, cell, origin: first, spacing, points, periodic, values, note: "" };
        write_field(&field, &Manifest::of_test(folder), &provenance()).unwrap();
    }
}

#[test]
fn points_from_wall_to_wall_are_not_repeated_across_them() {
    let folder = tempfile::tempdir().unwrap();
    write_bounded(folder.path(), &[(0, [4, 3, 5], 0.0), (5, [4, 3, 5], 0.0)]);
    let xdmf = index(folder.path());
    assert_eq!(xdmf.matches("TopologyType=\"3DCoRectMesh\" Dimensions=\"5 4 5\"").count(), 2);
    assert_eq!(xdmf.matches(">0.25 2.0 1.0<").count(), 2, "spacings along z, y and x: {xdmf}");
    let (velocity, repeated) = (read(folder.path(), 5, "velocity"), read(folder.path(), 5, "repeated/velocity"));
    assert_eq!((velocity.dim(), repeated.dim()), ((5, 3, 4, 3), (5, 4, 5, 3)));
    for ((k, j, i, component), &value) in repeated.indexed_iter() {
        assert_eq!(value, velocity[[k, j % 3, i % 4, component]]);
    }
    let file = File::open(folder.path().join("fields/velocity-0000000005.h5")).unwrap();
    assert_eq!(file.attr("spacing").unwrap().read_raw::<f64>().unwrap(), [1.0, 2.0, 0.25]);
}

/// Readers assume the size of the first mesh, but use the actual sizes of meshes in collections.
#[test]
fn a_box_that_follows_spheres_has_a_mesh_of_its_own_in_each_frame() {
    let frames = [(0, [4, 3, 5], -0.5), (1, [4, 3, 5], -0.25), (2, [4, 3, 7], -0.75), (3, [4, 3, 6], 1.5)];
    let folder = tempfile::tempdir().unwrap();
    write_bounded(folder.path(), &frames[..2]);
    assert!(!index(folder.path()).contains("Spatial"), "as long as they are of one size");
    write_bounded(folder.path(), &frames[2..]);
    let grown = index(folder.path());
    assert_eq!(grown.matches("CollectionType=\"Spatial\"").count(), 4);
    assert_eq!(grown.matches("<Time ").count(), 4);
    assert!(!grown.contains("left out"));
    for (_, [_, _, nz], origin) in frames {
        assert!(grown.contains(&format!("Dimensions=\"{nz} 4 5\"")), "{grown}");
        assert!(grown.contains(&format!(">{origin:?} 0.0 0.0<")), "{grown}");
    }
    drop_fields_after(&Manifest::of_test(folder.path()), 3).unwrap();
    assert_eq!(grown, index(folder.path()));
    drop_fields_after(&Manifest::of_test(folder.path()), 1).unwrap();
    assert!(!index(folder.path()).contains("Spatial"), "those that are left are of one size");
}
