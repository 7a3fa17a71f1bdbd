"""Ranks of mpi4py, if the package is built with MPI; else the message that says how to build it."""

import subprocess
import sys
import textwrap

import fcm_solve as fcm
import numpy as np
import pytest
from fcm_solve import _core

needs_mpi = pytest.mark.skipif(not _core.has_mpi, reason="the package is built without MPI")


def under_mpirun(ranks, script, folder):
    command = ["mpirun", "-n", str(ranks), sys.executable, "-c", textwrap.dedent(script)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


@needs_mpi
def test_ranks_agree_with_one(pair, tmp_path):
    (tmp_path / "scene.toml").write_text(fcm.Scene.from_dict(pair).to_toml())
    script = """
        from mpi4py import MPI
        import fcm_solve as fcm, numpy as np
        world = MPI.COMM_WORLD
        # The ranks in another order, which only a handle of the communicator itself knows.
        comm = world.Split(0, -world.rank)
        with fcm.Simulation("scene.toml", out="ranks", comm=comm) as simulation:
            simulation.force(lambda positions, time: 0.5 * (8 - positions))
            simulation.run()
            gap = simulation.smallest_gap
            assert (simulation.positions.shape == (2, 3)) == (comm.rank == 0)
        assert comm.allreduce(gap, MPI.MAX) == gap
        try:
            with fcm.Simulation("scene.toml", comm=comm) as simulation:
                simulation.force(lambda positions, time: 1 / 0)
        except (ZeroDivisionError, fcm.Error) as error:
            kinds = comm.gather((type(error).__name__, str(error)))
        if comm.rank == 0:
            print(*kinds, sep="\\n")
    """
    said = under_mpirun(2, script, tmp_path).splitlines()
    assert said[0] == "('ZeroDivisionError', 'division by zero')"
    assert said[1].startswith("('Error', ") and "division by zero" in said[1]
    with fcm.Simulation(pair) as simulation:
        simulation.force(lambda positions, time: 0.5 * (8 - positions))
        simulation.run()
        last = fcm.open(tmp_path / "ranks").trajectory[-1]
        assert np.allclose(last.positions, simulation.positions, rtol=0, atol=1e-6)


@needs_mpi
def test_the_mobility_takes_a_communicator(tmp_path):
    script = """
        from mpi4py import MPI
        import fcm_solve as fcm, numpy as np
        places = 4.0 * np.stack(np.meshgrid(*3 * [np.arange(3.0)]), -1).reshape(-1, 3)
        found = []
        for comm in (MPI.COMM_WORLD, None):
            M = fcm.Mobility(box=[12.0] * 3, radii=1.0, count=27, viscosity=1.0, comm=comm)
            M.positions = places
            found.append(M(forces=places - 4).velocities)
        if MPI.COMM_WORLD.rank == 0:
            assert np.allclose(*found, rtol=0, atol=1e-4)
            print("alike")
    """
    assert under_mpirun(2, script, tmp_path) == "alike\n"


@pytest.mark.skipif(_core.has_mpi, reason="the package is built with MPI")
def test_what_is_built_without_mpi_says_so(pair):
    scene = fcm.Scene.from_dict(pair)
    with pytest.raises(fcm.InputError, match="this package was built without MPI"):
        _core.Simulation.start((scene.to_toml(), "scene.toml"), None, (0, "a library"))
