//! Pairs that Brownian displacements bring into overlap or below the minimum gap of lubrication.

use crate::error::gap::Gap;
use crate::model::{BrownianScheme, Extension, Integrator, Model};
use crate::neighbourhood::{PairsWithHalo, SeparatedPair};
use domain::{Boundaries, DomainView, Number, Particles};
use fcm::{CloseSpheres, Method};
use lubrication::LubricationRange;

/// Pairs, of two spheres or a sphere and a wall, that are too close at the positions where the motions were solved for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OverlapCounts {
    /// Number of overlapping pairs.
    pub overlapping: u64,
    /// Number of pairs below the minimum gap of lubrication, overlapping ones included; 0 without lubrication.
    pub at_minimum_gap: u64,
    /// Deepest overlap, a length; 0 without overlaps.
    pub depth: f64,
}

/// Detector of such pairs.
pub struct OverlapMonitor {
    /// Minimum gap of lubrication, below which the resistance is constant, over the mean radius; `None` without
    /// lubrication.
    floor: Option<f64>,
    last: OverlapCounts,
}

impl OverlapMonitor {
    /// A detector for a model.
    pub fn new(model: &Model) -> Self {
        let floor = model.hydrodynamics.lubrication.then_some(LubricationRange::MINIMUM_GAP);
        Self { floor, last: OverlapCounts::default() }
    }

    /// Distance of two centres up to which pairs are needed.
    pub fn range(&self, largest_radius: f64) -> f64 {
        (2.0 + self.floor.unwrap_or(0.0)) * largest_radius
    }

    /// Examines the particles at their present positions, with all pairs within [`Self::range`]. Collective.
    pub fn look(&mut self, particles: &Particles, domain: DomainView, near: &PairsWithHalo) {
        let (mut counts, mut depth) = ([0.0; 2], [0.0_f64]);
        let mut see = |gap: f64, mean_radius: f64| {
            counts[0] += f64::from(u8::from(gap < 0.0));
            counts[1] += f64::from(u8::from(self.floor.is_some_and(|floor| gap < floor * mean_radius)));
            depth[0] = depth[0].max(-gap);
        };
        for SeparatedPair { separation, radii: [a, b], .. } in near.pairs() {
            see(separation.length() - (a + b), 0.5 * (a + b));
        }
        for (&position, &radius) in particles.positions.iter().zip(&particles.radii) {
            domain.cell.to_walls(position).for_each(|to| see(to.distance - radius, radius));
        }
        domain.comm().sum(&mut counts);
        domain.comm().max(&mut depth);
        let [overlapping, at_minimum_gap] = counts.map(|count| count as u64);
        self.last = OverlapCounts { overlapping, at_minimum_gap, depth: depth[0] };
    }

    /// Takes pairs that were counted where the particles move.
    pub fn note(&mut self, found: CloseSpheres) {
        let CloseSpheres { overlapping, at_minimum_gap, depth } = found;
        self.last = OverlapCounts { overlapping, at_minimum_gap, depth };
    }

    /// Minimum gap of lubrication, over the mean radius; `None` without lubrication.
    pub fn minimum_gap(&self) -> Option<f64> {
        self.floor
    }

    /// Result of the last examination.
    pub fn last(&self) -> OverlapCounts {
        self.last
    }
}

/// Counts of steps with such pairs in a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct OverlappedSteps {
    steps: u64,
    with_overlap: u64,
    at_minimum_gap: u64,
    /// Maximum of each number over all steps.
    most: OverlapCounts,
}

impl OverlappedSteps {
    /// Adds a step to the counts.
    pub fn see(&mut self, crowded: OverlapCounts) {
        let OverlapCounts { overlapping, at_minimum_gap, depth } = crowded;
        self.steps += 1;
        self.with_overlap += u64::from(overlapping > 0);
        self.at_minimum_gap += u64::from(at_minimum_gap > 0);
        self.most.overlapping = self.most.overlapping.max(overlapping);
        self.most.at_minimum_gap = self.most.at_minimum_gap.max(at_minimum_gap);
        self.most.depth = self.most.depth.max(depth);
    }

