"""Projection to thousands of nodes: the time of an evaluation and of a step with lubrication, memory, and parallel efficiency.

The model of the network is first compared with published times of pencil transforms; the script fails if one is not reproduced. Then it
is applied to this program, with its own counts of messages and bytes on up to 64 ranks, and its own times on one thread.
`--measure counts` and `--measure work` count and time anew; otherwise those of validation/data/scale-measured.json are used."""

import argparse
import dataclasses

import numpy as np
from scaling import measured, pages, published
from support.page import write_section


def check(transforms, exponent):
    """The published times that the model does not reproduce."""
    ratios = published.ratios(transforms, exponent)
    return [(of, ratio) for of, ratio in zip(transforms, ratios) if abs(np.log(ratio)) > np.log(published.FACTOR)]


def main():
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--measure", choices=measured.PARTS, action="append", default=[], help="count or time anew")
    for part in arguments.parse_args().measure:
        measured.measure(part)
    found = published.transforms()
    fitted = [of for of in found if of.ranks <= published.RANKS]
    exponent = published.fitted_exponent(fitted)
    lines = pages.transforms(found, exponent)
    print(*lines, sep="\n")
    if wrong := check(fitted, exponent):
        raise SystemExit(f"failed: the model is not within a factor of {published.FACTOR} of {wrong}")
    stored = measured.load()
    lines += pages.projection(stored, exponent)
    print(*lines, sep="\n")
    counted, planned = pages.calls_of(stored)[False], pages.planned_calls()
    if not np.allclose(dataclasses.astuple(planned), dataclasses.astuple(counted), rtol=pages.DIFFERENCE):
        raise SystemExit(f"failed: plans for a network take {planned}, and {counted} are counted")
    write_section("scale.md", "scale", "Counts and projections", lines, command="scripts/validate scale")


if __name__ == "__main__":
    main()
