"""The mobility of spheres at given positions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike

from . import _arrays, _core
from ._bodies import RigidBodies
from ._communicator import handle
from ._errors import Caution, InputError

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

_RIGID = "stresslets are given, but rigid particles have their own; set rigid to false"
_LUBRICATED = (
    'lubrication is for rigid particles with dipoles; set rigid to True and multipoles to "dipole", '
    "or lubrication to False"
)
_BODIES = 'bodies are made of rigid spheres with dipoles; set rigid to True and multipoles to "dipole"'
_POINTS = 'torques and stresslets need dipoles; set multipoles to "dipole"'


@dataclass(frozen=True)
class Motion:
    """Motions of N spheres relative to the background flow, in the order of the radii.

    With a communicator the first rank has them; the arrays of the others are empty.
    """

    velocities: np.ndarray
    """(N, 3), length/time"""
    angular_velocities: np.ndarray
    """(N, 3), 1/time; zero for point forces"""
    stresslets: np.ndarray
    """(N, 5): xx, xy, xz, yy, yz, force*length; with lubrication the total hydrodynamic stresslets"""
    stresslets_far: np.ndarray
    """(N, 5): the part of the stresslets that acts in the far field"""
    strain_rates: np.ndarray
    """(N, 5): xx, xy, xz, yy, yz of the disturbance flow, 1/time; near zero for rigid spheres"""
    iterations: int
    """Number of iterations for the stresslets and for lubrication."""
    residual: float
    """Relative residual after these iterations."""
    seconds: float
    """Wall time of the evaluation."""
    body_velocities: np.ndarray
    """(B, 3), length/time: velocities of the centres of B rigid bodies, relative to the background flow there"""
    body_angular_velocities: np.ndarray
    """(B, 3), 1/time"""
    driving_forces: np.ndarray
    """(B, 3), force: what given motions of bodies take, in addition to the other loads; empty if none is given"""
    driving_torques: np.ndarray
    """(B, 3), force*length: the same, about the centres"""


@dataclass(frozen=True)
class Noise:
    """Random motions of N spheres whose covariance is their mobility, draw after draw.

    With a communicator the first rank has them; the arrays of the others are empty.
    """

    velocities: np.ndarray
    """(draws, N, 3), square root of length/(force*time)"""
    angular_velocities: np.ndarray
    """(draws, N, 3); zero for point forces"""
    strain_rates: np.ndarray
    """(draws, N, 5): xx, xy, xz, yy, yz of the fluid at spheres that are not rigid; else zero"""


@dataclass(frozen=True)
class Drift:
    """Random contributions to the Brownian drift of N rigid spheres at kT = 1; the mean over many draws is the drift.

    With a communicator the first rank has them; the arrays of the others are empty.
    """

    velocities: np.ndarray
    """(draws, N, 3): the mean is the divergence of the mobility from forces to velocities"""
    angular_velocities: np.ndarray
    """(draws, N, 3): the mean is the divergence of the mobility from forces to angular velocities"""
    stresslets: np.ndarray
    """(draws, N, 5): xx, xy, xz, yy, yz; the mean is the Brownian stresslets, the divergence of the stresslets due to forces"""


@dataclass(frozen=True)
class Plan:
    """The plan of a mobility: method, grid, expected error and cost."""

    method: str
    """"direct": every envelope on the grid; "split": a common wider Gaussian on the grid, and near pairs; "dense": a
    matrix of exact sums, without a grid"""
    grid: list[int] | None
    """Grid points along x, y and z; None without a grid."""
    support: list[int] | None
    """Grid points of a sphere's stencil along x, y and z; None without a grid."""
    precision: str
    """Floating-point type of the grid: "f32" or "f64"."""
    tolerance: float
    """The relative error allowed."""
    expected_error: float
    """The relative error expected."""
    iteration_tolerance: float
    """The relative tolerance of the iteration for the stresslets."""
    expected_seconds: float
    """Seconds expected for one evaluation on one thread; a solve takes one or two evaluations, and one for each iteration."""
    width: float | None
    """The width of the common Gaussian; None without one."""
    cutoff: float | None
    """The cutoff distance of near pairs; None without them."""
    text: str
    """The plan as printed by the program."""

    def __str__(self):
        return f"{self.text}cost       {self.expected_seconds:.2g} s an evaluation, on one thread\n"


