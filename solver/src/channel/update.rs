//! Channel update of the grid's columns with a wavevector in the plane.

use super::column::{ACROSS, ALONG, ColumnKernel};
use super::kernel::FUNCTIONS;
use super::{ChannelFaces, ChannelWeights};
use crate::fourier::StridedPointer;
use crate::layout::Layout;
use crate::{Grid, Real};
use simd::vectorised;
use std::marker::PhantomData;
use std::ops::Range;

/// Columns processed at once, in `f64` whatever the grid's precision: for long waves the contribution of the walls
/// and that of unbounded fluid nearly cancel.
const LANES: usize = 8;

type GroupLanes = [f64; LANES];

/// A group of neighbouring columns, with the numbers of [`ColumnKernel`].
struct ColumnGroup {
    /// Number of planes from either end beyond which the functions are negligible; 0 if there is no update.
    planes: usize,
    step: GroupLanes,
    /// Direction of the wavevector.
    direction: [GroupLanes; 2],
    along: [GroupLanes; ALONG],
    across: [GroupLanes; ACROSS],
}

/// Sums over planes, or amplitudes: by wall, by function, by component, real and imaginary.
type OfGroup = [[[[GroupLanes; 2]; 3]; 2]; 2];

/// Amplitudes of all groups of a panel.
pub(crate) type Amplitudes = [OfGroup; 2];

const ZERO: OfGroup = [[[[[0.0; LANES]; 2]; 3]; 2]; 2];

/// Groups of a rank's share of the spectrum.
pub(crate) struct Update<T> {
    blocks: Range<usize>,
    modes: Range<usize>,
    points: usize,
    groups: Vec<ColumnGroup>,
    precision: PhantomData<T>,
}

impl<T: Real> Update<T> {
    /// Groups per panel.
    const GROUPS: usize = T::LANES / LANES;

    pub fn new<P, A>(
        grid: &Grid,
        layout: &Layout,
        faces: &ChannelFaces,
        scale: f64,
        weights: &ChannelWeights<P, A>,
    ) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let (blocks, modes) = (layout.blocks.clone(), layout.modes.clone());
        let groups = modes.clone().flat_map(|mode| {
            blocks.clone().flat_map(move |block| (0..Self::GROUPS).map(move |g| [block * T::LANES + g * LANES, mode]))
        });
        let groups = groups.map(|first| ColumnGroup::new::<T, P, A>(grid, first, faces, scale, weights)).collect();
        Self { blocks, modes, points: grid.points()[2], groups, precision: PhantomData }
    }

    /// Bytes per column of a rank's share.
    pub const BYTES: usize = size_of::<ColumnGroup>() / LANES;

    fn panel(&self, [block, mode]: [usize; 2]) -> &[ColumnGroup] {
        let panel = (mode - self.modes.start) * self.blocks.len() + block - self.blocks.start;
        &self.groups[panel * Self::GROUPS..(panel + 1) * Self::GROUPS]
    }

    /// Amplitudes of the flow to add, from columns that hold forces; `None` if there is nothing to add.
    ///
    /// # Safety
    /// The columns can be read.
    pub unsafe fn amplitudes(&self, place: [usize; 2], components: [StridedPointer<T>; 3]) -> Option<Amplitudes> {
        let groups = self.panel(place);
        if groups.iter().all(|group| group.planes == 0) && place != [0, 0] {
            return None;
        }
        let mut amplitudes = [ZERO; 2];
        for (number, (group, found)) in groups.iter().zip(&mut amplitudes).enumerate() {
            if group.planes > 0 {
                let ends = self.ends(number, components);
                // SAFETY: guaranteed by the caller.
                vectorised(
                    #[inline(always)]
                    || unsafe { sum_forces(group, ends, found) },
                );
                group.solve(found);
            }
        }
        Some(amplitudes)
    }

    /// Adds the flow of the amplitudes.
    ///
    /// # Safety
    /// The columns can be read and written.
    pub unsafe fn add(&self, place: [usize; 2], amplitudes: &Amplitudes, components: [StridedPointer<T>; 3]) {
        for (number, (group, amplitudes)) in self.panel(place).iter().zip(amplitudes).enumerate() {
            if group.planes > 0 {
                let ends = self.ends(number, components);
                // SAFETY: guaranteed by the caller.
                vectorised(
                    #[inline(always)]
                    || unsafe { add(group, ends, amplitudes) },
                );
            }
        }
    }

    /// A group's columns from both ends: the first values, and the distances to the next.
    fn ends(&self, group: usize, components: [StridedPointer<T>; 3]) -> [[(*mut T, isize); 3]; 2] {
        let end = |last: bool| {
            components.map(|column| {
                let stride = column.stride as isize;
                let first = group * LANES + if last { (self.points - 1) * column.stride } else { 0 };
                (column.first.wrapping_add(first), if last { -stride } else { stride })
            })
        };
        [end(false), end(true)]
    }
}

/// Sums the forces over the planes from each end, times `s^i` and `i s^i`.
#[inline(always)]
unsafe fn sum_forces<T: Real>(group: &ColumnGroup, ends: [[(*mut T, isize); 3]; 2], sums: &mut OfGroup) {
    for end in 0..2 {
        let mut power = [1.0; LANES];
        let mut found = [[[[0.0; LANES]; 2]; 3]; 2];
        for plane in 0..group.planes {
            let number = plane as f64;
            for component in 0..3 {
                let (first, stride) = ends[end][component];
                for part in 0..2 {
                    for lane in 0..LANES {
                        // SAFETY: guaranteed by the caller.
                        let force =
                            unsafe { *first.offset(plane as isize * stride).add(part * T::LANES + lane) }.to_f64();
                        let weighed = power[lane] * force;
                        found[0][component][part][lane] += weighed;
                        found[1][component][part][lane] = number.mul_add(weighed, found[1][component][part][lane]);
                    }
                }
            }
            for lane in 0..LANES {
                power[lane] *= group.step[lane];
            }
        }
        sums[end] = found;
    }
}

