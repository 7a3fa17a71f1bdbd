"""Times this program and others that the user has built, in turns, and writes the page about them: scripts/benchmark --peers.

Environment variables name them: LF_DEM its program; JFSD its checkout and JFSD_PYTHON a Python with its requirements; DPSTOKES its checkout.
Those that are not set are skipped, and their sections of the page stay unchanged."""

import argparse
import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
from statistics import median

import h5py
import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TOP / "validation"))
from support.page import table, write_section
from support.program import mobility

ROUNDS = 3
# Spheres of two radii, half the volume each, and the strains of the two timed runs.
COUNTS, FRACTION, FRICTIONS, STRAINS = {1.0: 147, 1.4: 53}, 0.45, (0.0, 0.5), (1.0, 2.0)
# Spheres and steps of the comparison with JFSD.
EQUAL, EQUAL_FRACTION, STEPS, OURS = 500, 0.2, 2, (20, 420)
# Spheres between walls and the distance of the walls for DPStokes, and its points with the tolerance here that gives a similar error.
BETWEEN, BETWEEN_FRACTION, HEIGHT, KERNELS = 1000, 0.2, 20.0, {4: 1e-2, 6: 3e-4}


def cpu_seconds(command, **options):
    """CPU seconds of a command and its child processes."""
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **options)
    message = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(map(str, command))} failed:\n{message.decode()[-2000:]}")
    return used.ru_utime + used.ru_stime


def edge(counts, fraction):
    return (sum(4 / 3 * math.pi * a**3 * n for a, n in counts.items()) / fraction) ** (1 / 3)


def scene(counts, fraction, keys):
    side = edge(counts, fraction)
    species = "".join(f"[[species]]\nradius = {a}\ncount = {n}\n" for a, n in counts.items())
    return f"seed = 1\nbox.edges = [{side}, {side}, {side}]\nfluid.viscosity = 1.0\n{keys}\n{species}"


class Ours:
    """This program, on one thread."""

    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def run(self, text, name):
        path = self.folder / f"{name}.toml"
        path.write_text(text)
        return cpu_seconds([self.program, "run", path, "--out", self.folder / name, "--force", "--threads", "1"])

    def rough(self, friction, strain):
        """CPU seconds of a run of rough spheres in shear."""
        keys = f"""flow = {{ kind = "shear", rate = 1.0 }}
contacts = {{ friction = {friction}, roughness = 0.005 }}
hydrodynamics = {{ lubrication = true, tolerance = 1e-2 }}
time = {{ step = 0.005, duration = {strain} }}
output = {{ trajectory_every = {round(strain / 0.005)}, observables_every = 20, checkpoint_every = 0 }}"""
        return self.run(scene(COUNTS, FRACTION, keys), f"rough-{friction}")

    def start(self, friction):
        """Radii and positions of its first frame, in a box with a corner at the origin."""
        with h5py.File(self.folder / f"rough-{friction}" / "trajectory.h5") as file:
            group = file["particles/all"]
            return group["radius"][:], group["position/value"][0]

    def lubricated(self, steps, thermal_energy):
        """CPU seconds of `steps` steps of equal spheres in shear, with a thermal energy in units of 6 pi mu a^3 times the rate."""
        integrator = 'integrator = "brownian"' if thermal_energy else 'integrator = "adams-bashforth"'
        keys = f"""particles = {{ initial = "random", minimum_gap = 0.01 }}
{f"fluid.thermal_energy = {6 * math.pi * thermal_energy}" if thermal_energy else ""}
flow = {{ kind = "shear", rate = 1.0 }}
repulsion.strength = 60.0
hydrodynamics = {{ lubrication = true, tolerance = 1e-3 }}
time = {{ step = 0.001, steps = {steps}, {integrator} }}
output = {{ trajectory_every = 0, checkpoint_every = 0, observables_every = {steps} }}"""
        return self.run(scene({1.0: EQUAL}, EQUAL_FRACTION, keys), "lubricated")


