//! Mean direction and order of the axes of spheres with orientations.

use super::observable::{Observable, measure};
use crate::model::Model;
use crate::rotation;
use crate::suspension::Suspension;
use domain::{Comm, Particles, Vector};
use lubrication::eigenvalues;
use simulation::Quantity;

/// Columns of the time series for each species with orientations.
const COLUMNS: [&str; 5] = ["x", "y", "z", "polar", "nematic"];

/// Order of the axes `p` of the spheres of one species, each sphere with the same weight.
///
/// The polar order is `|<p>|`; the nematic order is the eigenvalue of largest magnitude of `<3 p p - I> / 2`: 1 if all
/// axes are parallel or antiparallel, -1/2 if they are uniform in a plane, 0 if they are isotropic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisOrder {
    /// Mean axis, in the axes of the box.
    pub mean: Vector,
    /// Polar order.
    pub polar: f64,
    /// Nematic order.
    pub nematic: f64,
}

/// The order of the axes of each species; NaN for species without orientations. Collective.
pub fn orders(particles: &Particles, species: usize, comm: &Comm) -> Vec<AxisOrder> {
    let mut sums = vec![[0.0; 10]; species];
    for (orientation, &kind) in rotation::known(particles).iter().zip(&particles.species).filter(|(q, _)| q.is_some()) {
        let p = orientation.axis();
        let terms = [1.0, p.x, p.y, p.z, p.x * p.x, p.x * p.y, p.x * p.z, p.y * p.y, p.y * p.z, p.z * p.z];
        sums[kind as usize].iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
    }
    comm.sum(sums.as_flattened_mut());
    sums.iter().map(AxisOrder::of).collect()
}

impl AxisOrder {
    fn of([count, sums @ ..]: &[f64; 10]) -> Self {
        let [x, y, z, xx, xy, xz, yy, yz, zz] = sums.map(|sum| sum / count);
        let mean = Vector::new(x, y, z);
        let tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        let orders = eigenvalues(tensor).map(|eigenvalue| 1.5 * eigenvalue - 0.5);
        let nematic =
            orders.into_iter().fold(0.0, |most: f64, order| if order.abs() > most.abs() { order } else { most });
        Self { mean, polar: mean.length(), nematic: if *count > 0.0 { nematic } else { f64::NAN } }
    }
}

/// The order of each species with orientations in the time series; `None` without.
pub fn orientations(model: &Model) -> Option<Box<dyn Observable>> {
    let oriented: Vec<usize> =
        (0..model.species.len()).filter(|&index| model.species[index].orientation.is_some()).collect();
    let names = oriented.iter().map(|&index| model.species[index].name.clone()).collect();
    let table = Some((names, COLUMNS.map(String::from).to_vec()));
    let (species, axes, is_any) = (model.species.len(), model.user_axes(), !oriented.is_empty());
    let numbers =
        move |order: AxisOrder| axes.vector(order.mean).to_array().into_iter().chain([order.polar, order.nematic]);
    let observable = measure(Quantity { name: "orientation".into(), unit: "", table }, move |present| {
        let suspension: &Suspension = present.suspension();
        let orders = orders(suspension.particles(), species, suspension.comm());
        oriented.iter().flat_map(|&index| numbers(orders[index])).collect()
    });
    is_any.then_some(observable)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::{ORIENTATION, ORIENTATION_NUMBERS};
    use domain::Quaternion;

    /// Orders of spheres whose axes are along these vectors, and of one sphere without orientation, on a number of
    /// ranks.
    fn order(axes: &[Vector], ranks: usize) -> AxisOrder {
        let found = Comm::threads(ranks, |comm| {
            let mut own = Particles::default();
            let mut values = Vec::new();
            for (id, axis) in axes.iter().enumerate().filter(|(id, _)| id % ranks == comm.rank()) {
                own.push(id as u64, Vector::ZERO, 1.0, 1);
                values.extend(Quaternion::between(Vector::Z, *axis).to_array());
            }
            own.column(ORIENTATION, ORIENTATION_NUMBERS).values = values.into();
            own.push(axes.len() as u64, Vector::ZERO, 1.0, 2);
            orders(&own, 3, &comm)
        });
        assert!(found[0][0].nematic.is_nan() && found[0][2].polar.is_nan());
        found[0][1]
    }

    #[test]
    fn orders_of_known_axes() {
        let tilted = Vector::new(1.0, -2.0, 0.5).normalize();
        for ranks in [1, 2, 7] {
            let aligned = order(&[tilted; 8], ranks);
            assert!((aligned.polar - 1.0).abs() < 1e-14 && (aligned.nematic - 1.0).abs() < 1e-14);
            assert!((aligned.mean - tilted).length() < 1e-14);
            let both_ways = order(&[tilted, -tilted, tilted, -tilted], ranks);
            assert!(both_ways.polar < 1e-15 && (both_ways.nematic - 1.0).abs() < 1e-14);
            let in_plane = order(&[Vector::X, -Vector::X, Vector::Y, -Vector::Y], ranks);
            assert!(in_plane.polar < 1e-15 && (in_plane.nematic + 0.5).abs() < 1e-14);
            let isotropic = order(&[Vector::X, Vector::Y, Vector::Z, -Vector::X, -Vector::Y, -Vector::Z], ranks);
            assert!(isotropic.polar < 1e-15 && isotropic.nematic.abs() < 1e-14);
        }
    }
}
