"""Counts and times that the projection starts from, stored so that the page can be written without measuring them again."""

import dataclasses
import json
import pathlib
import re
import tempfile

from scaling import counts, plans, work

FILE = pathlib.Path(__file__).resolve().parents[1] / "data" / "scale-measured.json"
EVALUATED, STEPPED = (2, 4, 8, 16, 32, 64), (8, 16)
PARTS = ("counts", "work", "plans")
# Spheres, ranks, and whether with lubrication, of the runs whose memory is predicted.
MEMORY = [(10**7, 1024, True), (10**9, 4096, False), (10**9, 65536, False), (10**9, 65536, True)]


def load():
    """All that is stored."""
    return json.loads(FILE.read_text()) if FILE.exists() else {}


def measure(part):
    """Measures a part, and stores it."""
    found = {"counts": measured_counts, "work": measured_work, "plans": measured_plans}[part]()
    FILE.write_text(json.dumps({**load(), part: found}, indent=1) + "\n")


def measured_counts():
    """Counts of an evaluation and of a step by the number of ranks."""
    found = {"evaluation": {}, "step": {}, "resumed": {}}
    with tempfile.TemporaryDirectory() as place:
        counter = counts.Counter(pathlib.Path(place))
        begun = counter.begun()
        for ranks in EVALUATED:
            of_rank, line = counter.evaluation(ranks)
            found["evaluation"][ranks] = {**of_rank.of, **{key: line[key] for key in ("bytes_sent", "messages_sent", "grid")}}
            print("evaluation", ranks, found["evaluation"][ranks], flush=True)
        for ranks in STEPPED:
            of_rank, resumed = counter.step(ranks, begun)
            found["step"][ranks], found["resumed"][ranks] = of_rank.of, resumed.of
            print("step", ranks, of_rank.of, flush=True)
    return found


def measured_work():
    """Seconds of an evaluation by the coarseness of the grid, and of a step of a sphere, on one thread of this machine."""
    works = {str(coarseness): dataclasses.asdict(of) for coarseness, of in work.evaluations().items()}
    model = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    return {"evaluation": works, "step_of_sphere": work.step(), "processor": model[1] if model else "unknown"}


def measured_plans():
    """Plans of a large scene without and with lubrication, and bytes of the largest rank."""
    memory = [[*case, plans.memory(*case)] for case in MEMORY]
    return {"large": [dataclasses.asdict(plans.large(lubricated)) for lubricated in (False, True)], "memory": memory}


def plan(stored, count, lubricated):
    """The plan of so many spheres."""
    return plans.Plan(**stored["plans"]["large"][lubricated]).of(count)


def works(stored):
    """Stored work by the coarseness of the grid."""
    return {float(coarseness): work.Work(**of) for coarseness, of in stored["work"]["evaluation"].items()}
