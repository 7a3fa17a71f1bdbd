"""Moduli of a dense suspension under oscillating strain, by its amplitude: at small amplitudes contacts stay open, the storage
modulus of rigid spheres vanishes and the loss modulus is that of fixed positions; at large amplitudes contacts form and break."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from support.page import table, write_section
from support.program import results, rows_of

FULL = "--full" in sys.argv[1:]
AMPLITUDES = (0.001, 0.01, 0.05, 0.2, 1.0)
FRACTION, FRICTION, FREQUENCY, COUNTS = 0.45, 0.5, 1.0, {1.0: 73, 1.4: 27}
PERIODS = 6 if FULL else 3
# Largest G' over G'' at the smallest amplitude.
ALLOWED = 0.02


def moduli(amplitude):
    edge = (sum(4 / 3 * np.pi * radius**3 * count for radius, count in COUNTS.items()) / FRACTION) ** (1 / 3)
    species = "".join(f'[[species]]\nname = "{a:g}"\nradius = {a}\ncount = {n}\n' for a, n in COUNTS.items())
    period = 2 * np.pi / FREQUENCY
    steps = max(80, int(np.ceil(2 * np.pi * amplitude / 0.01)))
    scene = f"""seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
flow = {{ kind = "shear", oscillation = {{ amplitude = {amplitude}, frequency = {FREQUENCY} }} }}
contacts = {{ friction = {FRICTION} }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = {period / steps}, steps = {(PERIODS + 1) * steps} }}
statistics = {{ every = 1, from = {period * (1 - 1e-9)} }}
output = {{ trajectory_every = 0, observables_every = 0, checkpoint_every = 0 }}
{species}"""
    with results(scene) as out:
        harmonics = rows_of(out / "statistics" / "harmonics.csv")
    return [{name: float(value) for name, value in row.items()} for row in harmonics]


def main():
    with ThreadPoolExecutor(2) as two:
        found = dict(zip(AMPLITUDES, two.map(moduli, AMPLITUDES)))
    rows, smallest = [], found[AMPLITUDES[0]][0]
    for amplitude, (first, third, *_) in found.items():
        loss = first["loss_modulus"]
        size = np.hypot(third["storage_modulus"], third["loss_modulus"]) / np.hypot(first["storage_modulus"], loss)
        rows.append([f"{amplitude:g}", f"{loss / smallest['loss_modulus']:.2f} ± {first['loss_modulus_error'] / smallest['loss_modulus']:.2f}",
                     f"{first['storage_modulus'] / loss:+.3f} ± {first['storage_modulus_error'] / loss:.3f}", f"{size:.3f}"])
        print(*rows[-1], flush=True)
    lines = [
        f"{sum(COUNTS.values())} spheres at {FRACTION:.0%}, friction {FRICTION:g}, averaged over {PERIODS} periods after the first. At small",
        "amplitudes contacts open and the stress is viscous, due to lubrication. At large amplitudes each half period is a",
        "shear flow in which contacts form and the stress grows with the strain, which gives a third harmonic.",
        "",
        *table(["amplitude", "G'' / that at the first", "G' / G''", "third / first harmonic"], rows),
    ]
    write_section("dense.md", "oscillation", "Moduli by amplitude", lines)
    if abs(smallest["storage_modulus"]) > ALLOWED * smallest["loss_modulus"]:
        raise SystemExit(f"failed: G' is {smallest['storage_modulus']:.4g} where G'' is {smallest['loss_modulus']:.4g}")


if __name__ == "__main__":
    main()
