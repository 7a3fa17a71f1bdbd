"""Families of runs: agreement with the command, continuation, and failing members."""

import fcm_solve as fcm
import pytest

FAMILY = {
    "seed": 3,
    "box": {"edges": [9.0, 9.0, 9.0]},
    "fluid": {"viscosity": 1.0},
    "species": [{"radius": 1.0, "volume_fraction": 0.1}],
    "flow": {"kind": "shear", "rate": 1.0},
    "hydrodynamics": {"tolerance": 1e-2},
    "time": {"step": 0.02, "steps": 4},
    "output": {"trajectory_every": 0},
    "ensemble": {"seeds": 2},
    "sweep": {"species[0].volume_fraction": [0.05, 0.1]},
}
MEMBERS = [f"point-{point:04}/seed-{seed:04}" for point in (1, 2) for seed in (3, 4)]


def test_every_member_is_run_once(tmp_path):
    out = tmp_path / "out"
    rows = fcm.run_family(FAMILY, out, cores=2)
    assert isinstance(rows, list)
    written = {member: (out / member / "observables.csv").stat().st_mtime_ns for member in MEMBERS}
    assert (out / "family.csv").read_text().startswith("point,values,quantity,species,verdicts,unit,species[0].volume_fraction,mean")
    assert fcm.run_family(FAMILY, out) == rows
    assert written == {member: (out / member / "observables.csv").stat().st_mtime_ns for member in MEMBERS}
    alone = {key: value for key, value in FAMILY.items() if key not in ("ensemble", "sweep")}
    with fcm.Simulation(fcm.Scene.from_dict(alone | {"seed": 4}), out=tmp_path / "alone") as simulation:
        simulation.run()
    [one, other] = [fcm.open(folder).observables.to_pandas()["relative_viscosity"] for folder in (tmp_path / "alone", out / MEMBERS[3])]
    assert list(one) == list(other)


def test_members_that_fail_are_named(tmp_path):
    family = FAMILY | {"sweep": {"particles.minimum_gap": [0.0, 3.0]}, "ensemble": {"seeds": [7]}}
    with pytest.raises(fcm.Error, match=r"point-0002/seed-0007 \(particles\.minimum_gap = 3\.0\) failed: can't place the spheres"):
        fcm.run_family(family, tmp_path / "out", cores=1)
    assert (tmp_path / "out" / "point-0001" / "seed-0007" / "observables.csv").exists()


def test_what_is_no_family_is_refused(tmp_path):
    scene = {key: value for key, value in FAMILY.items() if key not in ("ensemble", "sweep")}
    with pytest.raises(fcm.InputError, match=r"a scene of one run; a family has \[ensemble\] or \[sweep\]"):
        fcm.run_family(scene, tmp_path / "out")
    with pytest.raises(fcm.InputError, match="ensemble makes a family"):
        fcm.Scene.from_dict(FAMILY)
    with pytest.raises(fcm.InputError, match="can't read the scene"):
        fcm.run_family(tmp_path / "none.toml", tmp_path / "out")
