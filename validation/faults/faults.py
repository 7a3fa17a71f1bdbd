"""Makes runs fail as disks, queues and users can make them fail: scripts/faults."""

import argparse
import pathlib
import sys
import tempfile

from kills import try_kills, try_stops
from places import try_run
from runs import RUNS

# Size of a quick sample.
QUICK_FAULTS, QUICK_KILLS, QUICK_STOPS = 8, 9, 2
KILLS, STOPS = 100, 20


def words():
    parser = argparse.ArgumentParser(prog="scripts/faults", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a sample of everything, in about a minute")
    parser.add_argument("--kills", type=int, metavar="N", help="kill N runs, and inject nothing")
    parser.add_argument("--only", metavar="NAME", action="append", choices=list(RUNS), help="this run; may be repeated")
    parser.add_argument("library", type=pathlib.Path, help=argparse.SUPPRESS)
    return parser.parse_args()


def inject(runs, folder, library, most):
    """Tries faults in each run and prints a row of a table; returns whether all were survived."""
    print("| run | faults | survived | calls of other ranks |\n|---|---|---|---|", flush=True)
    total, lost = 0, 0
    for number, run in enumerate(runs):
        ways = ("once", "stays", "short", "killed", "torn") if run.ranks is None else ("once",)
        tried, failures, others = try_run(run, folder / str(number), library, ways, most)
        print(f"| {run.name} | {tried} | {tried - len(failures)} | {others} |", flush=True)
        total, lost = total + tried, lost + len(failures)
    print(f"injected faults: {total - lost} of {total} survived", flush=True)
    return lost == 0


def disturb(runs, folder, kills, stops):
    """Kills runs and stops ranks; returns whether all were survived."""
    killed = try_kills(runs, folder, kills)
    print(f"kills: {kills - len(killed)} of {kills} survived", flush=True)
    parallel = [run for run in runs if run.ranks]
    stopped = try_stops(parallel, folder, stops)
    if parallel:
        print(f"stops of a rank: {stops - len(stopped)} of {stops} survived", flush=True)
    return not killed and not stopped


def main():
    asked = words()
    runs = [RUNS[name] for name in asked.only or RUNS]
    quick = asked.quick
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place).resolve()
        survived = True
        if asked.kills is None:
            injected = [run for run in runs if asked.only or not run.writes_as_another]
            survived = inject(injected, folder, asked.library, QUICK_FAULTS if quick else None)
        kills = asked.kills if asked.kills is not None else QUICK_KILLS if quick else KILLS
        survived &= disturb(runs, folder, kills, QUICK_STOPS if quick else STOPS)
    sys.exit(not survived)


if __name__ == "__main__":
    main()
