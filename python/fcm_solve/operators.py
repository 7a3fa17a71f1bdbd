"""Parts of the mobility as scipy linear operators."""

import numpy as np

from ._arrays import finite as _finite
from ._arrays import numbers as _numbers
from ._extras import needed

_LOADS = {"forces": 3, "torques": 3, "stresslets": 5}
_MOTIONS = {"velocities": 3, "angular_velocities": 3, "stresslets": 5, "strain_rates": 5}
_CONJUGATE = {"forces": "velocities", "torques": "angular_velocities", "stresslets": "strain_rates"}

# E : S of two symmetric traceless tensors, as a bilinear form in their components xx, xy, xz, yy, yz.
_PRODUCT = np.array([[2, 0, 0, 1, 0], [0, 2, 0, 0, 0], [0, 0, 2, 0, 0], [1, 0, 0, 2, 0], [0, 0, 0, 0, 2]], float)


def operator(mobility, loads, motions):
    """The operator from loads to motions. By the symmetry of the mobility, its transpose maps the loads conjugate to
    `motions` to the motions conjugate to `loads`."""
    linalg = needed("scipy.sparse.linalg", "linear_operator")
    _check(loads, motions)
    count = len(mobility.radii)
    shape = (_MOTIONS[motions] * count, _LOADS[loads] * count)

    def matvec(x):
        return getattr(mobility(**{loads: np.reshape(_numbers(loads, x), (count, -1))}), motions).ravel()

    # A stresslet is exerted by the fluid on the sphere, a force on the fluid, so their signs differ.
    sign = -1 if (loads == "stresslets") != (motions == "strain_rates") else 1
    conjugate = {motion: load for load, motion in _CONJUGATE.items()}.get(motions)

    def rmatvec(y):
        if conjugate is None:
            raise NotImplementedError("stresslets of rigid spheres are conjugate to no load; there is no transpose")
        load = np.reshape(_numbers(motions, y), (count, -1)) @ _inverse_product(conjugate)
        motion = getattr(mobility(**{conjugate: load}), _CONJUGATE[loads])
        return sign * (motion @ _product(loads)).ravel()

    return linalg.LinearOperator(shape, matvec=matvec, rmatvec=rmatvec, dtype=np.float64)


def square_root(mobility):
    """The operator `B` with `B B^T = M`, from normal numbers to velocities and angular velocities."""
    linalg = needed("scipy.sparse.linalg", "square_root")
    count, kinds = len(mobility.radii), 2 if mobility._dipoles else 1

    def times(vector, transposed):
        numbers, vector = np.zeros((count, 6)), _numbers("numbers", vector)
        for kind in range(kinds):
            numbers[:, 3 * kind : 3 * kind + 3] = np.reshape(vector, (kinds, count, 3))[kind]
        found = mobility._root(_finite("numbers", numbers), transposed)
        return np.concatenate([found[:, 3 * kind : 3 * kind + 3].ravel() for kind in range(kinds)])

    shape = (3 * kinds * count, 3 * kinds * count)
    matvec, rmatvec = (lambda z: times(z, False)), (lambda y: times(y, True))
    return linalg.LinearOperator(shape, matvec=matvec, rmatvec=rmatvec, dtype=np.float64)


def _product(name):
    return _PRODUCT if name == "stresslets" else np.eye(3)


def _inverse_product(name):
    return np.linalg.inv(_product(name))


def _check(loads, motions):
    if loads not in _LOADS:
        raise ValueError(f"loads is {loads!r}; it needs to be one of {', '.join(_LOADS)}")
    if motions not in _MOTIONS:
        raise ValueError(f"motions is {motions!r}; it needs to be one of {', '.join(_MOTIONS)}")
