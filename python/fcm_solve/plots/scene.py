"""The scene of a run, as far as plots need it."""

from importlib import import_module
from importlib.util import find_spec

import numpy as np

from .error import PlotError, damage
from .text import shown

AXES = ("x", "y", "z")


class Scene:
    """A scene as a dictionary, with derived values for plots."""

    def __init__(self, keys, folder):
        self.keys = keys
        self.kind = keys.get("kind", "suspension")
        self.title = shown(keys.get("title") or folder.resolve().name, 90)

    def check(self):
        """Raises an error if the value of a key has a wrong type."""
        if len(self.boundaries) != 3 or not isinstance(self.kind, str):
            raise ValueError("box.boundaries does not have three entries, or kind is not a string")
        numbers = [self.viscosity, self.thermal_energy, self.steady_rate or 0.0]
        forces = [] if self.kind != "suspension" else [self.force(place, 1.0) for place in range(len(self.species))]
        if not np.isfinite(numbers).all() or any(force.shape != (3,) for force in forces):
            raise ValueError("it has values of types that scenes do not have")

    def section(self, name):
        """A section of the scene; empty if it is absent."""
        section = self.keys.get(name, {})
        if not isinstance(section, dict):
            raise ValueError(f"{name} is not a section")
        return section

    @property
    def flow(self):
        """The kind of flow."""
        return self.section("flow").get("kind", "none")

    @property
    def steady_rate(self):
        """The rate of a steady shear flow; None otherwise."""
        flow = self.section("flow")
        rate = flow.get("rate")
        changes = {"control", "reversal_at", "oscillation", "stress"} & flow.keys()
        return float(rate) if self.flow == "shear" and isinstance(rate, (int, float)) and rate and not changes else None

    @property
    def oscillates(self):
        """Whether the flow oscillates."""
        return "oscillation" in self.section("flow")

    @property
    def viscosity(self):
        """The viscosity of the fluid."""
        return float(self.section("fluid").get("viscosity", 1.0))

    @property
    def thermal_energy(self):
        """kT; 0 without Brownian motion."""
        return float(self.section("fluid").get("thermal_energy", 0.0))

    @property
    def boundaries(self):
        """The boundary condition along each axis."""
        return list(self.section("box").get("boundaries", ["periodic"] * 3))

    @property
    def height_axis(self):
        """The axis normal to walls or to an open layer, 0 to 2; None for periodic boxes and for fluid open on all sides."""
        bounded = [axis for axis, boundary in enumerate(self.boundaries) if boundary != "periodic"]
        return bounded[0] if len(bounded) == 1 else None

    @property
    def species(self):
        """A dictionary for each species."""
        return list(self.keys.get("species", []))

    def force(self, index, radius):
        """Sum of the force on a sphere of a species and its weight, (3,)."""
        kind = self.species[index]
        gravity = np.array(self.section("gravity").get("acceleration", [0.0] * 3), dtype=float)
        weight = 4 / 3 * np.pi * radius**3 * kind.get("density_difference", 0.0) * gravity
        return np.array(kind.get("force", [0.0] * 3), dtype=float) + weight

    def stokes_velocity(self, index, radius):
        """Stokes velocity of a sphere of a species: alone in unbounded fluid, under its force and weight, (3,)."""
        return self.force(index, radius) / (6 * np.pi * self.viscosity * radius)

    @property
    def is_si(self):
        """Whether the numbers suggest SI units: Earth's gravity or a thermal energy at room temperature with spheres below a
        centimetre, or a shear cell for grains of millimetres."""
        if self.kind.startswith("shear-cell"):
            return 0 < float(self.section("grains").get("diameter", 1.0)) < 0.05
        gravity = np.linalg.norm(self.section("gravity").get("acceleration", [0.0] * 3))
        radii = [kind["radius"] for kind in self.species if isinstance(kind.get("radius"), float)]
        is_small = bool(radii) and max(radii) < 0.01
        return is_small and (9.7 < gravity < 9.9 or 1e-21 < self.thermal_energy < 1e-20)


def read_scene(folder):
    """The scene in a folder of results."""
    if not folder.is_dir():
        raise PlotError(f"{folder} is not a folder; name the results folder of a run")
    path = folder / "scene.toml"
    if not path.is_file():
        raise PlotError(f"{folder} holds no run: it has no scene.toml; name the folder given to the run by --out")
    # Python 3.10 has no reader of TOML.
    toml = import_module("tomllib" if find_spec("tomllib") else "tomli")
    with damage(path):
        scene = Scene(toml.loads(path.read_text(encoding="utf-8")), folder)
        scene.check()
        return scene
