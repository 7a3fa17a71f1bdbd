//! Memory of a mobility and of the solve for stresslets.

use crate::envelope::Envelope;
use crate::grid::kernel::Load;
use crate::grid::stencil::Stencil;
use crate::pairs::moment_correction::MomentCorrection;
use crate::pairs::pair_correction::{PairCorrection, RECORD};
use crate::pairs::table::{PairFunctions, PairTable};
use crate::plan::device::{CardCounts, CardMemory, CardRanks, CardSteps, ComputeDevice, NearPairCounts};
use crate::plan::method::{GridlessBytes, RankParticles};
use crate::plan::problem::{Multipoles, Precision};
use crate::plan::{Plan, PlanError};
use crate::walls::wall_images::WallImages;
use domain::{Boundaries, Bytes, ExpectedCounts, Halo, Place, Tensor, Traceless, Vector, VerletList};
use gpu::EvaluationSize;
use solver::Real;

/// Memory that the [`crate::Mobility`] of a plan takes on a rank, forecast without building it.
pub struct Footprint<'a> {
    plan: &'a Plan,
    place: Place,
    grid: solver::GridFootprint,
    expected: &'a ExpectedCounts,
    threads: usize,
}

impl<'a> Footprint<'a> {
    /// Footprint on a rank with `threads` threads at `place`, with the particle counts that are expected there.
    pub fn new(plan: &'a Plan, place: &Place, threads: usize, expected: &'a ExpectedCounts) -> Self {
        let components = if plan.multipoles == Multipoles::Moments { 1 } else { 3 };
        let grid = solver::GridFootprint::new(plan.grid, place, plan.support.lanes);
        let grid = grid.of_components(components).tilted(plan.is_tilted);
        Self { plan, place: place.clone(), grid, expected, threads }
    }

    /// Precision of the grid.
    pub fn precision(&self) -> Precision {
        self.plan.precision
    }

    /// [`crate::Mobility`] with its particles arranged, and temporaries of the arrangement.
    pub fn mobility(&self) -> Bytes {
        if let Some(bytes) = self.gridless() {
            return bytes.arranged;
        }
        let grid = match self.plan.precision {
            Precision::Single => self.grid_in::<f32>(),
            Precision::Double => self.grid_in::<f64>(),
        };
        let (owned, present) = (self.expected.owned(), self.present());
        let arrangement = Halo::bytes(owned, present).then(Bytes::list::<(Vector, u32)>(present));
        // Stencils as they are found, sorted, and the former ones.
        let stencils = Bytes::list::<Stencil>(present).then(Bytes::list::<Stencil>(2.0 * present).freed());
        let images = Bytes::keep(WallImages::bytes(self.plan, owned, self.expected.total()));
        grid.then(arrangement).then(stencils).then(self.neighbours()).then(images)
    }

    /// Memory that a solve takes of a card, if the plan is for one, with near pairs and, for spheres with stresslets,
    /// the vectors of the iteration, and what steps keep or draw there. Several ranks have these on the host.
    /// Collective.
    pub fn card(
        &self,
        near: NearPairCounts,
        steps: &CardSteps,
        ranks: CardRanks,
    ) -> Result<Option<CardMemory>, PlanError> {
        if self.plan.device == ComputeDevice::Cpu {
            return Ok(None);
        }
        let neighbours = self.expected.neighbours(self.plan.cutoff());
        let (owned, ranks_with_card) = (self.expected.owned(), self.place.table()[1]);
        let counts = CardCounts { owned, present: self.present(), ranks: ranks_with_card };
        let iterates = ranks_with_card == 1 && self.plan.multipoles == Multipoles::Dipole;
        let near = if iterates { self.plan.near_bytes(owned, near, steps) } else { 0.0 };
        let CardSteps { random_vectors, .. } = *steps;
        let size = EvaluationSize { random_vectors, ..self.plan.size_on_card(counts, neighbours) };
        CardMemory::of(size.bytes().total() + near, ranks).map(Some)
    }