    /// A warning, if there were such pairs.
    pub fn warning(&self, remedies: Remedies, smallest_radius: f64) -> Option<String> {
        let Self { steps, with_overlap, at_minimum_gap, most } = self;
        let overlapped = (*with_overlap > 0).then(|| {
            format!(
                "spheres overlapped in {with_overlap} of {steps} steps where their motions were solved for, up to {} \
                 at a time and by {} at most",
                pairs(most.overlapping),
                Gap { length: most.depth, radius: smallest_radius }
            )
        });
        let near = (*at_minimum_gap > 0).then(|| {
            format!(
                "in {at_minimum_gap} of {steps} steps up to {} had a gap below {} mean radii, where lubrication grows \
                 no more",
                pairs(most.at_minimum_gap),
                Number(LubricationRange::MINIMUM_GAP)
            )
        });
        let found: Vec<String> = [overlapped, near].into_iter().flatten().collect();
        (!found.is_empty()).then(|| {
            format!("{}; stresses and motions of these are not those of spheres: try {remedies}", found.join("; "))
        })
    }
}

fn pairs(count: u64) -> String {
    if count == 1 { "1 pair".to_owned() } else { format!("{count} pairs") }
}

/// Changes to a scene that would keep the spheres apart.
#[derive(Debug, Clone, Copy)]
pub struct Remedies {
    repels: bool,
    is_midpoint: bool,
    /// Whether the direct method is available and not yet used.
    may_be_direct: bool,
}

impl Remedies {
    /// Changes that are possible in a scene.
    pub fn of(model: &Model) -> Self {
        let is_midpoint = matches!(model.integrator, Integrator::Brownian(BrownianScheme::Midpoint));
        let may_be_direct = model.hydrodynamics.method != Some(Method::Direct)
            && model.cell.boundaries() == Boundaries::Periodic
            && matches!(model.flow.extension(), None | Some(Extension::Planar));
        Self { repels: model.repulsion.is_some(), is_midpoint, may_be_direct }
    }

    /// A warning that part of the random motions was left out, which does not happen if they are drawn on the grid
    /// alone.
    pub fn left_out(self, share: f64) -> String {
        let direct =
            if self.may_be_direct { "hydrodynamics.method = \"direct\", which leaves nothing out, " } else { "" };
        format!(
            "up to {share:.1e} of the weight of random motions was left out, as happens where spheres overlap much; \
             try {direct}{self}"
        )
    }
}