class Slit(Ours):
    """This program, on one thread, with spheres between walls as monopoles."""

    def drift(self, tolerance, steps):
        """CPU seconds of `steps` steps of one evaluation each."""
        side = math.sqrt(BETWEEN * 4 / 3 * math.pi / BETWEEN_FRACTION / HEIGHT)
        text = f"""seed = 1
box = {{ edges = [{side}, {side}, {HEIGHT}], boundaries = ["periodic", "periodic", "walls"] }}
fluid.viscosity = 1.0
gravity.acceleration = [1e-6, 0.0, 0.0]
particles = {{ initial = "random", minimum_gap = 0.01 }}
hydrodynamics = {{ multipoles = "monopole", tolerance = {tolerance} }}
time = {{ integrator = "adams-bashforth", order = 2, step = 0.01, steps = {steps} }}
output = {{ trajectory_every = {steps}, observables_every = {steps}, checkpoint_every = 0 }}
[[species]]
radius = 1.0
count = {BETWEEN}
density_difference = 1.0
"""
        return self.run(text, "slit")

    def places(self):
        """The box and the positions of its first frame, as a file that DPStokes reads too."""
        with h5py.File(self.folder / "slit" / "trajectory.h5") as file:
            group = file["particles/all"]
            edges, places = np.diagonal(group["box/edges/value"][0]), group["position/value"][0]
        path = self.folder / "places.json"
        path.write_text(json.dumps({"edges": edges.tolist(), "positions": places.tolist()}))
        return path

    def error(self, path, tolerance):
        """Error of velocities under random forces, against a tolerance of 1e-6."""
        given = json.loads(path.read_text())
        forces = np.random.default_rng(1).normal(size=(BETWEEN, 3))
        case = {
            "box": given["edges"],
            "boundaries": ["periodic", "periodic", "walls"],
            "viscosity": 1.0,
            "positions": given["positions"],
            "radii": 1.0,
            "forces": forces,
            "multipoles": "monopole",
        }
        found, exact = (np.array(mobility(case, one)["velocities"]) for one in (tolerance, 1e-6))
        return np.linalg.norm(found - exact) / np.linalg.norm(exact)


class LfDem:
    """LF_DEM: lubrication of pairs and contacts, without a far field. Shear is along x, its gradient along z."""

    def __init__(self, program, folder):
        self.program, self.folder = pathlib.Path(program).resolve(), pathlib.Path(folder)

    def rough(self, friction, strain, start):
        """CPU seconds of a run of these spheres. Displacements, range of lubrication and relaxation are those of its example; springs are
        two and three times as stiff as there, and the cut-off of lubrication is the roughness used here."""
        radii, places = start
        side = edge(COUNTS, FRACTION)
        rows = [f"{x!r} {z!r} {y!r} {a!r}" for a, (x, y, z) in zip(radii.tolist(), places.tolist())]
        head = ["# np1 np2 vf lx ly lz vf1 vf2 dispx dispy", f"# {COUNTS[1.0]} {COUNTS[1.4]} {FRACTION} {side} {side} {side} 0.5 0.5 0 0"]
        (self.folder / "start.dat").write_text("\n".join(head + rows) + "\n")
        (self.folder / "parameters.txt").write_text(f"""dt = 1e-4;
disp_max = 2e-3;
integration_method = 1;
time_end = {strain}h;
friction_model = {1 if friction else 0};
mu_static = {friction};
kn = 10000h;
kt = 6000h;
lubrication_model = tangential;
lub_max_gap = 0.5;
lub_reduce_parameter = 5e-3;
contact_relaxation_time = 1e-3h;
contact_relaxation_time_tan = 0h;
time_interval_output_config = 10h;
time_interval_output_data = 1e-1h;
out_data_particle = false;
out_data_interaction = false;
origin_zero_flow = true;
""")
        command = [self.program, "-f", "-r", "1h", "start.dat", "parameters.txt"]
        return cpu_seconds(command, cwd=self.folder, env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"})


def beside_lf_dem(program, folder, count):
    """Rows of CPU seconds for a unit of strain: the difference between a run and a shorter one."""
    ours, theirs = Ours(program, folder), LfDem(os.environ["LF_DEM"], folder)
    for friction in FRICTIONS:
        rounds = []
        for _ in range(count):
            mine = [ours.rough(friction, strain) for strain in STRAINS]
            start = ours.start(friction)
            other = [theirs.rough(friction, strain, start) for strain in STRAINS]
            rounds.append([(long - short) / (STRAINS[1] - STRAINS[0]) for short, long in (mine, other)])
        yield row(f"friction {friction:g}", rounds)


def beside_jfsd(program, folder, count):
    """Rows of CPU seconds for a step, without Brownian motion and with it."""
    ours, place = Ours(program, folder), pathlib.Path(os.environ["JFSD"])
    script = TOP / "scripts" / "peers" / "jfsd_viscosity.py"
    command = [os.environ.get("JFSD_PYTHON", "python3"), script, str(EQUAL), str(EQUAL_FRACTION), "--time", str(STEPS)]
    environment = {**os.environ, "JAX_PLATFORMS": "cpu"}
    for name, thermal_energy in [("in shear", 0), ("in shear, Brownian", 0.1)]:
        rounds = []
        for _ in range(count):
            few, many = (ours.lubricated(steps, thermal_energy) for steps in OURS)
            said = subprocess.run([*command, str(thermal_energy)], cwd=place, env=environment, check=True, capture_output=True, text=True)
            rounds.append([(many - few) / (OURS[1] - OURS[0]), float(said.stdout.split()[0])])
        yield row(f"{EQUAL} spheres at {EQUAL_FRACTION:.0%} {name}", rounds)


def beside_dpstokes(program, folder, count):
    """Rows of CPU seconds for a product of the mobility with forces between walls."""
    ours, checkout = Slit(program, folder), pathlib.Path(os.environ["DPSTOKES"]).resolve()
    script = TOP / "scripts" / "peers" / "dpstokes_slit.py"
    environment = {
        **os.environ, "DPSTOKES": str(checkout), "LD_LIBRARY_PATH": str(checkout / "python_interface" / "lib"), "OMP_STACKSIZE": "256m",
        "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1",
    }
    for points, tolerance in KERNELS.items():
        rounds = []
        for _ in range(count):
            few, many = (ours.drift(tolerance, steps) for steps in (50, 450))
            places = ours.places()
            command = ["bash", "-c", 'ulimit -s unlimited; exec "$@"', "bash", sys.executable, script, places, str(points)]
            said = subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True, text=True)
            seconds, error = map(float, said.stdout.split())
            rounds.append([(many - few) / 400, seconds])
        yield row(f"{points} points, error {error:.1e}; fcm-solve: tolerance {tolerance:.0e}, error {ours.error(places, tolerance):.1e}", rounds)