    /// Memory of a method without a grid.
    fn gridless(&self) -> Option<GridlessBytes> {
        let particles = RankParticles { owned: self.expected.owned(), total: self.expected.total() };
        self.plan.method.gridless().map(|gridless| gridless.bytes(self.plan.multipoles, particles))
    }

    fn grid_in<T: Real>(&self) -> Bytes {
        let operator = self.grid.operator::<T>();
        let more = match self.plan.boundaries {
            Boundaries::Periodic => Bytes::default(),
            Boundaries::Open => self.grid.open_space::<T>(),
            _ => self.grid.channel::<T>(),
        };
        let grid = self.grid.field::<T>().then(self.grid.transform::<T>(self.threads)).then(operator);
        // In a sheared box the operator is rebuilt repeatedly.
        grid.then(operator.freed()).then(more).then(Bytes::keep(self.tables::<T>()))
    }

    fn tables<T: Real>(&self) -> f64 {
        let Some(common) = self.plan.common() else { return 0.0 };
        if self.plan.multipoles == Multipoles::Moments {
            return MomentCorrection::table_bytes(common.width, self.plan.cutoff(), self.plan.table_tolerance());
        }
        let envelopes: Vec<_> = self.plan.radii.iter().map(|&a| Envelope::of_sphere(a)).collect();
        PairCorrection::<T>::table_bytes(&envelopes, common, self.plan.cutoff(), self.plan.table_tolerance())
    }

    fn neighbours(&self) -> Bytes {
        let cutoff = self.plan.cutoff();
        if cutoff == 0.0 {
            return Bytes::default();
        }
        let numbers = [cutoff, cutoff * VerletList::REACH].map(|reach| self.expected.neighbours(reach));
        VerletList::bytes([self.expected.owned(), self.present(), self.expected.total()], numbers)
    }

    /// Particles and images that reach into the rank's pencil.
    fn present(&self) -> f64 {
        let spacing = self.plan.spacing();
        let mismatch = self.plan.mismatch();
        let stencil = 0.5 * self.plan.support.support as f64 * spacing.y.max(spacing.z) + mismatch[0].max(mismatch[1]);
        self.expected.present(stencil.max(self.plan.cutoff()))
    }

    /// An evaluation, from loads to motions: loads of the particles present, also in the grid's precision; motions as
    /// they are found and returned to their owners. Some of the memory is kept for the next evaluation, which this is.
    pub fn evaluation(&self) -> Bytes {
        type Found = (Vector, Tensor);
        if let Some(bytes) = self.gridless() {
            return bytes.evaluation.then(self.motion());
        }
        let (owned, present) = (self.expected.owned(), self.present());
        let dipoles = self.plan.multipoles == Multipoles::Dipole;
        let loads = Bytes::list::<Vector>(present).then(Bytes::list::<Tensor>(if dipoles { present } else { 0.0 }));
        let near = if self.plan.cutoff() > 0.0 { present } else { 0.0 };
        let (spread, records) = match self.plan.precision {
            Precision::Single => (Bytes::list::<Load<f32>>(present), Bytes::list::<[f32; RECORD]>(near)),
            Precision::Double => (Bytes::list::<Load<f64>>(present), Bytes::list::<[f64; RECORD]>(near)),
        };
        let kept = Bytes::list::<Found>(present).then(records);
        let returned = Bytes::list::<Tensor>(if present > owned { 2.0 * present - owned } else { 0.0 });
        let passes = loads.then(spread.freed().or(returned.freed())).freed().or(self.motion().freed());
        kept.then(passes).freed().then(self.motion())
    }

    fn motion(&self) -> Bytes {
        let owned = self.expected.owned();
        let velocities = Bytes::list::<Vector>(owned);
        match self.plan.multipoles {
            Multipoles::Monopole | Multipoles::Moments => velocities,
            Multipoles::Dipole => velocities.then(Bytes::list::<(Vector, Traceless)>(owned)),
        }
    }

