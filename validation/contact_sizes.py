"""Whether the viscosity of a dense suspension of rough spheres depends on the size of the box or on the stiffness of contacts: means
over several starts beside each other."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from contacts import RATIO, ROUGHNESS, SETTLED, STRAIN, measured
from support.page import table, write_section

FULL = "--full" in sys.argv[1:]
SPHERES, SEEDS = 200, range(1, 7 if FULL else 4)
CASES = ((0.45, 0.5), (0.50, 0.5)) if FULL else ((0.45, 0.5),)
STIFFER = 4.0
# Short enough for the stiffer springs too.
STEP = 0.00125
# Cases compared with the first one: spheres over its number, stiffness over its adapted stiffness.
WAYS = {"as it settles": (1.0, None), "half as many spheres": (0.5, None), f"{STIFFER:g} times as stiff": (1.0, STIFFER)}
ALLOWED = 3.0


def late(columns, name):
    return columns[name][columns["time"] >= SETTLED].mean()


def of_seed(case, spheres, seed, stiffness='"auto"'):
    """Viscosity, largest overlap in the mean, and the stiffness at the end."""
    columns, _ = measured(*case, spheres, seed, stiffness, STEP)
    settled = columns["contact_stiffness"][-1] if "contact_stiffness" in columns else float(stiffness)
    return late(columns, "relative_viscosity"), late(columns, "largest_overlap"), settled


def main():
    rows, failed = [], []
    with ThreadPoolExecutor(2) as two:
        for case in CASES:
            first = None
            for name, (share, times) in WAYS.items():
                stiffness = f"{times * first[2]:.6g}" if times else '"auto"'
                found = np.array(list(two.map(lambda seed: of_seed(case, round(SPHERES * share), seed, stiffness), SEEDS)))
                viscosity, overlap, settled = found.mean(axis=0)
                error = found[:, 0].std(ddof=1) / np.sqrt(len(found))
                first = first or (viscosity, error, settled)
                apart = abs(viscosity - first[0]) / np.hypot(error, first[1])
                rows.append([f"{case[0]:.0%}", f"{case[1]:g}", name, f"{viscosity:.1f} ± {error:.1f}", f"{settled:.0f}", f"{overlap:.2f}"])
                print(*rows[-1], flush=True)
                if apart > ALLOWED:
                    failed.append(f"{name} at {case[0]:.0%}: {apart:.1f} errors away")
    lines = [
        (f"{SPHERES} spheres of radii 1 and {RATIO}, roughness {ROUGHNESS}, steps of {STEP} in "
         f"strain, averages from a strain of {SETTLED:g} to {STRAIN:g}, means over {len(SEEDS)}"),
        f"starts with the errors that these have. Viscosities are to agree within {ALLOWED:g} errors. Overlaps are over the roughness.",
        "",
        *table(["φ", "μ", "", "relative viscosity", "stiffness", "largest overlap"], rows),
        "",
        f"Not so: {'; '.join(failed)}." if failed else "So it is.",
    ]
    write_section("dense.md", "contact-sizes", "Two boxes, two stiffnesses", lines)
    if failed:
        raise SystemExit("failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
