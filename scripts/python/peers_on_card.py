"""Times of other programs on a card beside this one, for scripts/gpu: JFSD, a lubricated step, and cuFCM, a mobility.

A folder has what the user has made of them (nothing of theirs is here):

    jfsd/             a checkout of github.com/torrewk/Python-Jax-Fast-Stokesian-Dynamics, which reads its tables from there
    wheels/           wheels of jax, a jaxlib with CUDA and the rest that JFSD needs, for the Python of that machine
    cufcm/bin/CUFCM   the program of github.com/racksa/cuFCM, made by `make CUFCM` with `#define ROTATION 1` in its
                      src/config.hpp, as it has torques then, and with -arch of the card in its makefile

The environment may name them elsewhere: JFSD its checkout, JFSD_PYTHON a Python with its requirements, CUFCM its program.
Times leave out compilation and the first evaluations. A program that is not there, fails or takes too long is a line of
the page, and no row of a table."""

import json
import math
import os
import pathlib
import random
import re
import signal
import subprocess
import sys

import card_runs

SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "peers" / "jfsd_steps.py"
# Seconds that a run of another program may take, with its compilation.
LIMIT = 300
# Spheres of the steps, all equal, with the volume fraction, the tolerance of both programs, and the steps of JFSD that are timed.
SHEARED, SHEARED_FRACTION, SHEARED_TOLERANCE, STEPS = (500, 5_280, 50_000), 0.2, 1e-3, 10
SHEAR = card_runs.SHEAR + "\nparticles = { initial = \"random\", minimum_gap = 0.01 }"
# Spheres of the mobilities, with their volume fraction, and the largest number whose error is measured.
MOVED, MOVED_FRACTION, MOVED_TOLERANCE, CHECKED = (3_200, 100_000, 1_000_000), 0.12, 1e-3, 100_000
# Parameters by which cuFCM's own scripts keep this tolerance: width of the grid's Gaussian in spacings, points of its support in
# widths, reach of the pair corrections in widths. Grid spacings over the radius between which the fastest is chosen.
ALPHA, BETA, ETA, SPACINGS = 0.97, 8.9, 4.94, (0.7, 1.3)
# Evaluations, of which cuFCM leaves out the first fifth.
EVALUATIONS = 20
STAGES = {"spread": "Spreading", "fft": r"FFT\+flow", "interpolate": "Gathering", "near": "Correction", "sort": "Hashing"}


class Failed(Exception):
    """Says why a program gave no time."""


def ended(command, seconds, given=None, **options):
    """Output and messages of a program that ends well in time. One that does not is ended with all that it has started."""
    pipes = {name: subprocess.PIPE for name in ("stdin", "stdout", "stderr")} | {"text": True, "start_new_session": True}
    try:
        started = subprocess.Popen(list(map(str, command)), **pipes, **options)
    except OSError as error:
        raise Failed(f"does not start: {error.strerror}") from error
    with started as run:
        try:
            output, messages = run.communicate(given, timeout=seconds)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            raise Failed(f"no result within {seconds:g} s") from None
    if run.returncode:
        last = (messages.strip() or output.strip() or f"code {run.returncode}").splitlines()[-1]
        raise Failed(f"failed: {last[:200]}")
    return output, messages


def edge(count, fraction):
    """Edge of the cubic box of unit spheres at a volume fraction."""
    return (count * 4 / 3 * math.pi / fraction) ** (1 / 3)


def python_of_jfsd(folder, out, seconds):
    """The Python that imports JFSD: the one that is named, one made of the wheels of the folder, or the one that runs this."""
    if os.environ.get("JFSD_PYTHON"):
        return os.environ["JFSD_PYTHON"]
    wheels = sorted((folder / "wheels").glob("*.whl"))
    if not wheels:
        return sys.executable
    ended([sys.executable, "-m", "venv", out / "python"], seconds)
    ended([out / "python" / "bin" / "python", "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", *wheels], seconds)
    return out / "python" / "bin" / "python"


def jfsd(folder, out, seconds):
    """Checkout of JFSD and a Python that imports it."""
    checkout = pathlib.Path(os.environ.get("JFSD") or folder / "jfsd").resolve()
    if not checkout.is_dir():
        raise Failed("no checkout of it is here")
    python = python_of_jfsd(folder, out, seconds)
    ended([python, "-c", "import jfsd.main"], seconds, cwd=checkout)
    return checkout, python


def cufcm(folder):
    """The program of cuFCM."""
    program = pathlib.Path(os.environ.get("CUFCM") or folder / "cufcm" / "bin" / "CUFCM").resolve()
    if not program.is_file():
        raise Failed("no program of it is here")
    return program


