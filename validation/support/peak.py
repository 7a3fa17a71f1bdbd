"""Peak memory of a command: predicted by `fcm-solve check`, measured on each rank, and both in a table.

As a program, `python peak.py FILE COMMAND...` runs a command and adds a line with its rank and its peak resident memory, in
bytes, to a file."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

UNITS = {"B": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}


def predicted(program, words, ranks):
    """Bytes of the first rank and of each other rank, from the line `memory` of `fcm-solve check`."""
    command = [program, "check", *map(str, words), "--ranks", str(ranks), "--no-trial"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    line = next(line for line in text.splitlines() if line.startswith("memory"))
    bytes_of = [float(number) * UNITS[unit] for number, unit in re.findall(r"([\d.]+) ([kMGT]?B)\b", line)]
    return bytes_of[:1] + bytes_of[1:] * (ranks - 1)


def measured(program, words, ranks):
    """Bytes of each rank at the peak of a run of a scene, by rank."""
    with tempfile.TemporaryDirectory() as folder:
        peaks = pathlib.Path(folder) / "peaks"
        command = [sys.executable, __file__, peaks, program, "run", *words, "--out", pathlib.Path(folder) / "out"]
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        subprocess.run([*launcher, *map(str, command)], check=True, capture_output=True)
        found = dict(map(int, line.split()) for line in peaks.read_text().splitlines())
    return [found[rank] for rank in range(ranks)]


def main(path, *command):
    process = os.posix_spawnp(command[0], command, os.environ)
    _, status, usage = os.wait4(process, 0)
    rank = next((os.environ[name] for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK") if name in os.environ), "0")
    with open(path, "a") as file:
        file.write(f"{rank} {1024 * usage.ru_maxrss}\n")
    return os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
