"""Fig. 19: settling and fluctuations of a test sphere among others at 20%. The measurements of Nicolai et al. in the paper's
figure are not available as numbers, except for their mean, and are omitted."""

import settling
from report import Report, main, shown
from runs import make, over_seeds, volume


def draw(mode):
    """Mean velocity and fluctuations over the Stokes velocity of the test sphere, at size ratios up to 1.6."""
    cases = {ratio: settling.test_sphere(ratio, mode) for ratio in settling.TEST_RATIOS[mode]}
    make(sum(cases.values(), []))
    spheres = f"{settling.TESTS[mode]} test sphere{'s' if settling.TESTS[mode] > 1 else ''}"
    report = Report("fig19", mode, f"Fig. 19: {spheres} in a settling suspension", panels=2)
    edge = settling.SIZE[mode]["least"]
    both = []
    for ratio, runs in cases.items():
        radius = ratio**0.5
        fraction = settling.TESTS[mode] * volume(radius) / edge**3
        species = [*settling.equal_spheres(0.20), ("test", radius, 1.0, fraction)]
        both.append(settling.settled(runs, species, 1, edge))
    boxed, means = zip(*both)
    report.points("mean, in the box", list(cases), boxed, 0, marker="o", fillstyle="none", color="0.6")
    report.points("mean, without images", list(cases), means, 0, marker="o")
    for component, label in (("zz", "vertical"), ("xx", "horizontal")):
        found = [over_seeds(runs, settling.fluctuation("test", component)) for runs in cases.values()]
        points = [(value / ratio, error / ratio) for ratio, (value, error) in zip(cases, found)]
        report.points(f"{label} fluctuation", list(cases), points, 1, marker="s")
    report.label("$R_S$", r"$\langle V_P \rangle / V_{oP}$", 0, ylim=(0, 1))
    report.label("$R_S$", "fluctuation $/ V_{oP}$", 1, ylim=(0, None))
    for ratio, found in zip(cases, means):
        if ratio != 2.8:
            report.compare(f"mean velocity, R_S = {ratio:g}", "experiments scatter around (paper)", 0.42, found, 0.2)
    falls = means[0][0] - means[-1][0] < 2 * (means[0][1] + means[-1][1])
    report.state("mean velocity from smallest to largest R_S", "constant (paper)",
                 f"{shown(means[0])} to {shown(means[-1])}", falls)
    return report


if __name__ == "__main__":
    main(draw)