def start(folder):
    """Edge of the cubic box and positions in the first frame of a run whose frames are exported to trajectory.xyz."""
    with open(folder / "trajectory.xyz") as file:
        count = int(next(file))
        box = float(re.search(r'Lattice="(\S+)', next(file))[1])
        return {"edge": box, "positions": [[float(word) % box for word in next(file).split()[1:4]] for _ in range(count)]}


def sheared(program, device, of_jfsd, out, count, seconds):
    """Seconds of a step of this program and of JFSD, of the same spheres from the same start."""
    checkout, python = of_jfsd
    text = card_runs.scene(count, SHEARED_FRACTION, SHEAR, 20, device, ratio=1.0, tolerance=SHEARED_TOLERANCE)
    ours = card_runs.timed(program, out, text, os.cpu_count() or 1)
    if "failed" in ours:
        raise Failed(f"not run, as this program failed: {ours['failed'].splitlines()[-1]}")
    (out / "start.json").write_text(json.dumps(start(out / "out")))
    environment = os.environ if device else {**os.environ, "JAX_PLATFORMS": "cpu"}
    output, _ = ended([python, SCRIPT, out / "start.json", STEPS], seconds, cwd=checkout, env=environment)
    try:
        theirs = json.loads(output.strip().splitlines()[-1])
        place, taken = theirs["device"], float(theirs["seconds"])
    except (ValueError, IndexError, KeyError, TypeError):
        raise Failed("printed no times") from None
    if device and place == "cpu":
        raise Failed("JAX finds no card")
    here = {"case": "shear, equal spheres", "evaluations": ours["evaluations"], "card": ours["seconds"]}
    both = [here, {"case": "shear, equal spheres, JFSD", "card": taken}]
    return [{**row, "spheres": count, "fraction": SHEARED_FRACTION} for row in both]


def grids(box):
    """Points of the edge of grids that suit Fourier transforms, of spacings to choose from."""
    sizes = sorted(2**i * 3**j for i in range(1, 12) for j in range(8))
    return [size for size in sizes if SPACINGS[0] <= box / size <= SPACINGS[1]]


