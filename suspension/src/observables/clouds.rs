//! Position, size and shape of clouds of spheres in unbounded fluid.

use super::observable::{Observable, measure};
use domain::{Comm, Particles, Vector};
use lubrication::eigenvalues;
use simulation::Quantity;

/// Columns of the time series for the cloud of each species.
const COLUMNS: [&str; 7] = ["x", "y", "z", "radius", "major", "middle", "minor"];

/// Mean position and extent of the spheres of one species, each sphere with the same weight.
///
/// With the gyration tensor `G = <(x - c)(x - c)>` about the centre `c = <x>` and its eigenvalues `g1 >= g2 >= g3`,
///
/// ```text
/// R = sqrt(5/3 (g1 + g2 + g3)),      a_k = sqrt(5 g_k)
/// ```
///
/// are the radius of the uniform ball and the semi-axes of the uniform ellipsoid with the same second moments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cloud {
    /// Mean position.
    pub centre: Vector,
    /// Radius of the equivalent ball.
    pub radius: f64,
    /// Semi-axes of the equivalent ellipsoid, in descending order.
    pub axes: [f64; 3],
}

/// The clouds of all species. Collective.
pub fn clouds(particles: &Particles, species: usize, comm: &Comm) -> Vec<Cloud> {
    let centres = means(particles, species, comm, |x, _| [x.x, x.y, x.z, 0.0, 0.0, 0.0]);
    let centres: Vec<Vector> = centres.iter().map(|c| Vector::new(c[0], c[1], c[2])).collect();
    let gyration = means(particles, species, comm, |x, of| {
        let d = x - centres[of];
        [d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z]
    });
    centres.iter().zip(gyration).map(|(&centre, g)| Cloud::of(centre, g)).collect()
}

impl Cloud {
    /// The cloud from the components `xx, xy, xz, yy, yz, zz` of the gyration tensor.
    fn of(centre: Vector, [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Self {
        let mut found = eigenvalues([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
        found.sort_by(|a, b| b.total_cmp(a));
        let axes = found.map(|g| (5.0 * g.max(0.0)).sqrt());
        Self { centre, radius: (5.0 / 3.0 * (xx + yy + zz)).sqrt(), axes }
    }
}

/// Means over the spheres of each species. Collective.
fn means(particles: &Particles, species: usize, comm: &Comm, of: impl Fn(Vector, usize) -> [f64; 6]) -> Vec<[f64; 6]> {
    let mut sums = vec![0.0; 7 * species];
    for (&x, &kind) in particles.positions.iter().zip(&particles.species) {
        let sum = &mut sums[7 * kind as usize..][..7];
        sum.iter_mut().zip(of(x, kind as usize).into_iter().chain([1.0])).for_each(|(sum, add)| *sum += add);
    }
    comm.sum(&mut sums);
    sums.chunks_exact(7).map(|sum| std::array::from_fn(|k| sum[k] / sum[6])).collect()
}

/// The clouds in the time series.
pub fn cloud(species: &[String]) -> Box<dyn Observable> {
    let table = Some((species.to_vec(), COLUMNS.map(String::from).to_vec()));
    measure(Quantity { name: "cloud".into(), unit: "length", table }, |present| {
        let numbers = |cloud: Cloud| cloud.centre.to_array().into_iter().chain([cloud.radius]).chain(cloud.axes);
        let suspension = present.suspension();
        let clouds = clouds(suspension.particles(), present.species(), suspension.comm());
        clouds.into_iter().flat_map(numbers).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Tensor;

    /// Two points on each axis of an ellipsoid, at `sqrt(3/5)` of its semi-axes, have the second moments of the uniform
    /// ellipsoid. Its centre and axes are recovered for any position and orientation, on any number of ranks.
    #[test]
    fn an_ellipsoid_is_found_by_its_axes() {
        let (centre, axes) = (Vector::new(1e3, -20.0, 7.0), [5.0, 3.0, 0.5]);
        let turn = Tensor::from_axis_angle(Vector::new(1.0, 2.0, -0.5).normalize(), 0.7);
        let points =
            |k: usize| [1.0, -1.0].map(|sign| centre + turn.col(k) * (sign * axes[k] * (3.0_f64 / 5.0).sqrt()));
        let places: Vec<Vector> = [2, 0, 1].into_iter().flat_map(points).collect();
        for ranks in [1, 2, 7] {
            let found = Comm::threads(ranks, |comm| {
                let mut particles = Particles::default();
                for (id, &place) in places.iter().enumerate().filter(|(id, _)| id % ranks == comm.rank()) {
                    particles.push(id as u64, place, 1.0, 1);
                    particles.push(id as u64 + 6, Vector::ZERO, 1.0, 0);
                }
                clouds(&particles, 2, &comm)
            });
            let [point, cloud] = found[0][..] else { panic!("two species") };
            assert_eq!(point, Cloud { centre: Vector::ZERO, radius: 0.0, axes: [0.0; 3] });
            assert!((cloud.centre - centre).length() < 1e-10);
            assert!(cloud.axes.iter().zip(axes).all(|(found, axis)| (found - axis).abs() < 1e-10), "{cloud:?}");
            let square = axes.iter().map(|a| a * a).sum::<f64>() / 3.0;
            assert!((cloud.radius - square.sqrt()).abs() < 1e-10);
        }
    }
}
