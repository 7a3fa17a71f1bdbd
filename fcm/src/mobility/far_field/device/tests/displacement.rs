//! Particles that move on a device, beside the box that wraps them.

use super::*;
use domain::{RemoteDisplacement, RemoteFrame, Tensor};

/// Lattice coordinates over the edges: on the faces, next to them as near as numbers are, and some edges away.
const PLACES: [f64; 9] = [0.0, 1.0, -1e-17, -1e-300, 1.0 - f64::EPSILON / 2.0, 1.0 + f64::EPSILON, -1.0, 2.7, -3.4];

/// Particles are inside the box, from where their lattice steps lead back to where the flow carries them, and
/// velocities change by that of images across these steps.
#[test]
fn particles_are_inside_the_box_after_a_displacement() {
    for shape in PERIODIC {
        let case = Case::random(1, shape, 1.0);
        let (cell, mut device) = (case.cell, case.on_device(&case.plan(Precision::Double), emulator(&[], 1)));
        let holder = device.coupled().unwrap().holder();
        let place = |x, y, z| cell.position(Vector::new(x, y, z) * cell.edges());
        let along = |x| PLACES.into_iter().flat_map(move |y| PLACES.into_iter().map(move |z| place(x, y, z)));
        let places: Vec<Vector> = PLACES.into_iter().flat_map(along).collect();
        let hold = |list: &[Vector]| holder.hold(bytemuck::cast_slice(list));
        let gradient = Tensor::from_cols(Vector::ZERO, Vector::X, Vector::new(0.0, 0.5, 0.0));
        let deformation = Tensor::from_cols(Vector::X * 1.5, Vector::new(0.25, 1.0, 0.0), Vector::Z * 0.75);
        let renaming = [[1, -2, 0], [0, 1, 0], [3, 0, 1]];
        // A multiple of 2^32 changes nothing.
        let before = Vector::new(1.0 + 2.0_f64.powi(32), 1.0, 1.0);
        let advance = |weight: f64, farthest: f64| {
            holder.advance(&RemoteDisplacement {
                positions: &hold(&vec![Vector::ZERO; places.len()]),
                steps: &hold(&vec![before; places.len()]),
                terms: &[(hold(&places), weight)],
                velocities: &[hold(&places)],
                frame: RemoteFrame { cell: &cell, gradient, deformation, renaming, farthest },
            })
        };
        let moved = advance(1.0, 1e3).unwrap();
        let copied = holder.copies(&[&moved.positions, &moved.steps, &moved.velocities[0]]);
        let [positions, steps, velocities] = [0, 1, 2].map(|k| copied[k].as_chunks::<3>().0);
        for (row, &place) in places.iter().enumerate() {
            let carried = deformation * place;
            let [inside, velocity] = [positions[row], velocities[row]].map(Vector::from_array);
            let [x, y, z] = steps[row].map(|count| count as i32);
            let lattice = cell.lattice([x + 1, y - 1, z - 4]);
            assert!((inside + lattice - carried).length() < 1e-13 * cell.edges().length(), "{place}");
            assert!((velocity + gradient * lattice - carried).length() < 1e-13 * cell.edges().length(), "{place}");
            let fraction = cell.fractional_coordinates(inside);
            let excess = (fraction - Vector::splat(0.5)).abs().max_element() - 0.5;
            // The shear of a position rounds its coordinate along the flow, and tilts round all.
            let is_within = shape == Shape::Tilted || fraction.y >= 0.0 && fraction.y < 1.0;
            assert!(excess <= 4.0 * f64::EPSILON && is_within, "{place}: {fraction}");
        }
        assert!(advance(1.0, 2.0).is_none() && advance(f64::NAN, 1e3).is_none());
    }
}
