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
from ._communicator import handle
from ._errors import Caution, InputError

if TYPE_CHECKING:
    from scipy.sparse.linalg import LinearOperator

_RIGID = "stresslets are given, but rigid particles have their own; set rigid to false"
_LUBRICATED = (
    'lubrication is for rigid particles with dipoles; set rigid to True and multipoles to "dipole", '
    "or lubrication to False"
)
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
    """(N, 5): xx, xy, xz, yy, yz, force*length; with lubrication the whole hydrodynamic ones"""
    stresslets_far: np.ndarray
    """(N, 5): the part of the stresslets that the far field sees"""
    strain_rates: np.ndarray
    """(N, 5): xx, xy, xz, yy, yz of the disturbance flow, 1/time; near zero for rigid spheres"""
    iterations: int
    """Iterations for the stresslets and for lubrication."""
    residual: float
    """The relative residual that they left."""
    seconds: float
    """The time that the evaluation took."""


@dataclass(frozen=True)
class Noise:
    """Random motions of N spheres whose covariance is their mobility, draw after draw.

    With a communicator the first rank has them; the arrays of the others are empty.
    """

    velocities: np.ndarray
    """(draws, N, 3), root of length/(force*time)"""
    angular_velocities: np.ndarray
    """(draws, N, 3); zero for point forces"""
    strain_rates: np.ndarray
    """(draws, N, 5): xx, xy, xz, yy, yz of the fluid, of spheres that are not rigid; else zero"""


@dataclass(frozen=True)
class Drift:
    """Random parts of what heat does to N rigid spheres in the mean, at kT = 1: the mean over many draws is the drift.

    With a communicator the first rank has them; the arrays of the others are empty.
    """

    velocities: np.ndarray
    """(draws, N, 3): their mean is the divergence of the mobility from forces to velocities"""
    angular_velocities: np.ndarray
    """(draws, N, 3): that of the mobility from forces to angular velocities"""
    stresslets: np.ndarray
    """(draws, N, 5): xx, xy, xz, yy, yz; the Brownian stresslets, those of the divergence of what forces cause"""


@dataclass(frozen=True)
class Plan:
    """How a mobility is computed."""

    method: str
    """"direct": every envelope on the grid; "split": a common wider Gaussian, and pairs near by"""
    grid: list[int]
    """Points along x, y and z."""
    support: list[int]
    """Points of a sphere's stencil along x, y and z."""
    precision: str
    """Of the grid's values: "f32" or "f64"."""
    tolerance: float
    """The relative error asked for."""
    expected_error: float
    """The relative error expected."""
    iteration_tolerance: float
    """The relative error left in the stresslets."""
    expected_seconds: float
    """Seconds expected for one evaluation by one thread; a solve takes one or two, and one for each iteration."""
    width: float | None
    """The width of the common Gaussian, if there is one."""
    cutoff: float | None
    """The distance within which pairs count, if there are any."""
    text: str
    """The plan as the program prints it."""

    def __str__(self):
        return f"{self.text}cost       {self.expected_seconds:.2g} s an evaluation, on one thread\n"