class Mobility:
    """The mobility of N spheres in a box, which maps loads to motions. Planned once, for any positions.

    box         edges (Lx, Ly, Lz), or three lattice vectors as rows, in right-handed order; length
    radii       (N,), or a number for all of `count` spheres; length
    viscosity   of the fluid; force*time/length^2
    tolerance   relative error allowed, from 1e-12 to 0.5
    lubrication whether lubrication acts between near pairs of rigid spheres; or the gap where it ends, in radii of the
                pair's larger sphere (2.5 if True)
    rigid       whether to solve for the stresslets that keep the spheres rigid
    multipoles  "dipole": forces, torques and stresslets; "monopole": forces alone
    method      "direct": the envelopes themselves on the grid; "split": wider envelopes on a coarser grid, and a pair
                correction; "dense": a matrix of exact sums, for few spheres; "auto": the faster of the first two
    device      "gpu": the far field on an NVIDIA card, in periodic boxes; "cpu": on the processors of the host
    swimming    whether rigid spheres with dipoles may swim, see the arguments of a call
    bodies      rigid bodies made of rigid spheres: a list of lists of indices, or the number of the body of each sphere (N,),
                from 0, with -1 for free spheres. Bodies may touch, and the spheres of one body may overlap. The centre of
                a body is the mean of the centres of its spheres; its spheres are placed next to each other, not wrapped
    strain      the box's Lees-Edwards strain: its second edge is (strain Ly, Ly, 0)
    boundaries  boundary conditions along x, y and z: one axis may have "walls" at 0 and at its edge, a "wall" at 0, or be
                "open", the others "periodic"; or all are "open": then the edges need to be longer than the extent of the
                spheres' centres
    threads     number of threads, the same for all computations of a process; the number of cores by default
    comm        an mpi4py communicator whose ranks compute together: every call is then collective, and arguments and
                results are arrays of the first rank
    """

    def __init__(
        self,
        box: ArrayLike,
        radii: ArrayLike,
        viscosity: float,
        tolerance: float = 1e-3,
        lubrication: bool | float = False,
        rigid: bool = True,
        multipoles: str = "dipole",
        strain: float = 0.0,
        threads: int | None = None,
        comm: Any = None,
        count: int | None = None,
        boundaries: Sequence[str] = ("periodic", "periodic", "periodic"),
        method: str = "auto",
        device: str = "cpu",
        bodies: ArrayLike | Sequence[Sequence[int]] | None = None,
        swimming: bool = False,
    ) -> None:
        self._radii = _radii(radii, count)
        self._radii.flags.writeable = False
        self._rigid = _arrays.flag("rigid", rigid)
        self._dipoles = _has_dipoles(multipoles)
        cutoff = _cutoff(lubrication)
        if cutoff is not None and not (self._rigid and self._dipoles):
            raise InputError(_LUBRICATED)
        _core.start_threads(None if threads is None else _arrays.whole("threads", threads, 1))
        shape = (3, 3) if np.ndim(box) == 2 else (3,)
        rows = np.atleast_2d(_arrays.exactly("box", box, shape)).tolist()
        axes = _arrays.words("boundaries", boundaries, 3)
        spheres = ((rows, axes), _arrays.number("strain", strain), self._radii.tolist(), [self._rigid, _arrays.flag("swimming", swimming)])
        fluid = (_arrays.number("viscosity", viscosity), _arrays.number("tolerance", tolerance))
        terms = (self._dipoles, cutoff, *_arrays.words("method", method, 1), *_arrays.words("device", device, 1))
        self._core = _core.Mobility(spheres, fluid, terms, handle(comm))
        self._positions: np.ndarray | None = None
        self._bodies = RigidBodies(bodies, len(self._radii))
        if self._bodies.count and not (self._rigid and self._dipoles):
            raise InputError(_BODIES)
        self._core.join(self._bodies.numbers)
        self._say(self._core.burden())

    @property
    def radii(self) -> np.ndarray:
        """(N,), length; read-only, since the mobility is planned for them."""
        return self._radii

    @property
    def plan(self) -> Plan:
        """The plan: method, grid, expected error and cost."""
        values, text = self._core.plan()
        return Plan(**json.loads(values), text=text)

    @property
    def positions(self) -> np.ndarray | None:
        """(N, 3), length; inside the box or not. They are copied: assign them again to move the spheres."""
        return self._positions

    @positions.setter
    def positions(self, positions: ArrayLike) -> None:
        positions = np.array(_arrays.rows("positions", positions, len(self._radii)))
        self._say(self._core.place(positions))
        positions.flags.writeable = False
        self._positions = positions

    def __call__(
        self,
        forces: ArrayLike | None = None,
        torques: ArrayLike | None = None,
        stresslets: ArrayLike | None = None,
        background: ArrayLike | None = None,
        pressure_gradient: ArrayLike = (0.0, 0.0, 0.0),
        body_forces: ArrayLike | None = None,
        body_torques: ArrayLike | None = None,
        swimming_velocities: ArrayLike | None = None,
        active_stresslets: ArrayLike | None = None,
        body_velocities: ArrayLike | None = None,
        body_angular_velocities: ArrayLike | None = None,
    ) -> Motion:
        """The motions under loads.

        forces      (N, 3), force
        torques     (N, 3), force*length
        stresslets  (N, 5): xx, xy, xz, yy, yz, force*length; for spheres that are not rigid
        background  (3, 3), 1/time: the velocity gradient of the background flow, G[i, j] = du_i/dx_j, without trace;
                    between two walls, a shear flow of moving walls
        pressure_gradient  (3,), force/length^3: dp/dx_i, which drives a flow between two walls
        body_forces, body_torques  (B, 3): loads on the centres of bodies, in addition to those on spheres
        body_velocities, body_angular_velocities  (B, 3): given motions of bodies, relative to the background flow at the
                    centres, with NaN for components that follow from the loads; the result has the driving forces
        swimming_velocities, active_stresslets  (N, 3), length/time, and (N, 5), force*length: what each sphere has alone in
                    unbounded fluid by the slip at its surface, with swimming=True; squirmers that swim along p have
                    2/3 B1 p and 4 pi viscosity radius^2 B2 (p p - I/3)

        Arguments that are left out are zero. Raises `Error` if no solution is found.
        """
        if self._positions is None:
            raise InputError("the spheres have no positions yet: set .positions")
        if stresslets is not None and self._rigid and self._dipoles:
            raise InputError(_RIGID)
        if not self._dipoles and (torques is not None or stresslets is not None):
            raise InputError(_POINTS)
        loads = (
            *self._bodies.loads((forces, torques), (body_forces, body_torques), self._positions),
            _arrays.rows_or_none("stresslets", stresslets, len(self._radii), 5),
        )
        gradient = None if background is None else _arrays.exactly("background", background, (3, 3)).tolist()
        self._core.swim(
            _arrays.rows_or_none("swimming_velocities", swimming_velocities, len(self._radii), 3),
            _arrays.rows_or_none("active_stresslets", active_stresslets, len(self._radii), 5),
        )
        self._core.move_bodies(self._bodies.given_motions(body_velocities, body_angular_velocities))
        self._core.drive(_arrays.exactly("pressure_gradient", pressure_gradient, (3,)).tolist())
        (of_spheres, of_bodies, iterations, residual), seconds = self._core.apply(*loads, gradient)
        velocities, angular, strain_rates, stresslets, far = of_spheres
        return Motion(velocities, angular, stresslets, far, strain_rates, iterations, residual, seconds, *of_bodies)

    def body_mobility(self) -> np.ndarray:
        """The mobility matrix (6B, 6B) of the rigid bodies at the present positions, by 6B evaluations.

        It maps (F, T, F, T, ...), force and torque about the centre of each body, to velocities and angular velocities in the
        same order, and is symmetric to the tolerance. Free spheres have no loads.
        """
        return self._bodies.mobility(self)

    def body_resistance(self) -> np.ndarray:
        """The resistance matrix (6B, 6B) of the rigid bodies: the inverse of `body_mobility`, made symmetric."""
        mobility = self.body_mobility()
        return np.linalg.inv(0.5 * (mobility + mobility.T))

    def noise(self, draws: int, seed: int, first: int = 0) -> Noise:
        """Random motions whose covariance is the mobility: Brownian displacements over a time dt at kT = dt/2.

        draws  number of draws
        seed   seed of the random numbers, at least 0
        first  number of the first draw: the same seed and number give the same motion, on any number of ranks

        Multiplied by sqrt(2 kT/dt), they are velocities whose displacements over dt have the variance 2 kT M dt; the mean
        drift, kT div M, is not included.
        """
        draws, seed, first = self._draws(draws, seed, first)
        motions, clipped = self._core.noise(draws, seed, first)
        if clipped > 1e-3:
            self._say(f"{clipped:.1e} of the near field's weight is negative, as where spheres overlap, and left out")
        count = len(self._radii) if self._core.is_first else 0
        return Noise(*(np.reshape(motion, (draws, count, motion.shape[-1])) for motion in motions))

    def drift(self, draws: int, seed: int, first: int = 0) -> Drift:
        """Random contributions to the drift kT div M for `noise` of the same arguments, at kT = 1. For rigid spheres."""
        draws, seed, first = self._draws(draws, seed, first)
        self._bodies.refuse("drift")
        if not (self._rigid and self._dipoles):
            raise InputError("only rigid spheres drift: leave out rigid=False and multipoles=\"monopole\"")
        parts = self._core.drift(draws, seed, first)
        count = len(self._radii) if self._core.is_first else 0
        return Drift(*(np.reshape(part, (draws, count, part.shape[-1])) for part in parts))

    def _draws(self, draws: int, seed: int, first: int) -> tuple[int, int, int]:
        if self._positions is None:
            raise InputError("the spheres have no positions yet: set .positions")
        return _arrays.whole("draws", draws, 1), _arrays.whole("seed", seed, 0), _arrays.whole("first", first, 0)

    def linear_operator(self, loads: str, motions: str) -> LinearOperator:
        """The part of the mobility from `loads` to `motions` as a scipy LinearOperator.

        loads    "forces", "torques" or, for spheres that are not rigid, "stresslets"
        motions  "velocities", "angular_velocities", "stresslets" of rigid spheres, or "strain_rates" of others

        Its vectors are the flattened arrays of a call: 3N numbers, 5N for tensors. The operator always uses the present
        positions. Forces to velocities and torques to angular velocities are symmetric to the tolerance.
        """
        from .operators import operator

        return operator(self, loads, motions)

    def square_root(self) -> LinearOperator:
        """A square root `B B^T = M` of the mobility as a scipy LinearOperator of 6N numbers, or 3N for point forces.

        `B @ z` has the flattened velocities, followed by the angular velocities; for standard normal numbers `z`, its covariance
        is the mobility from forces and torques to velocities and angular velocities, to the tolerance. The operator always uses
        the present positions; each product takes as many solves as the Lanczos iteration has steps, 5 to 40.
        """
        from .operators import square_root

        return square_root(self)

    def _root(self, numbers, transposed):
        """Applies the square root or its transpose to six numbers a sphere, (N, 6)."""
        self._bodies.refuse("square_root")
        if self._positions is None:
            raise InputError("the spheres have no positions yet: set .positions")
        root, clipped = self._core.root(np.ascontiguousarray(numbers), transposed)
        if clipped > 1e-3:
            self._say(f"{clipped:.1e} of the mobility's weight is negative, as where spheres overlap, and left out")
        return root

    def _say(self, text):
        if text:
            warn(text, Caution, stacklevel=3)

    def __repr__(self):
        return f"<fcm_solve.Mobility of {len(self._radii)} spheres>"


def _radii(radii, count):
    if count is not None:
        return _arrays.row_each("radii", radii, _arrays.whole("count", count, 1))
    array = _arrays.numbers("radii", radii)
    if array.ndim != 1:
        raise InputError(f"radii has the shape {array.shape}; it needs to be (N,), or a number with count=N")
    return _arrays.row_each("radii", array, len(array))


def _cutoff(lubrication):
    if isinstance(lubrication, (bool, np.bool_)):
        return _core.LUBRICATION_CUTOFF if lubrication else None
    return _arrays.number("lubrication", lubrication)


def _has_dipoles(multipoles):
    if multipoles not in ("monopole", "dipole"):
        raise InputError(f'multipoles is {multipoles!r}; it needs to be "monopole" or "dipole"')
    return multipoles == "dipole"
