"""User-defined forces: their stress, pair forces between near spheres, and neighbour lists."""

import gc

import fcm_solve as fcm
import numpy as np
import pytest
from test_simulation import numbers_of, same_numbers

PLACES = np.array([[6.0, 8.0, 8.0], [8.6, 8.6, 8.2], [15.5, 1.0, 4.0], [1.8, 1.5, 4.5]])
RADII = [1.0, 1.0, 0.8, 0.8]
STIFFNESS, LENGTH = 5.0, 2.9


@pytest.fixture
def sheared():
    """Four spheres in shear: a pair inside the box, and a pair across a face of the box."""
    return {
        "box": {"edges": [16.0, 16.0, 16.0]},
        "fluid": {"viscosity": 1.0},
        "flow": {"kind": "shear", "rate": 0.5},
        "species": [{"name": "large", "radius": 1.0, "count": 2}, {"name": "small", "radius": 0.8, "count": 2}],
        "particles": {"initial": "positions", "positions": PLACES.tolist()},
        "hydrodynamics": {"tolerance": 1e-4},
        "time": {"step": 0.05, "steps": 6},
        "output": {"trajectory_every": 1, "observables_every": 1, "checkpoint_every": 3},
    }


def pulled(near, time):
    """Springs between near spheres."""
    return (STIFFNESS * (near.distances - LENGTH) / near.distances)[:, None] * near.separations


def moments_of(pairs, separations, forces):
    """First moments of the forces on the first particle of each pair: xx, xy, xz, yy, yz, zz."""
    outer = np.einsum("pi,pj->ij", separations, forces)
    return (0.5 * (outer + outer.T))[np.triu_indices(3)]


def total_stress(observables):
    return sum(table.sum(axis=0) for name, table in observables.items() if name.startswith("stress_"))


def test_forces_between_near_spheres_have_their_stress(sheared):
    with fcm.Simulation(sheared) as simulation:
        assert "stress_applied" not in simulation.observables
        simulation.pair_force(pulled, cutoff=3.2)
        near = simulation.neighbours(3.2)
        assert near.pairs.tolist() == [[0, 1], [2, 3]]
        assert np.allclose(near.separations[1], PLACES[3] - PLACES[2] + [16, 0, 0], rtol=0, atol=1e-14)
        observables = simulation.observables
        expected = moments_of(near.pairs, near.separations, pulled(near, 0.0)) / 16**3
        assert np.allclose(observables["stress_applied"].sum(axis=0), expected, rtol=1e-12)
        total = total_stress(observables)
        assert observables["relative_viscosity"] == pytest.approx(1 + total[1] / 0.5, rel=1e-12)
        assert observables["particle_pressure"] == pytest.approx(-(total[0] + total[3] + total[5]) / 3, rel=1e-12)
        simulation.run()


def test_they_are_shared_in_proportion_to_the_radii(sheared):
    places = PLACES.copy()
    places[1] += 3.0
    places[2] = [7.5, 9.0, 9.0]
    sheared["particles"] = {"initial": "positions", "positions": places.tolist()}
    with fcm.Simulation(sheared) as simulation:
        simulation.pair_force(lambda near, time: -near.separations, cutoff=2.2)
        assert simulation.neighbours(2.2).pairs.tolist() == [[0, 2]]
        large, small = simulation.observables["stress_applied"]
        assert np.allclose(large, small / 0.8, rtol=1e-12) and large[0] < 0


@pytest.mark.parametrize("way", ["pairs", "positions", "moments"])
def test_springs_of_one_s_own_are_those_of_the_scene(sheared, tmp_path, way):
    bonds = [{"pairs": [[0, 1]], "stiffness": STIFFNESS, "length": LENGTH}]

    def both(positions):
        separation = positions[1] - positions[0]
        distance = np.linalg.norm(separation)
        forces = np.zeros((4, 3))
        forces[0] = STIFFNESS * (distance - LENGTH) / distance * separation
        forces[1] = -forces[0]
        return forces, separation

    def with_moments(positions, time):
        forces, separation = both(positions)
        moments = np.zeros((4, 6))
        moments[:2] = 0.5 * moments_of([[0, 1]], separation[None], forces[:1])
        return forces, moments

    with fcm.Simulation(sheared | {"bonds": bonds}) as scene, fcm.Simulation(sheared) as own:
        if way == "pairs":
            own.pair_force(lambda near, t: np.where(near.pairs[:, :1] == 0, pulled(near, t), 0.0), cutoff=3.5)
        elif way == "positions":
            own.force(lambda positions, time: both(positions)[0], stress="positions")
        else:
            own.force(with_moments, stress="moments")
        for simulation in (scene, own):
            simulation.run(steps=4)
        assert np.allclose(own.positions, scene.positions, rtol=0, atol=1e-5)
        expected, found = scene.observables, own.observables
        assert np.abs(expected["stress_bond"]).max() > 1e-4
        assert np.allclose(found["stress_applied"].sum(axis=0), expected["stress_bond"].sum(axis=0), rtol=1e-3, atol=1e-8)
        assert found["relative_viscosity"] == pytest.approx(expected["relative_viscosity"], rel=1e-4)