def row(name, rounds):
    """Medians, and the ratio with its range."""
    ratios = sorted(other / mine for mine, other in rounds)
    mine, other = (median(column) for column in zip(*rounds))
    spread = f" ({ratios[0]:.1f} to {ratios[-1]:.1f})" if len(ratios) > 1 else ""
    return [name, f"{mine:.3g}", f"{other:.3g}", f"{median(ratios):.1f}{spread}"]


PEERS = {
    "LF_DEM": ("lf-dem", "Rough spheres: LF_DEM", beside_lf_dem, [
        "CPU seconds for the second unit of strain of 200 spheres of radii 1 and 1.4 at 45% from the same start. fcm-solve",
        "includes the far field and takes steps of 0.005 in strain. LF_DEM has no far field; it takes predictor-corrector steps",
        "of at most 0.002 radii, with springs of 10,000 and 6,000 in units of 6 pi mu a times the shear rate, and a lubrication",
        "cut-off at a gap of 0.005.",
    ]),
    "JFSD": ("jfsd", "A lubricated step: JFSD", beside_jfsd, [
        "CPU seconds for a lubricated step of 0.001 over the shear rate at a tolerance of 1e-3. JFSD runs in single precision;",
        "its compilation is excluded. Brownian motion has a thermal energy of 0.6 pi mu a^3 times the shear rate.",
    ]),
    "DPSTOKES": ("dpstokes", "Between walls: DPStokes", beside_dpstokes, [
        f"CPU seconds to compute velocities from forces for {BETWEEN:,} equal spheres at {BETWEEN_FRACTION:.0%} between walls {HEIGHT:g} radii",
        "apart. For fcm-solve this is a whole step without stresslets, for DPStokes only the product. Errors are those of the",
        "grid, relative to a tolerance of 1e-6 in fcm-solve and to a grid twice as fine in DPStokes.",
    ]),
}

NAMES = {"DPSTOKES": "DPStokes"}


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark --peers", description=__doc__)
    parser.add_argument("--program", required=True, help="this program")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help=f"number of rounds [{ROUNDS}]")
    arguments = parser.parse_args()
    command = "scripts/benchmark --peers" + (f" --rounds {arguments.rounds}" if arguments.rounds != ROUNDS else "")
    chosen = [peer for peer in PEERS if os.environ.get(peer)]
    if not chosen:
        raise SystemExit(f"set {' or '.join(PEERS)} to the path of that program, see docs/src/peers.md")
    for peer in chosen:
        name, title, compare, about = PEERS[peer]
        with tempfile.TemporaryDirectory() as folder:
            rows = list(compare(arguments.program, folder, arguments.rounds))
        how_often = "one round" if arguments.rounds == 1 else f"medians and ranges of {arguments.rounds} rounds"
        lines = [*about, f"One thread, {how_often} in turns, on {platform.machine()}.", ""]
        lines += table(["", "fcm-solve", NAMES.get(peer, peer), "ratio"], rows)
        print(title, *lines, sep="\n")
        write_section("peers.md", name, title, lines, command)


if __name__ == "__main__":
    main()
