"""Runs of scenes on a card beside the host: times of steps, answers, and bits after an interruption."""

import csv
import os
import pathlib
import shutil
import signal
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Name, number of spheres, volume fraction, further keys of the scene, steps before those that are timed.
SHEAR = 'flow = { kind = "shear", rate = 1.0 }\nrepulsion = { strength = 60.0 }\ntime.integrator = "adams-bashforth"\ntime.step = 0.002'
HEAT = "fluid.thermal_energy = 1.0\nrepulsion = { strength = 100.0, screening_length = 0.05 }\ntime.step = 0.04"
TOUCH = 'flow = { kind = "shear", rate = 1.0 }\ncontacts.friction = 0.5\ntime.step = 0.005'
TIMED = [
    ("shear", 500, 0.2, SHEAR, 20),
    ("shear", 5_280, 0.2, SHEAR, 20),
    ("shear", 50_000, 0.2, SHEAR, 20),
    ("heat, drifter-corrector", 5_280, 0.2, f'{HEAT}\ntime.brownian = "drifter-corrector"', 20),
    ("heat, random finite difference", 5_280, 0.2, f'{HEAT}\ntime.brownian = "random-finite-difference"', 20),
    ("friction", 1_000, 0.5, TOUCH, 2),
]
# Scenes of the program, and changes of their keys.
SCENES = {"settling": {}, "dense": {}}
FEW = {"settling": {"count": 200, "edges": "[19.0, 19.0, 19.0]", "steps": 60}, "dense": {"duration": 0.3, "checkpoint_every": 20}}
DEVIATION = 4  # of means, over their common standard error
TOLERANCE = 1e-2  # of scenes that are timed; both the card and the host keep it


def scene(count, fraction, keys, first, device, ratio=1.4, tolerance=TOLERANCE):
    """Spheres of two sizes with lubrication, or equal ones in heat."""
    ratio = 1.0 if "thermal_energy" in keys else ratio
    edge = (count * (1 + ratio**3) / 2 * 4.18879 / fraction) ** (1 / 3)
    kind = lambda name, radius: f"[[species]]\nname = {name!r}\nradius = {radius}\ncount = {count // 2}\n"
    species = kind("small", 1.0) + kind("large", ratio)
    on = "" if device is None else f'hydrodynamics.device = "{device}"\n'
    return f"""seed = 1
box.edges = [{edge}, {edge}, {edge}]
fluid.viscosity = 1.0
hydrodynamics.tolerance = {tolerance}
hydrodynamics.lubrication = true
{on}{keys}
time.steps = {3 * first}
output = {{ trajectory_every = {first}, observables_every = {first}, checkpoint_every = 0 }}
{species}"""


def ended(command, threads, **options):
    """A finished program; with its message if it failed."""
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, check=False, **options)


def first_velocities(program, folder):
    """Velocities of the first frame, one after the other."""
    ended([program, "export", folder, "--to", "xyz"], 1)
    with open(folder / "trajectory.xyz") as file:
        count = int(next(file))
        next(file)
        return [float(word) for _ in range(count) for word in next(file).split()[6:9]]


def timed(program, folder, text, threads):
    """Seconds of a step, evaluations in it, and velocities at the start."""
    (folder / "scene.toml").write_text(text)
    done = ended([program, "run", folder / "scene.toml", "--out", folder / "out", "--force"], threads)
    if done.returncode:
        return {"failed": done.stderr.strip()[-500:]}
    with open(folder / "out" / "observables.csv") as file:
        rows = list(csv.DictReader(file))[2:]
    seconds = min(float(row["seconds_per_step"]) for row in rows)
    return {"seconds": seconds, "evaluations": float(rows[-1]["evaluations"]),
            "velocities": first_velocities(program, folder / "out")}


def memory(program, folder, text):
    """The memory of a run, as `check` says it."""
    (folder / "scene.toml").write_text(text)
    lines = ended([program, "check", folder / "scene.toml"], 1).stdout.splitlines()
    return "; ".join(line.split(maxsplit=1)[1] for line in lines if line.startswith(("memory", "card", "device")))


def difference(found, exact):
    """Relative difference in the 2-norm."""
    norm = lambda values: sum(value * value for value in values) ** 0.5
    return norm([a - b for a, b in zip(found, exact)]) / norm(exact)


def steps(program, device, folder, cases):
    """Times of a step on the card, on one core and on all cores."""
    rows, cores = [], os.cpu_count() or 1
    for name, count, fraction, keys, first in cases:
        given = lambda on: scene(count, fraction, keys, first, on)
        card = timed(program, folder, given(device), cores)
        host = [timed(program, folder, given(device and "cpu"), threads) for threads in (1, cores)]
        row = {"case": name, "spheres": count, "fraction": fraction, "memory": memory(program, folder, given(device))}
        failures = [line["failed"] for line in (card, *host) if "failed" in line]
        if not failures:
            row["difference"] = difference(card["velocities"], host[1]["velocities"])
            row |= {"card": card["seconds"], "one": host[0]["seconds"], "all": host[1]["seconds"], "evaluations": card["evaluations"]}
        rows.append({**row, "failures": failures, "passed": not failures and row["difference"] <= 2 * TOLERANCE})
    return rows


