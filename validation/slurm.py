"""A batch job that is requeued twice by a real Slurm of its own, and ends with the bits of a run that was never stopped."""

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
            "Two ranks on a Slurm started for the purpose. The job script is `scripts/batch/slurm.sh`; twice the job is sent SIGUSR1, as",
            "`--signal` does before its end. The last checkpoint and all frames of the trajectory have the bits of a run of",
            "`mpirun -n 2` that was never stopped. The log of the job,",
            "but for its progress:",
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
        write_section("clusters.md", "slurm", "A job that was requeued twice", lines)


if __name__ == "__main__":
    main()