impl std::fmt::Display for Remedies {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let repulsion = if self.repels { "a larger repulsion.strength or repulsion.range" } else { "a [repulsion]" };
        // Half a step of the noise ignores lubrication in this scheme.
        let scheme = if self.is_midpoint { ", or time.brownian = \"random-finite-difference\"" } else { "" };
        write!(f, "a shorter time.step, {repulsion}{scheme}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{Comm, Partition, PeriodicBox, Vector};

    /// Pairs across faces of the box: one below the minimum gap, one overlapping, and one above the minimum gap; on any
    /// number of ranks.
    #[test]
    fn pairs_that_overlap_or_nearly_are_counted() {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 6)], 0.1, 1);
        for (lubrication, at_minimum_gap) in [(true, 2), (false, 0)] {
            let mut parameters = usual.clone();
            parameters.hydrodynamics.lubrication = lubrication;
            let model = Model::new(parameters).unwrap();
            for ranks in [1, 3] {
                let found = Comm::threads(ranks, |comm| {
                    let partition = Partition::new(&comm, [8, 8]);
                    let mut particles = Particles::default();
                    let of_first = if comm.is_first() { 3 } else { 0 };
                    for (id, (apart, z)) in
                        [(2.0 + 5e-7, 1.0), (1.75, 5.0), (2.0 + 2e-6, 9.0)].into_iter().enumerate().take(of_first)
                    {
                        particles.push(2 * id as u64, Vector::new(0.5, 0.5, z), 1.0, 0);
                        particles.push(2 * id as u64 + 1, Vector::new(0.5, 12.5 - apart, z), 1.0, 0);
                    }
                    particles.migrate(&partition, &cell);
                    let mut overlap_monitor = OverlapMonitor::new(&model);
                    let domain = DomainView { cell: &cell, partition: &partition };
                    let near = PairsWithHalo::find(&particles, domain, overlap_monitor.range(1.0));
                    overlap_monitor.look(&particles, domain, &near);
                    overlap_monitor.last()
                });
                for crowded in found {
                    assert_eq!((crowded.overlapping, crowded.at_minimum_gap), (1, at_minimum_gap));
                    assert!((crowded.depth - 0.25).abs() < 1e-14);
                }
            }
        }
    }

    /// A sphere that overlaps a wall and one that almost touches the other wall are counted.
    #[test]
    fn spheres_at_walls_are_counted() {
        let cell = PeriodicBox::new(Vector::splat(12.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
        let mut parameters = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 3)], 0.1, 1);
        parameters.hydrodynamics.lubrication = true;
        let model = Model::new(parameters).unwrap();
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let mut particles = Particles::default();
        for (id, z) in [0.95, 5.0, 11.0 - 5e-7].into_iter().enumerate() {
            particles.push(id as u64, Vector::new(1.0 + 4.0 * id as f64, 2.0, z), 1.0, 0);
        }
        let mut overlap_monitor = OverlapMonitor::new(&model);
        let domain = DomainView { cell: &cell, partition: &partition };
        let near = PairsWithHalo::find(&particles, domain, overlap_monitor.range(1.0));
        overlap_monitor.look(&particles, domain, &near);
        let OverlapCounts { overlapping, at_minimum_gap, depth } = overlap_monitor.last();
        assert_eq!((overlapping, at_minimum_gap), (1, 2));
        assert!((depth - 0.05).abs() < 1e-14);
    }

    /// Nothing is left out of random motions that are drawn on the grid alone; the warning names this method if the box
    /// supports it.
    #[test]
    fn the_direct_method_is_named_where_it_helps() {
        let mut parameters = Parameters::new(
            PeriodicBox::new(Vector::splat(12.0)).unwrap(),
            1.0,
            vec![Species::new("one", 1.0, 6)],
            0.1,
            1,
        );
        let said = |parameters: &Parameters| Remedies::of(&Model::new(parameters.clone()).unwrap()).left_out(0.0123);
        let direct =
            "try hydrodynamics.method = \"direct\", which leaves nothing out, a shorter time.step, a [repulsion]";
        assert!(said(&parameters).contains("up to 1.2e-2 of the weight"));
        assert!(said(&parameters).contains(direct), "{}", said(&parameters));
        parameters.hydrodynamics.method = Some(Method::Direct);
        assert!(said(&parameters).contains("try a shorter time.step"), "{}", said(&parameters));
        parameters.hydrodynamics.method = Some(Method::Split);
        assert!(said(&parameters).contains(direct));
        parameters.cell = parameters.cell.with_boundaries(Boundaries::Walls).unwrap();
        assert!(said(&parameters).contains("try a shorter time.step"), "{}", said(&parameters));
    }

    #[test]
    fn steps_without_such_pairs_are_not_worth_a_word() {
        let remedies = Remedies { repels: true, is_midpoint: true, may_be_direct: true };
        let mut steps = OverlappedSteps::default();
        steps.see(OverlapCounts::default());
        assert_eq!(steps.warning(remedies, 1.0), None);
        steps.see(OverlapCounts { overlapping: 0, at_minimum_gap: 1, depth: 0.0 });
        steps.see(OverlapCounts { overlapping: 2, at_minimum_gap: 3, depth: 0.01 });
        let said = steps.warning(remedies, 0.5).unwrap();
        assert_eq!(
            said,
            "spheres overlapped in 1 of 3 steps where their motions were solved for, up to 2 pairs at a time and by \
             0.01 (0.02 of the smallest radius) at most; in 2 of 3 steps up to 3 pairs had a gap below 1e-6 mean \
             radii, where lubrication grows no more; stresses and motions of these are not those of spheres: try a \
             shorter time.step, a larger repulsion.strength or repulsion.range, or time.brownian = \
             \"random-finite-difference\""
        );
        let without = Remedies { repels: false, is_midpoint: false, may_be_direct: true };
        assert!(steps.warning(without, 0.5).unwrap().ends_with("try a shorter time.step, a [repulsion]"));
    }
}
