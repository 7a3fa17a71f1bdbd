"""Rigid bodies made of the spheres of a mobility."""

import numpy as np

from . import _arrays
from ._errors import InputError


class RigidBodies:
    """Bodies of N spheres, from lists of indices or from the number of the body of each sphere, -1 for free ones."""

    def __init__(self, given, spheres):
        self._of = np.full(spheres, -1) if given is None else _numbers(given, spheres)
        self.count = int(self._of.max(initial=-1)) + 1
        self._members = [np.flatnonzero(self._of == body) for body in range(self.count)]
        empty = [body for body, members in enumerate(self._members) if len(members) == 0]
        if empty:
            raise InputError(f"bodies has no spheres of body {empty[0]}; their numbers need to be 0 to {self.count - 1}")

    @property
    def numbers(self):
        """The number of the body of each sphere, None for a free one."""
        return [int(body) if body >= 0 else None for body in self._of]

    def loads(self, of_spheres, of_bodies, positions):
        """Forces and torques on the spheres, None for zeros: those given, and the loads on bodies shared by their spheres."""
        names, count = ("forces", "torques"), len(self._of)
        given = [_arrays.rows_or_none(name, value, count) for name, value in zip(names, of_spheres, strict=True)]
        whole = [
            _arrays.rows_or_none(f"body_{name}", value, self.count)
            for name, value in zip(names, of_bodies, strict=True)
        ]
        if all(value is None for value in whole):
            return given
        forces, torques = (np.zeros((count, 3)) if value is None else value.copy() for value in given)
        force, torque = (np.zeros((self.count, 3)) if value is None else value for value in whole)
        for body, members in enumerate(self._members):
            arms = positions[members] - positions[members].mean(axis=0)
            forces[members] += force[body] / len(members)
            torques[members] += (torque[body] - np.cross(arms, force[body])) / len(members)
        return [forces, torques]

    def given_motions(self, velocities, angular_velocities):
        """Given velocities and angular velocities (B, 6), NaN for free components; None if none is given."""
        if velocities is None and angular_velocities is None:
            return None
        names = ("body_velocities", "body_angular_velocities")
        both = zip(names, (velocities, angular_velocities), strict=True)
        given = [_arrays.rows_or_nan(name, value, self.count) for name, value in both]
        return np.concatenate(given, axis=1)

    def mobility(self, mobility):
        """The matrix of the bodies' mobility, a column for each load."""
        if self.count == 0:
            raise InputError("there are no rigid bodies: give bodies")
        columns = []
        for column in range(6 * self.count):
            load = np.zeros((self.count, 2, 3))
            load.flat[column] = 1.0
            motion = mobility(body_forces=load[:, 0], body_torques=load[:, 1])
            found = np.stack([motion.body_velocities, motion.body_angular_velocities], axis=1)
            columns.append(found.ravel())
        return np.stack(columns, axis=1)

    def refuse(self, name):
        """Refuses what is not known for rigid bodies."""
        if self.count:
            raise InputError(f"{name} is for free spheres; leave out bodies")


def _numbers(given, spheres):
    """The number of the body of each sphere, -1 for free ones."""
    if len(given) and np.ndim(given[0]) == 0:
        if len(given) != spheres:
            raise InputError(f"bodies has {len(given)} numbers; it needs to have one for each of {spheres} spheres")
        return np.array([_arrays.whole("bodies", number, -1) for number in given])
    of = np.full(spheres, -1)
    for body, members in enumerate(given):
        for sphere in members:
            index = _arrays.whole("bodies", sphere, 0)
            if index >= spheres:
                raise InputError(f"bodies has the sphere {index}; the last of {spheres} spheres is {spheres - 1}")
            if of[index] >= 0:
                raise InputError(f"bodies has the sphere {index} twice")
            of[index] = body
    return of