def test_forces_from_outside_have_no_stress(sheared):
    with fcm.Simulation(sheared) as simulation:
        simulation.force(lambda positions, time: np.ones((4, 3)))
        assert "stress_applied" not in simulation.observables
        simulation.pair_force(pulled, cutoff=3.2)
        simulation.force(lambda positions, time: np.ones((4, 3)))
        near = simulation.neighbours(3.2)
        expected = moments_of(near.pairs, near.separations, pulled(near, 0.0)) / 16**3
        assert np.allclose(simulation.observables["stress_applied"].sum(axis=0), expected, rtol=1e-12)


def test_a_given_stress_is_that_with_one_s_own_forces(sheared):
    driven = sheared | {"flow": {"kind": "shear", "control": "stress", "stress": 0.6}}
    driven["time"] = {"step": 0.05, "duration": 0.3}
    with fcm.Simulation(driven) as simulation:
        simulation.pair_force(lambda near, time: -40 * near.separations / near.distances[:, None], cutoff=4.0)
        simulation.run(steps=1)
        observables = simulation.observables
        # The stress control includes it: otherwise the stress would be off by that of the springs.
        assert abs(observables["stress_applied"][:, 1].sum()) > 0.01 * 0.6
        assert observables["shear_stress"] == pytest.approx(0.6, rel=2e-3)


def test_the_stress_is_in_the_files_and_goes_on_in_resumed_runs(sheared, tmp_path):
    for name, parts in (("whole", [6]), ("parts", [3, 3])):
        for part, steps in enumerate(parts):
            folder = tmp_path / name
            with fcm.Simulation.resume(folder) if part else fcm.Simulation(sheared, out=folder) as simulation:
                simulation.pair_force(pulled, cutoff=3.2)
                simulation.run(steps=steps)
    same_numbers(numbers_of(tmp_path / "whole" / "observables.h5"), numbers_of(tmp_path / "parts" / "observables.h5"))
    series = fcm.open(tmp_path / "whole").observables.to_pandas()
    assert np.abs(series["stress_applied_xy[large]"]).min() > 0 and len(series) == 7
    with fcm.Simulation(sheared, out=tmp_path / "late") as simulation:
        simulation.step()
        with pytest.raises(fcm.Error, match="has begun without a column for the stress of your own forces"):
            simulation.pair_force(pulled, cutoff=3.2)
        simulation.force(lambda positions, time: np.zeros((4, 3)))
        simulation.run()


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (lambda x, t: np.ones((4, 3)), 'adds up to .*; with stress="positions" it needs to add up to zero'),
        (lambda x, t: np.ones((3, 3)), r"the force of <lambda> has the shape \(3, 3\); it needs to be \(4, 3\)"),
    ],
)
def test_forces_between_spheres_add_up_to_zero(sheared, function, message):
    with fcm.Simulation(sheared) as simulation:
        with pytest.raises(fcm.InputError, match=message):
            simulation.force(function, stress="positions")
        assert "stress_applied" not in simulation.observables


def test_what_is_no_force_is_refused_by_name(sheared):
    with fcm.Simulation(sheared) as simulation:
        with pytest.raises(fcm.InputError, match="stress is 'yes'; it needs to be None, \"moments\" or \"positions\""):
            simulation.force(pulled, stress="yes")
        with pytest.raises(fcm.InputError, match="returned ndarray; with stress=\"moments\" it is"):
            simulation.force(lambda x, t: np.zeros((4, 3)), stress="moments")
        with pytest.raises(fcm.InputError, match=r"the moments of <lambda> has the shape \(4, 5\); it needs to be \(4, 6\)"):
            simulation.force(lambda x, t: (np.zeros((4, 3)), np.zeros((4, 5))), stress="moments")
        with pytest.raises(fcm.InputError, match=r"the pair force of <lambda> has the shape \(4, 3\); it needs to be \(2, 3\)"):
            simulation.pair_force(lambda near, t: np.zeros((4, 3)), cutoff=3.2)
        with pytest.raises(fcm.InputError, match="the pair force of <lambda> contains nan"):
            simulation.pair_force(lambda near, t: np.full((2, 3), np.nan), cutoff=3.2)
        for cutoff in (0.0, -1.0, np.nan, "3"):
            with pytest.raises(fcm.InputError, match="cutoff"):
                simulation.pair_force(pulled, cutoff=cutoff)
        with pytest.raises(fcm.Error, match="the cutoff is 17; it needs to be at most 16, the shortest edge"):
            simulation.pair_force(pulled, cutoff=17.0)
        with pytest.raises(ZeroDivisionError):
            simulation.pair_force(lambda near, t: 1 / 0, cutoff=3.2)
        assert "stress_applied" not in simulation.observables

        @simulation.pair_force(cutoff=3.2)
        def added(near, time):
            return pulled(near, time)

        @simulation.force(stress="positions")
        def none(positions, time):
            return np.zeros((4, 3))

        simulation.run(steps=2)


