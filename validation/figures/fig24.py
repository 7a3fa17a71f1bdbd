"""Fig. 24: settling of equal spheres of two densities, the first 2% by volume, against the total concentration. The theory is that
of random pairs with exact mobilities; static positions are those of hard spheres at equilibrium. Davis & Gecol's coefficients for
other ratios of densities and the data of Revay & Higdon are not available as numbers and are omitted."""

import numpy as np

import settling
import theory
from report import Report, main, shown
from runs import make, over_seeds, volume

# Number of parts of a run whose means are drawn.
BLOCKS = 20
# Distance of the centres up to which two spheres count as near.
NEAR = 2.3


def draw(mode):
    """Both sink, or one rises; velocities are corrected for the periodic images."""
    seconds = settling.SECOND[mode]
    own, other = theory.random_pairs()
    report = Report("fig24", mode, "Fig. 24: settling of two densities", panels=3)
    for panel, ratio in enumerate((2.0, -1.0)):
        both = {phi: settling.two_densities(ratio, phi) for phi in seconds}
        time = settling.STREAMS_TIME[mode] if ratio < 0 else None
        dynamic = {phi: settling.dynamic(species, mode, time=time) for phi, species in both.items()}
        static = {phi: settling.static(species, mode) for phi, species in both.items()}
        make(sum([*dynamic.values(), *static.values()], []))
        totals = [0.02 + phi for phi in seconds]
        line = np.linspace(0.02, totals[-1], 20)
        for place, (name, stokes) in enumerate((("first", 1.0), ("second", ratio))):
            velocities = {}
            for kind, cases, marker in (("runs", dynamic, "o"), ("equilibrium", static, "^")):
                edges = {phi: settling.edge_for(species, mode) for phi, species in both.items()}
                velocities[kind] = [
                    settling.settled(runs, both[phi], place, edges[phi])[1] for phi, runs in cases.items()
                ]
                style = {"marker": marker, "linestyle": "none", "color": f"C{place}", "fillstyle": "none"}
                report.points(f"{name}: {kind}", totals, velocities[kind], panel, **style)
            of_first = own + other * (1 / stokes)
            of_second = own + other * (ratio / stokes)
            theory_line = 1 + 0.02 * of_first + (line - 0.02) * of_second
            report.curve(f"{name}: pairs at random", line, theory_line, panel, color=f"C{place}")
            expected = 1 + 0.02 * of_first + seconds[0] * of_second
            name_of = f"{name}, γ = {ratio:g}, {totals[0]:.0%}, equilibrium"
            report.compare(name_of, "pairs at random", expected, velocities["equilibrium"][0])
            if ratio < 0 and name == "first":
                values = [value for value, _ in velocities["runs"]]
                told = ", ".join(f"{value:.3f}" for value in values)
                report.state("first, γ = -1, runs", "increases with the total (paper)", told, values[-1] > values[0])
                streams(report, totals, dynamic.values(), static[seconds[-1]])
                arrangement(report, dynamic)
        report.label(r"$\phi$", "$U_i / U_{oi}$", panel)
    return report


def streams(report, totals, dynamic, places):
    """Velocity of the first species over time where the second rises, in the box, and its value at equilibrium
    positions for the largest total."""
    at_places, error = over_seeds(places, settling.downwards("first"))
    for total, (run, *_) in zip(totals, dynamic):
        times, values = (np.array(column) for column in run.series("mean_velocity_z[first]"))
        blocks = [block.mean(axis=1) for block in np.array_split(np.array([times, -values]), BLOCKS, axis=1)]
        report.curve(f"{total:.0%}", *np.transpose(blocks), 2)
    report.curve(f"{totals[-1]:.0%}, equilibrium", times[[0, -1]], [at_places] * 2, 2, color="0.5", linestyle="--")
    early, late = np.mean(blocks[: BLOCKS // 4], axis=0)[1], np.mean(blocks[-BLOCKS // 4 :], axis=0)[1]
    told = f"{early:.3f} in the first quarter, {late:.3f} in the last, {shown((at_places, error))} at equilibrium"
    report.state(f"first, γ = -1, {totals[-1]:.0%}, in the box", "larger in runs (paper)", told, late > at_places + 2 * error)
    report.label("Stokes times", "$U_1 / U_{o1}$ in the box, $\\gamma = -1$", 2)
    report.panels[2].margins(y=0.4)
    report.panels[2].legend(fontsize=7, ncols=4, loc="upper center")


def arrangement(report, dynamic):
    """Relative positions of spheres of the two species where the second rises, and their effect on the velocity of the first."""
    distributions = {phi: unlike(run) for phi, (run, *_) in dynamic.items()}
    near = [g[(distance > 2) & (distance < NEAR)] for distance, _, g in distributions.values()]
    cosine = next(iter(distributions.values()))[1]
    beside, above = (np.mean([g[:, chosen].mean() for g in near]) for chosen in (cosine < 0.25, cosine > 0.75))
    told = f"{beside:.2f} side by side, {above:.2f} one above the other"
    quantity = f"g of unlike pairs up to a gap of {NEAR - 2:.1g}, γ = -1"
    report.state(quantity, "isotropic (equilibrium)", told, abs(beside - above) < 0.1 * above)
    taken = [taken_off(phi, *distribution) for phi, distribution in distributions.items()]
    told = ", ".join(f"{value:.2f}" for value in taken)
    report.state("resulting reduction of the velocity, leading order", "0 (random)", told, max(taken) < 0.02)


def unlike(run):
    """Distances, cosines of the angle to the vertical, and the pair distribution of one of each species by both."""
    columns = run.columns("pairs_by_angle", "distance", "cosine", "g", first="first", second="second")
    distances, cosines, values = map(np.array, columns)
    shape = len(np.unique(distances)), -1
    return distances.reshape(shape)[:, 0], cosines.reshape(shape)[0], values.reshape(shape)


def taken_off(phi, distance, cosine, g):
    """Reduction of the velocity of a sphere of the first species by the positions of the second species, compared with random
    positions outside of it, over the Stokes velocity: by the mobility of Rotne & Prager,
    `3/(4 r) [1 + 2/(3 r²) + (1 - 2/r²) cos²]`."""
    outside = distance > 2
    r, g = distance[outside, None], g[outside]
    mobility = 0.75 / r * (1 + 2 / (3 * r**2) + (1 - 2 / r**2) * cosine**2)
    shells = 4 * np.pi * r**2 * (distance[1] - distance[0]) / len(cosine)
    return phi / volume(1) * np.sum((g - 1) * mobility * shells)


if __name__ == "__main__":
    main(draw)
