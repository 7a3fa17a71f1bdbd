"""A batch job that a test instance of Slurm requeues twice, and that ends with the bits of an uninterrupted run."""

import pathlib
import tempfile

from support.page import write_section
from support.requeue import LAUNCHERS, end_state, requeued, uninterrupted
from support.slurm import Slurm

TIMES = 2


def main():
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        (place / "slurm").mkdir()
        slurm = Slurm(place / "slurm")
        uninterrupted(place / "whole")
        lines = [
            "A test instance of Slurm runs the job script `scripts/batch/slurm.sh` on two ranks and sends it SIGUSR1 twice, as",
            "`--signal` does before the time limit. The last checkpoint and all frames of the trajectory are bit for bit those of",
            "an uninterrupted run of `mpirun -n 2`. The log of the job, without progress lines:",
        ]
        try:
            slurm.start()
            for launcher, words in LAUNCHERS.items():
                out = place / launcher
                log = requeued(slurm, launcher, out, TIMES)
                if end_state(out) != end_state(place / "whole"):
                    raise SystemExit(f"failed: other bits after {launcher}:\n{log}")
                print(log)
                shown = [line for line in log.replace(f"{place}/", "").splitlines() if not line.startswith("step ")]
                lines += ["", f"`LAUNCH='{words}'`", "", "```text", *shown, "```"]
        finally:
            slurm.stop()
        write_section("clusters.md", "slurm", "A job requeued twice", lines)


if __name__ == "__main__":
    main()