def all_pairs(positions, lattice, cutoff):
    """Pairs within a cutoff, at most the shortest edge, with their separations, by a search over all images."""
    images = np.stack(np.meshgrid(*3 * [np.arange(-2, 3)], indexing="ij"), -1).reshape(-1, 3) @ lattice
    found = []
    for i, one in enumerate(positions):
        for j, other in enumerate(positions[i:], i):
            for number, image in enumerate(images):
                separation = other + image - one
                if np.linalg.norm(separation) < cutoff and (i < j or number > len(images) // 2):
                    found.append((i, j, separation))
    return found


@pytest.mark.parametrize("cutoff", [2.5, 6.0, 15.9])
def test_neighbours_are_all_pairs_within_the_cutoff(sheared, cutoff):
    many = sheared | {"species": [{"radius": 1.0, "count": 12}], "particles": {"initial": "random"}}
    with fcm.Simulation(many) as simulation:
        simulation.run(steps=6)
        near, positions = simulation.neighbours(cutoff), simulation.positions
        expected = all_pairs(positions, simulation.lattice, cutoff)
        assert sorted(map(tuple, near.pairs.tolist())) == sorted((i, j) for i, j, _ in expected)
        ways = {tuple(np.round(np.r_[i, j, d], 9)) for i, j, d in expected}
        found = {tuple(np.round(np.r_[pair, d], 9)) for pair, d in zip(near.pairs, near.separations, strict=True)}
        mirrored = {(i, j, *(-x if i == j else x for x in d)) for i, j, *d in ways}
        assert found <= ways | mirrored and len(near) == len(expected)
        assert np.allclose(near.gaps, np.linalg.norm(near.separations, axis=1) - 2.0, rtol=0, atol=1e-12)
        assert np.isclose(min(near.gaps, default=np.inf), simulation.smallest_gap) or cutoff < simulation.smallest_gap + 2


def test_views_can_not_be_written_to_and_outlive_everything(sheared):
    with fcm.Simulation(sheared) as simulation:
        near = simulation.neighbours(8.0)
        pairs, separations, gaps = near.pairs, near.separations, near.gaps
        kept = [array.copy() for array in (pairs, separations, gaps)]
        assert near.gaps is gaps and simulation._core.neighbours(8.0).gaps is not gaps
        assert np.shares_memory(near._core.gaps, gaps) and not gaps.flags.owndata
        for array in (pairs, separations, gaps, gaps[1:], separations.T):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 0
            with pytest.raises(ValueError, match="cannot set WRITEABLE"):
                array.flags.writeable = True
        simulation.run()
    del near, simulation
    gc.collect()
    for array, copy in zip((pairs, separations, gaps), kept, strict=True):
        assert np.array_equal(array, copy)


def test_grains_have_neighbours_too():
    scene = fcm.Scene.new("granular-disks").set({"box.edges": [30.0, 30.0], "time.strain": 0.05, "preparation.elastic_until": 21.0})
    with fcm.Simulation(scene) as simulation:
        simulation.run(steps=2)
        positions, lattice, radii = simulation.positions, simulation.lattice, simulation.radii
        near = simulation.neighbours(4.0)
        flat = lattice.copy()
        flat[2] *= 1e6
        expected = all_pairs(positions, flat, 4.0)
        assert len(near) == len(expected) > 100
        assert np.allclose(near.gaps + radii[near.pairs].sum(axis=1), near.distances, rtol=1e-12)
    scene = fcm.Scene.new("shear-cell").set({"grains.solid_fraction": 0.05, "time.steps": 3, "time.transient": 1e-3})
    with fcm.Simulation(scene) as simulation:
        lattice = simulation.lattice * [[1], [1e6], [1e6]]
        assert len(simulation.neighbours(3 * simulation.radii[0])) == len(
            all_pairs(simulation.positions, lattice, 3 * simulation.radii[0])
        )
        with pytest.raises(fcm.Error, match="supported for suspensions only"):
            simulation.pair_force(pulled, cutoff=0.1)
