use super::*;
use proptest::prelude::*;

fn brute_force(cell: &PeriodicBox, separation: Vector) -> f64 {
    let mut best = f64::INFINITY;
    for i in -4..=4 {
        for j in -4..=4 {
            for k in -4..=4 {
                best = best.min((separation + cell.lattice([i, j, k])).length());
            }
        }
    }
    best
}

proptest! {
    #[test]
    fn wrapped_positions_are_inside_and_images(
        x in -50.0..50.0, y in -50.0..50.0, z in -50.0..50.0, strain in -2.0..2.0,
    ) {
        let cell = PeriodicBox::sheared(Vector::new(3.0, 4.0, 5.0), strain).unwrap();
        let position = Vector::new(x, y, z);
        let (wrapped, steps) = cell.wrap(position);
        let c = cell.lattice_coordinates(wrapped);
        prop_assert!(c.cmpge(Vector::splat(-1e-15)).all() && c.cmplt(cell.edges()).all());
        prop_assert!((wrapped + cell.lattice(steps) - position).length() < 1e-12);
    }

    #[test]
    fn the_nearest_image_is_the_shortest_of_all(
        x in -4.0..4.0, y in -4.0..4.0, z in -4.0..4.0, strain in -2.0..2.0,
    ) {
        let cell = PeriodicBox::sheared(Vector::new(3.0, 3.0, 3.0), strain).unwrap();
        let separation = Vector::new(x, y, z);
        let nearest = cell.nearest_image(separation).length();
        prop_assert!((nearest - brute_force(&cell, separation)).abs() < 1e-12);
    }
}

/// Lattices of planar and uniaxial extension.
fn any(strain: f64) -> PeriodicBox {
    let stretched = Tensor::from_diagonal(Vector::new(strain.exp(), (-strain).exp(), 1.0));
    let vectors = [Vector::new(1.7, 0.9, 0.3), Vector::new(-0.9, 1.7, 0.1), Vector::new(0.2, -0.3, 2.1)];
    PeriodicBox::of_lattice(vectors.map(|vector| stretched * vector)).unwrap()
}

proptest! {
    #[test]
    fn any_lattice_is_a_box(
        x in -9.0..9.0, y in -9.0..9.0, z in -9.0..9.0, strain in -0.4..0.4,
    ) {
        let (cell, position) = (any(strain), Vector::new(x, y, z));
        let (wrapped, steps) = cell.wrap(position);
        let c = cell.lattice_coordinates(wrapped);
        prop_assert!(c.cmpge(Vector::splat(-1e-15)).all() && c.cmplt(cell.edges()).all());
        prop_assert!((wrapped + cell.lattice(steps) - position).length() < 1e-12);
        prop_assert!((cell.position(c) - wrapped).length() < 1e-13);
        let nearest = cell.nearest_image(wrapped);
        prop_assert!((nearest.length() - brute_force(&cell, wrapped)).abs() < 1e-12);
        let change = (cell.lattice_coordinates(position).abs() / position.length()).max(Vector::ZERO);
        prop_assert!(change.cmple(cell.coordinate_stretch() * (1.0 + 1e-12)).all());
    }
}

#[test]
fn a_lattice_is_kept_as_it_is() {
    let vectors = [Vector::new(1.0, 2.0, 0.5), Vector::new(-2.0, 1.0, 0.0), Vector::new(0.3, 0.1, 1.0)];
    let cell = PeriodicBox::of_lattice(vectors).unwrap();
    for (found, given) in cell.lattice_vectors().into_iter().zip(vectors) {
        assert!((found - given).length() < 1e-15, "{found} is not {given}");
    }
    assert!((cell.volume() - vectors[0].cross(vectors[1]).dot(vectors[2])).abs() < 1e-14);
    let left = PeriodicBox::of_lattice([vectors[1], vectors[0], vectors[2]]).unwrap_err();
    assert!(left.to_string().contains("right-handed"), "{left}");
}