    /// [`crate::StressletSolver::solve`] without the memory of the mobility: a motion, unknowns, residual,
    /// preconditioned residual, direction and its loads, and an evaluation. Forces and stresslets at the start take
    /// less and are released by then.
    pub fn solve(&self) -> Bytes {
        if self.plan.multipoles == Multipoles::Monopole {
            return Bytes::list::<Vector>(self.expected.owned()).then(self.evaluation());
        }
        let owned = self.expected.owned();
        let unknowns = Bytes::list::<Traceless>(5.0 * owned).then(Bytes::list::<f64>(owned));
        unknowns.then(self.motion()).then(self.evaluation()).freed().then(self.motion())
    }

    /// [`crate::Mobility::velocity_field`]: in the grid's precision and in `f64`.
    pub fn velocity_field(&self) -> Bytes {
        let points = self.grid.points();
        Bytes::list::<[f64; 3]>(points).then(Bytes::list::<[f64; 3]>(points).freed())
    }

    /// [`crate::Mobility::flow`], plane by plane: loads, near-field functions, and the points of a plane with the
    /// velocities from the grid.
    pub fn flow(&self) -> Bytes {
        let [nx, ny, _] = self.plan.points_of_flow();
        let points = (nx * ny) as f64;
        let loads = |particles: f64| Bytes::list::<(Vector, Tensor)>(particles);
        // Images of particles whose near field reaches a plane: all, at most.
        let images = Bytes::list::<(Vector, Tensor, Vector, u64)>(self.expected.owned());
        let plane = Bytes::list::<Vector>(points).then(Bytes::list::<(u32, Stencil)>(points));
        let moved = Bytes::list::<(Vector, Tensor)>(points);
        let spread = match self.plan.precision {
            Precision::Single => Bytes::list::<Load<f32>>(self.present()),
            Precision::Double => Bytes::list::<Load<f64>>(self.present()),
        };
        let tables = Bytes::keep(self.tables_of_points());
        let planes = loads(self.expected.owned()).then(tables).then(plane.then(moved).or(images).freed());
        loads(self.present()).then(spread).freed().or(planes)
    }

    fn tables_of_points(&self) -> f64 {
        let Some(common) = self.plan.common() else { return 0.0 };
        let (cutoff, tolerance) = (self.plan.cutoff(), self.plan.table_tolerance());
        let functions = |&a: &f64| PairFunctions::new(Envelope::POINT, Envelope::of_sphere(a), common);
        let bytes = |functions: PairFunctions| PairTable::<f64>::bytes(&functions, cutoff, tolerance).unwrap_or(0.0);
        self.plan.radii.iter().map(functions).map(bytes).sum()
    }

    /// Grid points in the rank's share.
    pub fn points(&self) -> f64 {
        self.grid.points()
    }

    /// Distinct radii.
    pub fn radii(&self) -> &[f64] {
        &self.plan.radii
    }

    /// Plan for the velocity field of the fluid, in a box at its largest strain; none if no grid can represent it.
    pub fn plan_of_flow(&self, largest_strain: f64) -> Option<Plan> {
        self.plan.of_flow(largest_strain).ok()
    }

    /// Place of this rank among those that share the grid of another plan.
    pub fn place_of(&self, plan: &Plan) -> Place {
        let ([rows, columns], [row, column]) = (self.place.table(), self.place.index());
        Place::of(rows * columns, row * columns + column, [plan.grid[1], plan.grid[2]])
    }

    /// Upper bound of the memory of other ranks on the same machine that is mapped here: the columns of all others.
    pub fn mapped_bytes(&self, ranks: usize) -> f64 {
        if !self.plan.has_grid() {
            return 0.0;
        }
        let own = match self.plan.precision {
            Precision::Single => self.grid.columns_bytes::<f32>(),
            Precision::Double => self.grid.columns_bytes::<f64>(),
        };
        own * (ranks - 1) as f64
    }

    /// Memory that is resident on this rank but belongs to other ranks on the same machine.
    pub fn remote_resident_bytes(&self) -> f64 {
        if !self.plan.has_grid() {
            return 0.0;
        }
        match self.plan.precision {
            Precision::Single => self.grid.reached_bytes::<f32>(),
            Precision::Double => self.grid.reached_bytes::<f64>(),
        }
    }
}
