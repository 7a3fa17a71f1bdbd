//! Boxes that follow spheres in unbounded fluid.

use crate::model::Model;
use crate::model::radii::Radii;
use domain::{Boundaries, Comm, Particles, PeriodicBox, Vector, power_of_two};

/// Resolution of edges: they are multiples of the next smaller power of two over this number, so that the box seldom
/// changes.
const PARTS: f64 = 8.0;

/// Shortest edge over the largest radius: the box has to be longer than a sphere is wide.
const SHORTEST: f64 = 2.5;

/// Relative margin of the edges around the centres, for round-off.
const SPARE: f64 = 1e-9;

/// Whether a box with these boundaries follows the spheres, because it is open on some side.
pub fn follows(boundaries: Boundaries) -> bool {
    match boundaries {
        Boundaries::Periodic | Boundaries::Walls => false,
        Boundaries::Wall | Boundaries::OpenAlongZ | Boundaries::Open => true,
    }
}

/// The box of a model, fitted around its spheres if it follows them. Collective.
pub fn of(model: &Model, particles: &Particles, radii: &Radii, comm: &Comm) -> PeriodicBox {
    let scene = &model.cell;
    if follows(scene.boundaries()) { around(scene, particles, radii.largest(), comm) } else { *scene }
}

/// The box that contains the centres of the spheres, centred along open axes; above a wall it is at least as high as
/// the scene's box. It depends only on the positions and the largest radius, so that a resumed run continues in the
/// same box. Collective.
pub fn around(scene: &PeriodicBox, particles: &Particles, largest_radius: f64, comm: &Comm) -> PeriodicBox {
    let [lowest, highest] = extremes(particles, comm);
    let (mut origin, mut edges) = (scene.origin(), scene.edges());
    for axis in (0..3).filter(|&axis| !scene.is_periodic(axis)) {
        if scene.boundaries().walls() == 0 {
            edges[axis] = rounded_up(highest[axis] - lowest[axis], largest_radius);
            origin[axis] = 0.5 * (lowest[axis] + highest[axis] - edges[axis]);
        } else if highest[axis] > edges[axis] {
            edges[axis] = rounded_up(highest[axis], largest_radius);
        }
    }
    scene.with_extent(origin, edges).expect("positions are finite")
}

/// Smallest and largest coordinates of all centres. Collective.
fn extremes(particles: &Particles, comm: &Comm) -> [Vector; 2] {
    let far = Vector::splat(f64::INFINITY);
    let own = particles.positions.iter().fold([far, far], |[low, high], &x| [low.min(x), high.min(-x)]);
    let mut all = [own[0].to_array(), own[1].to_array()].concat();
    comm.min(&mut all);
    [Vector::from_slice(&all[..3]), -Vector::from_slice(&all[3..])]
}

/// Edge of at least the given length, rounded up to one of few values.
fn rounded_up(extent: f64, radius: f64) -> f64 {
    let least = (extent / radius).max(SHORTEST) * (1.0 + SPARE);
    let part = power_of_two(least) / PARTS;
    (least / part).ceil() * part * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(places: &[[f64; 3]]) -> Particles {
        let mut particles = Particles::default();
        places.iter().enumerate().for_each(|(id, &x)| particles.push(id as u64, x.into(), 1.0, 0));
        particles
    }

    fn scene(boundaries: Boundaries) -> PeriodicBox {
        PeriodicBox::new(Vector::new(9.0, 9.0, 12.0)).unwrap().with_boundaries(boundaries).unwrap()
    }

    fn found(boundaries: Boundaries, places: &[[f64; 3]]) -> (Vector, Vector) {
        let cell = around(&scene(boundaries), &at(places), 1.0, &Comm::alone());
        assert_eq!(cell.boundaries(), boundaries);
        (cell.origin(), cell.edges())
    }

    #[test]
    fn a_box_has_the_spheres_in_its_middle_along_open_axes() {
        let places = [[-3.0, 100.0, 5.0], [7.5, 100.0, 5.0]];
        let (origin, edges) = found(Boundaries::Open, &places);
        assert_eq!(edges, Vector::new(11.0, 2.75, 2.75));
        assert!((origin + 0.5 * edges - Vector::new(2.25, 100.0, 5.0)).length() < 1e-13);
        let (origin, edges) = found(Boundaries::OpenAlongZ, &places);
        assert_eq!((origin, edges), (Vector::new(0.0, 0.0, 3.625), Vector::new(9.0, 9.0, 2.75)));
    }

    #[test]
    fn above_a_wall_a_box_grows_with_what_rises() {
        assert_eq!(found(Boundaries::Wall, &[[0.0, 0.0, 11.9]]), (Vector::ZERO, Vector::new(9.0, 9.0, 12.0)));
        assert_eq!(found(Boundaries::Wall, &[[0.0, 0.0, 12.1]]), (Vector::ZERO, Vector::new(9.0, 9.0, 13.0)));
    }

    /// All ranks agree, some without spheres; and edges grow in steps of at most an eighth.
    #[test]
    fn edges_are_few_and_those_of_all_ranks() {
        let places: Vec<[f64; 3]> = (0..5).map(|k| [f64::from(k) * 4.0, 0.0, -f64::from(k)]).collect();
        let alone = found(Boundaries::Open, &places);
        let on_ranks = Comm::threads(7, |comm| {
            let own: Vec<[f64; 3]> = places.iter().copied().skip(comm.rank()).step_by(7).collect();
            let cell = around(&scene(Boundaries::Open), &at(&own), 1.0, &comm);
            (cell.origin(), cell.edges())
        });
        assert!(on_ranks.iter().all(|cell| *cell == alone));
        for extent in (1..400).map(|k| 2.5 + 0.37 * f64::from(k)) {
            let edge = rounded_up(extent, 1.0);
            assert!(edge > extent && edge < extent * 1.1251, "{edge} for {extent}");
            assert!((rounded_up(3.0 * extent, 3.0) - 3.0 * edge).abs() < 1e-12, "an edge goes with the radius");
        }
    }
}
