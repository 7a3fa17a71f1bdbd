"""The runner of other programs' tests, on synthetic checkouts."""

import sys
import textwrap
from pathlib import Path

import fcm_solve
import pytest

VALIDATION = Path(__file__).resolve().parents[2] / "validation"


@pytest.fixture
def peers(monkeypatch):
    monkeypatch.syspath_prepend(str(VALIDATION))
    import peers

    monkeypatch.setattr(peers, "PYTHON", sys.executable)
    monkeypatch.setenv("PYTHONPATH", str(Path(fcm_solve.__file__).parents[1]))
    return peers


def test_tests_pass_fail_or_do_not_apply(peers, tmp_path):
    (tmp_path / "tests").mkdir()
    (tmp_path / "libMobility.py").write_text("raise ImportError('the checkout itself')")
    (tmp_path / "tests" / "test_own.py").write_text(
        textwrap.dedent("""
            import numpy as np
            import pytest
            from libMobility import DPStokes, NBody, PSE, SelfMobility

            ALL = [(PSE, ("periodic",) * 3), (NBody, ("open",) * 3), (NBody, ("open", "open", "single_wall")),
                   (SelfMobility, ("open",) * 3), (DPStokes, ("periodic", "periodic", "two_walls"))]

            @pytest.mark.parametrize(("Solver", "periodicity"), ALL)
            def test_motion(Solver, periodicity):
                solver = Solver(*periodicity)
                solver.setParameters(**{} if Solver is NBody else {"Lx": 12.0, "Ly": 12.0} | (
                    {"Lz": 12.0} if Solver is PSE else {"zmin": 0.0, "zmax": 12.0}))
                solver.initialize(viscosity=1.0, hydrodynamicRadius=1.0)
                solver.setPositions([[1.0, 2.0, 0.1 if Solver is DPStokes else 3.0]])
                assert solver.Mdot(np.ones(3))[0].shape == (3,)

            def test_wrong():
                with pytest.raises(RuntimeError):
                    PSE("open", "open", "open")
                assert DPStokes.precision == "float"

            @pytest.mark.parametrize("framework", ["numpy", "torch"])
            def test_framework(framework):
                assert framework == "numpy"
        """)
    )
    counts, failures = peers.outcomes("libMobility", tmp_path)
    listed = {row[0]: row[1:] for row in peers.rows(counts)}
    assert listed["test_own.py, test_motion"][:3] == ["2", "", "3"]
    assert "there is no solver without hydrodynamic interactions here" in listed["test_own.py, test_motion"][3]
    assert "its random positions are not admissible here" in listed["test_own.py, test_motion"][3]
    assert listed["test_own.py, test_wrong"] == ["", "1", "", ""]
    assert listed["test_own.py, test_framework"][:3] == ["1", "", "1"]
    assert len(failures) == 1 and "test_wrong" in failures[0]
    assert not list(tmp_path.rglob("__pycache__")) and not list(tmp_path.rglob(".pytest_cache"))


def test_checkouts_that_are_none_are_named(peers, tmp_path, monkeypatch):
    for name in ("LIBMOBILITY", "JFSD"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(SystemExit, match="no checkout is named; set LIBMOBILITY or JFSD"):
        peers.main()
    monkeypatch.setenv("LIBMOBILITY", str(tmp_path))
    with pytest.raises(SystemExit, match="LIBMOBILITY is .*, which is not a checkout of libMobility"):
        peers.main()
    (tmp_path / "tests").mkdir()
    with pytest.raises(SystemExit, match="the tests of libMobility did not run"):
        peers.main()