class Mobility:
    """The mobility of N spheres in a periodic box: loads to motions. Planned once, for any positions.

    box         edges (Lx, Ly, Lz), or three lattice vectors as rows, in right-handed order; length
    radii       (N,), or a number for all of `count` spheres; length
    viscosity   of the fluid; force*time/length^2
    tolerance   relative error allowed, from 1e-12 to 0.5
    lubrication whether near pairs of rigid spheres feel lubrication; or the gap where it ends, in radii of the pair's
                larger sphere (2.5 if it is True)
    rigid       whether to solve for the stresslets that keep the spheres rigid
    multipoles  "dipole": forces, torques and stresslets; "monopole": forces alone
    method      "direct": the envelopes themselves on the grid; "split": wider ones on a coarser grid, and the difference
                pair by pair; "auto": the one that takes less time
    strain      the box's Lees-Edwards strain: its second edge is (strain Ly, Ly, 0)
    boundaries  what the box is along x, y and z: one axis may have "walls" at 0 and at its edge, a "wall" at 0, or be
                "open", the others "periodic"; or all are "open": then the edges are to be longer than the spheres'
                centres are apart
    threads     threads that compute; the same for all that a process computes. As many as there are cores if left out
    comm        an mpi4py communicator whose ranks work together: every call is then collective, and arrays that are
                given and returned are those of the first rank
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
        spheres = ((rows, axes), _arrays.number("strain", strain), self._radii.tolist(), self._rigid)
        fluid = (_arrays.number("viscosity", viscosity), _arrays.number("tolerance", tolerance))
        terms = (self._dipoles, cutoff, *_arrays.words("method", method, 1))
        self._core = _core.Mobility(spheres, fluid, terms, handle(comm))
        self._positions: np.ndarray | None = None
        self._say(self._core.burden())

    @property
    def radii(self) -> np.ndarray:
        """(N,), length; read-only, since the mobility is planned for them."""
        return self._radii

    @property
    def plan(self) -> Plan:
        """How it is computed: method, grid, expected error and cost."""
        values, text = self._core.plan()
        return Plan(**json.loads(values), text=text)

    @property
    def positions(self) -> np.ndarray | None:
        """(N, 3), length; inside the box or not. A copy is taken: set them anew to move the spheres."""
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
    ) -> Motion:
        """The motions under loads.

        forces      (N, 3), force
        torques     (N, 3), force*length
        stresslets  (N, 5): xx, xy, xz, yy, yz, force*length; of spheres that are not rigid
        background  (3, 3), 1/time: the velocity gradient of the background flow, G[i, j] = du_i/dx_j, without trace;
                    between walls a shear of both
        pressure_gradient  (3,), force/length^3: dp/dx_i, which drives a flow between two walls

        What is left out is zero. Raises `Error` if no solution is found.
        """
        if self._positions is None:
            raise InputError("the spheres have no positions yet: set .positions")
        if stresslets is not None and self._rigid and self._dipoles:
            raise InputError(_RIGID)
        if not self._dipoles and (torques is not None or stresslets is not None):
            raise InputError(_POINTS)
        loads = (
            _load("forces", forces, self._radii, 3),
            _load("torques", torques, self._radii, 3),
            _load("stresslets", stresslets, self._radii, 5),
        )
        gradient = None if background is None else _arrays.exactly("background", background, (3, 3)).tolist()
        self._core.drive(_arrays.exactly("pressure_gradient", pressure_gradient, (3,)).tolist())
        (velocities, angular, strain_rates, stresslets, far, iterations, residual), seconds = self._core.apply(
            *loads, gradient
        )
        return Motion(velocities, angular, stresslets, far, strain_rates, iterations, residual, seconds)

    def noise(self, draws: int, seed: int, first: int = 0) -> Noise:
        """Random motions whose covariance is the mobility: what heat does to the spheres in a time dt at kT = dt/2.

        draws  how many
        seed   where random numbers start, from 0 on
        first  the number of the first draw: the same seed and number give the same motion, on any ranks

        Times sqrt(2 kT/dt) they are velocities whose displacements over dt have the variance 2 kT M dt; the mean drift,
        kT div M, is not in them.
        """
        draws, seed, first = self._draws(draws, seed, first)
        motions, clipped = self._core.noise(draws, seed, first)
        if clipped > 1e-3:
            self._say(f"{clipped:.1e} of the near field's weight is negative, as where spheres overlap, and left out")
        count = len(self._radii) if self._core.is_first else 0
        return Noise(*(np.reshape(motion, (draws, count, motion.shape[-1])) for motion in motions))

    def drift(self, draws: int, seed: int, first: int = 0) -> Drift:
        """Random parts of the drift kT div M that goes with `noise` of the same arguments, at kT = 1. Of rigid spheres."""
        draws, seed, first = self._draws(draws, seed, first)
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

        loads    "forces", "torques" or, of spheres that are not rigid, "stresslets"
        motions  "velocities", "angular_velocities", "stresslets" of rigid spheres, or "strain_rates" of others

        Its vectors are the arrays of a call, row after row: 3N numbers, 5N for tensors. It is that of the positions at
        each time. Forces to velocities and torques to angular velocities are symmetric to the tolerance.
        """
        from .operators import operator

        return operator(self, loads, motions)

    def square_root(self) -> LinearOperator:
        """A square root `B B^T = M` of the mobility as a scipy LinearOperator of 6N numbers, or 3N for point forces.

        `B @ z` has the velocities, row after row, and behind them the angular velocities; of normal numbers `z` its covariance
        is the mobility from forces and torques to these. It is that of the positions at each time, to the tolerance; each
        product takes as many solves as Lanczos's iteration takes, 5 to 40.
        """
        from .operators import square_root

        return square_root(self)

    def _root(self, numbers, transposed):
        """Six numbers a sphere, (N, 6), to six."""
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


def _load(name, value, radii, width):
    return None if value is None else _arrays.rows(name, value, len(radii), width)
