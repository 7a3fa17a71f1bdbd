"""Two spheres in strain and settling, with lubrication, through the whole program: Fig. 3 of Abbas, Climent, Simonin & Maxey,
Phys. Fluids 18, 121504 (2006), and the velocities of its Fig. 2.

A, B and C (Batchelor & Green 1972) describe the motion of two force-free spheres in a rate of strain E: their relative velocity is
-[A rr/r^2 + B (1 - rr/r^2)] E r in addition to that of the flow, their angular velocity C r x E r / r^2. The program evaluates them,
and the velocities under a force on either sphere, in cubic periodic boxes of three sizes. They are extrapolated to a large box by the
laws of the effect of images: the inverse edge, through the drag on the pair as a whole, and its cube. Lubrication has the default
cutoff."""

import concurrent.futures
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from support import two_sphere
from support.page import save, table, write_section
from support.program import mobility

RATIOS = (1.0, 2.0)
# Over the radius of the smaller sphere.
GAPS = (1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0)
EDGES, TOLERANCE = (50.0, 100.0, 200.0), 1e-5
DENSITY_RATIOS = (1.0, 0.5, 1 / 3, 0.25)
# Allowed error: relative to the exact value, and in units of the ambient relative velocity or of the larger sphere's Stokes velocity.
LIMIT, SLACK = 0.01, 1e-3


def evaluate(ratio, gap, edge, lubrication):
    """[A, B, C1, C2] and U12, V12 for all density ratios, in one box."""
    distance = 1 + ratio + gap
    case = {"box": [edge] * 3, "viscosity": 1.0, "radii": [1.0, ratio], "lubrication": lubrication}
    case["positions"] = np.array([[0.25, 0.25, 0.25], [0.25, 0.25, 0.25 + distance]])
    gradient = [[-0.5, 0, 1.0], [0, -0.5, 0], [1.0, 0, 1.0]]
    strained = mobility(case | {"background": {"velocity_gradient": gradient}}, TOLERANCE)
    apart = np.subtract(*strained["velocities"][::-1]) / distance
    answers = [-apart[2], -apart[0], *(turning[1] for turning in strained["angular_velocities"])]
    relative = []
    for loaded in (0, 1):
        forces = np.zeros((2, 3))
        forces[loaded] = [6 * np.pi, 0, 6 * np.pi]
        relative.append(np.subtract(*mobility(case | {"forces": forces}, TOLERANCE)["velocities"][::-1]))
    for axis in (2, 0):
        for density in DENSITY_RATIOS:
            weights = np.array([1.0, density * ratio**3])
            answers.append(weights @ np.array(relative)[:, axis] / (density * ratio**2))
    return np.array(answers)


def in_large_box(job):
    """The constant of c + c1/L + c3/L^3 through the answers in the three boxes."""
    ratio, gap, lubrication = job
    powers = np.array([[1.0, 1 / edge, 1 / edge**3] for edge in EDGES])
    return np.linalg.solve(powers, np.array([evaluate(ratio, gap, edge, lubrication) for edge in EDGES]))[0]


def exact(ratio, gap):
    answers = list(two_sphere.strain_functions(ratio, gap))
    for mobilities in (two_sphere.along(ratio, gap)[0], two_sphere.across(ratio, gap)[0][:2, :2]):
        for density in DENSITY_RATIOS:
            velocities = 6 * np.pi * mobilities @ [1.0, density * ratio**3]
            answers.append((velocities[1] - velocities[0]) / (density * ratio**2))
    return np.array(answers)


def draw(answers, far_field):
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained", sharey=True)
    fine = np.geomspace(GAPS[0], GAPS[-1], 80)
    for axes, ratio in zip(panels, RATIOS):
        curves = np.array([two_sphere.strain_functions(ratio, gap) for gap in fine])
        for k, name in enumerate(("A", "B", "C") if ratio == 1 else ("A", "B", "C, small", "C, large")):
            axes.semilogx(fine, curves[:, k], color=f"C{k}", label=name)
            axes.semilogx(GAPS, [answers[ratio, gap][k] for gap in GAPS], "o", color=f"C{k}", fillstyle="none")
            axes.semilogx(GAPS, [far_field[ratio, gap][k] for gap in GAPS], ":", color=f"C{k}")
        axes.set_title(f"radii 1 : {ratio:g}")
        axes.set_xlabel("gap / $a_1$")
        axes.legend()
    panels[0].set_ylabel("lines exact, circles with lubrication, dots FCM alone")
    save(figure, "fig3.png")


def rows(ratio, answers):
    for gap in GAPS:
        right, found = exact(ratio, gap), answers[ratio, gap]
        cells = [f"{gap:g}"]
        for k in (0, 1, 2, 3, 4, 8):
            cells += [f"{right[k]:.5f}", f"{found[k]:.5f}"]
        yield cells


def worst(ratio, answers):
    """The largest error over the allowed one: a hundredth of the exact value, or a thousandth where that is below a tenth."""
    right, found = (np.array([which(gap) for gap in GAPS]) for which in (lambda g: exact(ratio, g), lambda g: answers[ratio, g]))
    return (np.abs(found - right) / np.maximum(LIMIT * np.abs(right), SLACK)).max()


def main():
    jobs = [(ratio, gap, lubrication) for ratio in RATIOS for gap in GAPS for lubrication in (True, False)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(jobs, pool.map(in_large_box, jobs)))
    answers, far_field = ({job[:2]: value for job, value in found.items() if job[2] == kind} for kind in (True, False))
    draw(answers, far_field)
    lines, failed = ["![A, B and C](figures/fig3.png)", ""], []
    for ratio in RATIOS:
        over = worst(ratio, answers)
        lines += [f"Radii 1 : {ratio:g}. U12 and V12 are along and across the line of centres, for equal densities, in units of the"]
        lines += [f"Stokes velocity of the large sphere. The largest error, for four density ratios, is {over:.2f} times the allowed one.", ""]
        header = ["gap / a₁"] + [f"{name} {kind}" for name in ("A", "B", "C₁", "C₂", "U12", "V12") for kind in ("exact", "computed")]
        lines += [*table(header, list(rows(ratio, answers))), ""]
        if over > 1:
            failed.append(f"ratio {ratio:g}: {over:.2f} times the error allowed")
    write_section("lubrication.md", "fig3", "Figures 2 and 3 of the paper", lines)
    print("\n".join(lines))
    if failed:
        raise SystemExit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    main()