def inputs(count, box):
    """Positions on sites of a lattice, moved at random by so little that no spheres overlap, forces and torques."""
    numbers = random.Random(1)
    cells = math.ceil(count ** (1 / 3) - 1e-9)
    moved = 0.49 * (box / cells - 2)
    sites = numbers.sample(range(cells**3), count)
    corners = ((site // cells**2, site // cells % cells, site % cells) for site in sites)
    positions = [[(corner + 0.5) * box / cells + numbers.uniform(-moved, moved) for corner in row] for row in corners]
    loads = [[[numbers.uniform(-1, 1) for _ in range(3)] for _ in sites] for _ in range(2)]
    return positions, *loads


def write_inputs(folder, lists):
    """The files of positions, forces and torques that cuFCM reads, and the folder in which it writes."""
    (folder / "data" / "simulation").mkdir(parents=True, exist_ok=True)
    for name, rows in zip(("positions", "forces", "torques"), lists):
        with open(folder / f"{name}.dat", "w") as file:
            file.writelines(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in rows)


def write_parameters(folder, count, box, points):
    """The parameters of cuFCM, which reads them in this order."""
    values = {
        "N": count, "rh": 1, "alpha": ALPHA, "beta": BETA, "eta": ETA, "nx": points, "ny": points, "nz": points, "repeat": EVALUATIONS,
        "prompt": 2, "dt": 0, "Fref": 0, "packrep": 0, "boxsize": repr(box), "checkerror": 0, "$posfile": "positions.dat",
        "$forcefile": "forces.dat", "$torquefile": "torques.dat",
    }
    (folder / "simulation_info").write_text("".join(f"{name}={value}\n" for name, value in values.items()))


def stages(output):
    """Seconds of the stages of an evaluation, and their sum with that of the sort; whether it has torques."""
    found = {name: re.search(rf"^{label}:\s+(\S+)", output, re.MULTILINE) for name, label in STAGES.items()}
    seconds = {name: float(match[1]) if match else math.nan for name, match in found.items()}
    if not all(map(math.isfinite, seconds.values())):
        raise Failed("printed no times")
    return {**seconds, "total": sum(seconds.values())}, "<Rotation>" in output


def motions(folder):
    """Velocities and angular velocities that cuFCM wrote, each as one list."""
    with open(folder / "data" / "simulation" / "simulation_data.dat") as file:
        rows = [[float(word) for word in line.split()[10:16]] for line in file if len(line.split()) == 16]
    return [[number for row in rows for number in row[part]] for part in (slice(3), slice(3, 6))]


def exact(program, device, lists, box, has_torques, seconds):
    """The same motions by this program on the host, to a tolerance of 1e-6."""
    positions, forces, torques = lists
    given = {"box": [box] * 3, "viscosity": 1.0, "positions": positions, "radii": 1.0, "rigid": False, "forces": forces}
    given |= {"torques": torques} if has_torques else {}
    given |= {"device": "cpu"} if device else {}
    output, _ = ended([program, "mobility", "-", "--tolerance", "1e-6"], seconds, given=json.dumps(given))
    answer = json.loads(output)
    return [[number for row in answer[name] for number in row] for name in ("velocities", "angular_velocities")]


def moved(program, device, of_cufcm, out, count, seconds):
    """The fastest evaluation by cuFCM of those that keep the tolerance, or of all where none is known to keep it."""
    box = edge(count, MOVED_FRACTION)
    lists = inputs(count, box)
    write_inputs(out, lists)
    rows, references = [], {}
    for points in grids(box):
        write_parameters(out, count, box, points)
        output, messages = ended([of_cufcm], seconds, cwd=out)
        if "error" in messages.lower() or "CUFFT error" in output:
            raise Failed(f"failed: {(messages.strip() or output.strip()).splitlines()[-1][:200]}")
        taken, has_torques = stages(output)
        row = {"spheres": count, "fraction": MOVED_FRACTION, "tolerance": MOVED_TOLERANCE, "grid": [points] * 3, "seconds": taken}
        row |= {"loads": "forces and torques, cuFCM" if has_torques else "forces alone, cuFCM", "error": None}
        if count <= CHECKED:
            if has_torques not in references:
                references[has_torques] = exact(program, device, lists, box, has_torques, seconds)
            kinds = 2 if has_torques else 1
            pairs = list(zip(motions(out), references[has_torques]))[:kinds]
            row["error"] = max(card_runs.difference(found, wanted) for found, wanted in pairs)
        rows.append(row)
    within = [row for row in rows if row["error"] is not None and row["error"] <= MOVED_TOLERANCE]
    return min(within or rows, key=lambda row: row["seconds"]["total"])


def of_peer(name, find, measure, counts):
    """Rows for each number of spheres, and lines that say why there are none."""
    try:
        peer = find()
    except Failed as why:
        return [], [f"{name}: {why}."]
    rows, said = [], []
    for count in counts:
        try:
            rows += measure(peer, count)
        except Failed as why:
            said.append(f"{name}, {count:,} spheres: {why}.")
    return rows, said


def measured(program, device, folder, out, seconds=LIMIT):
    """Rows of steps, rows of mobilities, and lines that say what did not run; on the host of few spheres."""
    out.mkdir(parents=True, exist_ok=True)
    few = device is None
    step = lambda of_jfsd, count: sheared(program, device, of_jfsd, out, count, seconds)
    mobility = lambda of_cufcm, count: [moved(program, device, of_cufcm, out, count, seconds)]
    steps, of_steps = of_peer("JFSD", lambda: jfsd(folder, out, seconds), step, (100,) if few else SHEARED)
    times, of_times = of_peer("cuFCM", lambda: cufcm(folder), mobility, (100,) if few else MOVED)
    return {"steps": steps, "times": times, "said": of_steps + of_times}


def rows_of_times(found):
    """Cells of the table of evaluations, whose copies and host cuFCM does not have."""
    parts = ("spread", "fft", "interpolate", "near")
    for row in found["times"]:
        times = [f"{1e3 * row['seconds'][part]:.3g}" for part in parts] + ["", f"{1e3 * row['seconds']['total']:.3g}"]
        error = "" if row["error"] is None else f"{row['error']:.1e}"
        grid = " x ".join(map(str, row["grid"]))
        yield [row["spheres"], row["fraction"], 1, row["tolerance"], row["loads"], grid, *times, error, "", ""]


def rows_of_steps(found):
    """Cells of the table of steps."""
    for row in found["steps"]:
        evaluations = f"{row['evaluations']:.1f}" if "evaluations" in row else ""
        yield [row["case"], row["spheres"], row["fraction"], f"{1e3 * row['card']:.3g}", "", "", evaluations, ""]


def lines(found):
    """Lines that explain the rows, and say what did not run."""
    page = []
    if found["times"]:
        page.append(
            "cuFCM: its own means, with the sort; the fastest of its grids that keep the tolerance, or of all if none is known to. "
            f"Its error is measured against the host at 1e-6, up to {CHECKED:,} spheres."
        )
    if found["steps"]:
        page.append(
            f"JFSD: wall time of a step at a tolerance of {SHEARED_TOLERANCE:g}, the difference of two runs of compiled code, "
            "from the start of the row before, which is this program's at that tolerance."
        )
    return page + found["said"]