#[test]
fn strains_a_period_apart_are_one_lattice() {
    let edges = Vector::new(2.0, 3.0, 1.0);
    let (a, b) = (PeriodicBox::sheared(edges, 0.25).unwrap(), PeriodicBox::sheared(edges, 0.25 + 4.0 / 3.0).unwrap());
    assert!((a.strain() - b.strain()).abs() < 1e-15);
    assert!(PeriodicBox::sheared(edges, 1.0 / 3.0).unwrap().strain() < 0.0, "the upper end belongs to the lower");
}

#[test]
fn axes_that_do_not_repeat_have_no_images() {
    let periodic = PeriodicBox::new(Vector::new(3.0, 4.0, 5.0)).unwrap();
    let (position, separation) = (Vector::new(-0.5, 9.0, 7.0), Vector::new(1.7, -3.0, 4.9));
    let slit = [Boundaries::Walls, Boundaries::Wall, Boundaries::OpenAlongZ];
    for boundaries in slit {
        let cell = periodic.with_boundaries(boundaries).unwrap();
        assert_eq!(cell.wrap(position), (Vector::new(2.5, 1.0, 7.0), [-1, 2, 0]));
        assert!((cell.nearest_image(separation) - Vector::new(-1.3, 1.0, 4.9)).length() < 1e-15);
        assert_eq!(cell.scaled(2.0).boundaries(), boundaries);
    }
    let open = periodic.with_boundaries(Boundaries::Open).unwrap();
    assert_eq!((open.wrap(position), open.nearest_image(separation)), ((position, [0; 3]), separation));
    // Just below the near face of a periodic axis and far above along one that is not periodic.
    let cell = periodic.with_boundaries(Boundaries::Wall).unwrap();
    let (wrapped, steps) = cell.wrap(Vector::new(-1e-18, 0.0, 11.0));
    assert!(wrapped.x < 3.0 && (wrapped.z - 11.0).abs() < 1e-15 && steps[2] == 0, "{wrapped}");
}

#[test]
fn a_box_may_begin_elsewhere_where_it_does_not_repeat() {
    let open = PeriodicBox::new(Vector::splat(3.0)).unwrap().with_boundaries(Boundaries::Open).unwrap();
    let cell = open.with_extent(Vector::new(-5.0, 1.0, 40.0), Vector::new(2.0, 4.0, 8.0)).unwrap();
    assert_eq!(
        (cell.boundaries(), cell.edges(), cell.scaled(0.5).origin()),
        (Boundaries::Open, Vector::new(2.0, 4.0, 8.0), Vector::new(-2.5, 0.5, 20.0))
    );
    assert_eq!(cell.fractional_coordinates(Vector::new(-4.0, 1.0, 48.0)), Vector::new(0.5, 0.0, 1.0));
    assert_eq!(cell.scaled(0.5).fractional_coordinates(Vector::new(-2.0, 0.5, 24.0)), Vector::new(0.5, 0.0, 1.0));
    assert!(open.with_extent(Vector::ZERO, Vector::new(1.0, -1.0, 1.0)).is_err());
}

#[test]
fn only_an_upright_box_has_walls() {
    let sheared = PeriodicBox::sheared(Vector::splat(3.0), 0.2).unwrap();
    let error = sheared.with_boundaries(Boundaries::Walls).unwrap_err();
    assert!(error.to_string().contains("Walls boundaries"), "{error}");
    assert_eq!(sheared.with_boundaries(Boundaries::Periodic), Ok(sheared));
}

#[test]
fn a_box_without_volume_is_refused_by_axis() {
    let error = PeriodicBox::new(Vector::new(1.0, 0.0, 1.0)).unwrap_err();
    assert_eq!(error, BoxError::Edge { axis: 'y', length: 0.0 });
    assert!(PeriodicBox::new(Vector::new(1.0, 1.0, f64::NAN)).is_err());
}
