"""Changes the program in one random place at a time, and counts the changes that its tests detect. Each is tested by the
tests of its crate. Verdicts are stored in the repository, so that a sample can be continued on any machine."""

import argparse
import collections
import json
import os
import pathlib

from mutation_tests import Copy
from mutations import all_mutations, known_as_equal, sampled

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "mutants"
VERDICTS = ROOT / "validation" / "data" / "mutants.jsonl"

OUTCOMES = ("detected", "timed out", "missed", "equivalent", "unviable", "not yet tested")

# Crates before those that depend on them, so that each is built once.
ORDER = """domain simd solver gpu lubrication statistics fcm hydrodynamics granular simulation suspension io/scene io/files
    io/report io/run fcm-solve""".split()


class Kept:
    """Verdicts by mutation, in a file with a line for each, in the order of their keys."""

    def __init__(self, path):
        self.path = path
        lines = path.read_text().splitlines() if path.exists() else []
        self.outcomes = dict(json.loads(line) for line in lines)

    def keep(self, mutation, outcome):
        self.outcomes[mutation.key] = outcome
        lines = [json.dumps(kept) + "\n" for kept in sorted(self.outcomes.items())]
        new = self.path.with_suffix(".tmp")
        new.write_text("".join(lines))
        new.replace(self.path)


def outcome_of(mutation, kept, equal):
    found = kept.outcomes.get(mutation.key, "not yet tested")
    return "equivalent" if found == "missed" and mutation.key in equal else found


def table(sample, kept, equal):
    """Lines of Markdown: the numbers of outcomes by folder, and the missed changes."""
    counts = collections.Counter((one.folder, outcome_of(one, kept, equal)) for one in sample)
    row = lambda cells: "| " + " | ".join(map(str, cells)) + " |"
    yield row(["crate", *OUTCOMES])
    yield row(["---"] * (1 + len(OUTCOMES)))
    folders = list(dict.fromkeys(crate.split("/")[0] for crate in ORDER))
    for folder in folders:
        yield row([folder, *(counts[folder, outcome] for outcome in OUTCOMES)])
    total = {outcome: sum(counts[folder, outcome] for folder in folders) for outcome in OUTCOMES}
    yield row(["all", *total.values()])
    detected, missed = total["detected"] + total["timed out"], total["missed"]
    if detected + missed:
        yield f"\ndetected {detected} of {detected + missed} that are not equivalent: {detected / (detected + missed):.1%}"
    for one in sample:
        if outcome_of(one, kept, equal) == "missed":
            yield f"missed {one.place}: {one.key}"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", type=int, default=300, help="number of changes (300)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the sample (1)")
    parser.add_argument("--only", help="changes whose description has this text, instead of a sample")
    parser.add_argument("--again", action="store_true", help="test missed changes again")
    parser.add_argument("--table", action="store_true", help="only print the table of stored verdicts")
    asked = parser.parse_args()
    mutations = list(all_mutations(ROOT))
    if asked.only:
        sample = [one for one in mutations if asked.only in f"{one.place}: {one.key}"]
    else:
        sample = sampled(mutations, asked.seed)[: asked.sample]
    kept, equal = Kept(VERDICTS), known_as_equal(ROOT)
    print(f"{len(sample)} changes of {len(mutations)}")
    if not asked.table:
        copy, left = Copy(ROOT, FOLDER), collections.defaultdict(list)
        for mutation in sample:
            found = outcome_of(mutation, kept, equal)
            if found == "not yet tested" or (asked.again and found == "missed"):
                left[mutation.crate].append(mutation)
        for crate in filter(left.get, ORDER):
            for mutation, outcome in copy.outcomes(crate, left[crate]):
                kept.keep(mutation, outcome)
                print(f"{outcome}: {mutation.place}: {mutation.key}", flush=True)
    print("\n".join(table(sample, kept, equal)))


if __name__ == "__main__":
    main()