def changed(name, keys, device):
    """A scene of the program with other values of some keys, on a device."""
    lines = (ROOT / "scenes" / f"{name}.toml").read_text().splitlines()
    for key, value in keys.items():
        lines = [f"{key} = {value}" if line.startswith(f"{key} =") else line for line in lines]
    on = [] if device is None else [f'device = "{device}"']
    place = lines.index("[hydrodynamics]") + 1
    return "\n".join([*lines[:place], *on, *lines[place:]]) + "\n"


def answers(folder):
    """Means with errors."""
    with open(folder / "summary.csv") as file:
        rows = list(csv.DictReader(file))
    return {(row["quantity"], row["species"]): (float(row["value"]), float(row["error"])) for row in rows if row["value"] and row["error"]}


def last_checkpoint(folder):
    """The last checkpoint after the start."""
    return max((path for path in folder.glob("checkpoint-*.bin") if int(path.stem[11:]) > 0), default=None)


def interrupted(program, folder, threads):
    """Starts a run and stops it after its first checkpoint; whether it had not ended before."""
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    shutil.rmtree(folder / "stopped", ignore_errors=True)
    command = [program, "run", folder / "scene.toml", "--out", folder / "stopped"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as run:
        while run.poll() is None and last_checkpoint(folder / "stopped") is None:
            time.sleep(0.01)
        run.send_signal(signal.SIGINT)
    return run.returncode != 0


def went_on(program, folder, name, keys, threads):
    """Resumes a stopped run on the card, and a copy of it on the host: bits of the one, and what the other says."""
    shutil.rmtree(folder / "moved", ignore_errors=True)
    shutil.copytree(folder / "stopped", folder / "moved")
    on_card = ended([program, "resume", folder / "stopped"], threads)
    bits = [last_checkpoint(folder / of).read_bytes() for of in ("out", "stopped")]
    (folder / "moved" / "scene.toml").write_text(changed(name, keys, "cpu"))
    on_host = ended([program, "resume", folder / "moved"], threads)
    said = [line for line in on_host.stderr.splitlines() if "hydrodynamics.device" in line]
    return {"same_bits": on_card.returncode == 0 and bits[0] == bits[1], "moved": on_host.returncode == 0, "said": said}


def runs(program, device, folder, scenes):
    """Answers of whole runs on the card and on the host, and runs that are interrupted."""
    rows, cores = [], os.cpu_count() or 1
    for name, keys in scenes.items():
        of_run = folder / name
        found = {}
        for place, on in (("host", device and "cpu"), ("out", device)):
            of_run.mkdir(exist_ok=True)
            (of_run / "scene.toml").write_text(changed(name, keys, on))
            done = ended([program, "run", of_run / "scene.toml", "--out", of_run / place, "--force"], cores)
            found[place] = answers(of_run / place) if done.returncode == 0 else None
        row = {"scene": name, "ended": None not in found.values()}
        if row["ended"]:
            pairs = [(*found["out"][key], *found["host"][key]) for key in found["out"].keys() & found["host"].keys()]
            apart = [abs(a - b) / (error**2 + other**2) ** 0.5 for a, error, b, other in pairs if error or other]
            row |= {"answers": len(apart), "largest_deviation": max(apart, default=0.0)}
            row["was_stopped"] = interrupted(program, of_run, cores)
            row |= went_on(program, of_run, name, keys, cores)
            is_near = row["ended"] and row["largest_deviation"] <= DEVIATION
        rows.append({**row, "passed": is_near and row["was_stopped"] and row["same_bits"] and row["moved"] and bool(row["said"])})
    return rows


def lines(found, further):
    """The results as lines of a page, with further rows of the table of steps."""
    heads = ["step", "spheres", "fraction", "card", "one core", "all cores", "evaluations", "difference at the start"]
    page = ["", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for row in found["steps"]:
        if row["failures"]:
            values = ["failed"] * 5
        else:
            values = [*(f"{1e3 * row[name]:.3g}" for name in ("card", "one", "all")), f"{row['evaluations']:.1f}", f"{row['difference']:.1e}"]
        page.append("| " + " | ".join(map(str, [row["case"], row["spheres"], row["fraction"], *values])) + " |")
    page += ["| " + " | ".join(map(str, row)) + " |" for row in further]
    page += ["", f"Milliseconds of a step with lubrication at a tolerance of {TOLERANCE}, the mean over the faster of two stretches of steps.", ""]
    page += [f"{row['case']}, {row['spheres']} spheres: {row['memory']}." for row in found["steps"]]
    for row in found["runs"]:
        outcome = f"{row['answers']} answers differ by at most {row['largest_deviation']:.1f} of their errors" if row["ended"] else "failed"
        bits = {True: "the same bits", False: "other bits"}[row.get("same_bits", False)]
        page.append(f"scenes/{row['scene']}.toml: {outcome}; stopped and resumed, {bits}; {' '.join(row.get('said', []))}")
    return page