/// Adds the flow to the velocities on the planes from each end.
#[inline(always)]
unsafe fn add<T: Real>(group: &ColumnGroup, ends: [[(*mut T, isize); 3]; 2], amplitudes: &OfGroup) {
    for end in 0..2 {
        let mut power = [1.0; LANES];
        let of = &amplitudes[end];
        for plane in 0..group.planes {
            let number = plane as f64;
            for component in 0..3 {
                let (first, stride) = ends[end][component];
                for part in 0..2 {
                    for lane in 0..LANES {
                        let level = number.mul_add(of[1][component][part][lane], of[0][component][part][lane]);
                        // SAFETY: guaranteed by the caller.
                        unsafe {
                            let place = first.offset(plane as isize * stride).add(part * T::LANES + lane);
                            *place = T::from_f64(power[lane].mul_add(level, (*place).to_f64()));
                        }
                    }
                }
            }
            for lane in 0..LANES {
                power[lane] *= group.step[lane];
            }
        }
    }
}

impl ColumnGroup {
    fn new<T: Real, P, A>(
        grid: &Grid,
        [first, mode]: [usize; 2],
        faces: &ChannelFaces,
        scale: f64,
        weights: &ChannelWeights<P, A>,
    ) -> Self
    where
        P: Fn(f64, f64) -> f64,
        A: Fn(f64) -> [f64; 2],
    {
        let mut group = Self {
            planes: 0,
            step: [0.0; LANES],
            direction: [[0.0; LANES]; 2],
            along: [[0.0; LANES]; ALONG],
            across: [[0.0; LANES]; ACROSS],
        };
        let nz = grid.points()[2] as f64;
        // Planes beyond the walls, where the exponentials grow.
        let beyond = nz - faces.height / grid.spacing().z;
        for lane in 0..LANES {
            let Some(column) = ColumnKernel::new(grid, [first + lane, mode], faces, scale, weights) else { continue };
            let planes = (negligible_exponent::<T>() / column.decay + beyond).ceil().min(nz);
            group.planes = group.planes.max(planes as usize);
            group.step[lane] = (-column.decay).exp();
            let mut of_lane = group.direction.iter_mut().chain(&mut group.along).chain(&mut group.across);
            for value in column.direction.iter().chain(&column.along).chain(&column.across) {
                of_lane.next().expect("as many numbers")[lane] = *value;
            }
        }
        group
    }

    /// Turns sums into amplitudes.
    fn solve(&self, sums: &mut OfGroup) {
        vectorised(
            #[inline(always)]
            || {
                let mut along = [[[0.0; LANES]; 2]; 2 * FUNCTIONS];
                let mut across = [[[0.0; LANES]; 2]; 2];
                for (wall, function, lane) in indices() {
                    let [n1, n2] = [self.direction[0][lane], self.direction[1][lane]];
                    let [x, y, z] = [0, 1, 2].map(|c| [0, 1].map(|part| sums[wall][function][c][part][lane]));
                    let place = 2 * wall + function;
                    for part in 0..2 {
                        along[place][part][lane] = n1 * x[part] + n2 * y[part];
                        if function == 0 {
                            across[wall][part][lane] = n1 * y[part] - n2 * x[part];
                        }
                    }
                    // Component along z, over i.
                    along[FUNCTIONS + place][0][lane] = z[1];
                    along[FUNCTIONS + place][1][lane] = -z[0];
                }
                let mut driven = [[[0.0; LANES]; 2]; 2 * FUNCTIONS];
                for p in 0..2 * FUNCTIONS {
                    for q in 0..2 * FUNCTIONS {
                        let entry = &self.along[if p >= q { p * (p + 1) / 2 + q } else { q * (q + 1) / 2 + p }];
                        for part in 0..2 {
                            for lane in 0..LANES {
                                driven[p][part][lane] =
                                    entry[lane].mul_add(along[q][part][lane], driven[p][part][lane]);
                            }
                        }
                    }
                }
                for (wall, function, lane) in indices() {
                    let [n1, n2] = [self.direction[0][lane], self.direction[1][lane]];
                    let place = 2 * wall + function;
                    for part in 0..2 {
                        let l = driven[place][part][lane];
                        let t = if function == 0 {
                            self.across[wall][lane] * across[0][part][lane]
                                + self.across[wall + 1][lane] * across[1][part][lane]
                        } else {
                            0.0
                        };
                        sums[wall][function][0][part][lane] = n1 * l - n2 * t;
                        sums[wall][function][1][part][lane] = n2 * l + n1 * t;
                    }
                    sums[wall][function][2][0][lane] = -driven[FUNCTIONS + place][1][lane];
                    sums[wall][function][2][1][lane] = driven[FUNCTIONS + place][0][lane];
                }
            },
        );
    }
}

/// Walls, functions of each, and lanes.
fn indices() -> impl Iterator<Item = (usize, usize, usize)> {
    (0..2).flat_map(|wall| (0..2).flat_map(move |function| (0..LANES).map(move |lane| (wall, function, lane))))
}

/// Exponent beyond which an exponential is below round-off.
fn negligible_exponent<T: Real>() -> f64 {
    4.0 - T::EPSILON.ln()
}
