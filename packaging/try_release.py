"""Installs what a release consists of into empty environments, and runs it: scripts/release --try. Prints times."""

import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

OUT, VERSION = pathlib.Path(sys.argv[1]), sys.argv[2]
# Nothing of this machine's own but the system's programs.
EMPTY = {"PATH": "/usr/bin:/bin:/usr/sbin:/sbin", "LANG": "C.UTF-8"}
# From nothing to a viscosity with its error, in Python and by the program.
STRAIN = 10
FIRST_LINES = f"""
import fcm_solve as fcm
scene = fcm.Scene.new("shear").set("time.strain", {STRAIN})
with fcm.Simulation(scene, out="shear") as simulation: simulation.run()
print("relative viscosity", fcm.open("shear").answers["relative_viscosity"])
"""
VISCOSITY = re.compile(r"relative.viscosity\D+(1\.\d+).*?(0\.\d+)")


def call(command, **options):
    """Runs a command in an empty environment; returns what it printed and the seconds that it took."""
    began = time.monotonic()
    options = {"env": EMPTY, "capture_output": True, "text": True} | options
    ended = subprocess.run([str(word) for word in command], **options)
    if ended.returncode:
        raise SystemExit(f"{' '.join(map(str, command))} ended with {ended.returncode}:\n{ended.stdout}{ended.stderr}")
    return ended.stdout, time.monotonic() - began


@contextlib.contextmanager
def unpacked(archive):
    with tempfile.TemporaryDirectory() as place:
        call(["tar", "-xJf", archive, "-C", place])
        yield next(pathlib.Path(place).iterdir())


def one(pattern):
    found = list(OUT.glob(pattern))
    return found[0] if len(found) == 1 else None


def viscosity(said):
    """The viscosity with its error in what was printed."""
    found = VISCOSITY.search(said)
    if not found:
        raise SystemExit(f"no viscosity with an error in:\n{said}")
    return f"{found[1]} ± {found[2]}"


def try_wheel(wheel):
    """A fresh virtual environment; numpy comes from the package index."""
    with tempfile.TemporaryDirectory() as place:
        python = pathlib.Path(place) / "bin" / "python"
        _, made = call([sys.executable, "-m", "venv", place])
        _, installed = call([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel])
        said, ran = call([python, "-c", FIRST_LINES], cwd=place)
        return f"virtual environment {made:.1f} s, installed {installed:.1f} s, relative viscosity {viscosity(said)} in {ran:.1f} s"


def try_binary(archive):
    """A root that holds the program and nothing else."""
    with unpacked(archive) as folder:
        root = folder / "root"
        (root / "tmp").mkdir(parents=True)
        shutil.copy(folder / "fcm-solve", root)
        inside = ["unshare", "--map-root-user", "chroot", root, "/fcm-solve"] if os.getuid() else ["chroot", root, "/fcm-solve"]
        said, _ = call([*inside, "--version"])
        if VERSION not in said:
            raise SystemExit(f"the binary says {said}")
        scene, _ = call([*inside, "new", "shear"])
        (root / "shear.toml").write_text(scene)
        _, ran = call([*inside, "run", "/shear.toml", "--set", f"time.strain={STRAIN}", "--out", "/shear"])
        said, _ = call([*inside, "stats", "/shear"])
        if not (root / "shear" / "trajectory.h5").exists():
            raise SystemExit("the binary has written no trajectory")
        pages = len(list((folder / "man" / "man1").iterdir()))
        completions = len(list((folder / "completions").iterdir()))
        found = f"relative viscosity {viscosity(said)} in {ran:.1f} s"
        return f"in a root of its own: {found}; {pages} manual pages, {completions} completions"


def try_source(archive):
    """A build without a network and without what other builds have fetched."""
    with unpacked(archive) as folder:
        home = folder / "home"
        home.mkdir()
        cargo = shutil.which("cargo")
        environment = EMPTY | {"PATH": f"{pathlib.Path(cargo).parent}:{EMPTY['PATH']}", "CARGO_HOME": home}
        environment["RUSTUP_HOME"] = os.environ.get("RUSTUP_HOME", pathlib.Path.home() / ".rustup")
        offline = ["unshare", "--net", "--map-root-user"]
        _, built = call([*offline, "cargo", "build", "--offline", "--locked", "--release"], cwd=folder, env=environment)
        _, ran = call([folder / "target/release/fcm-solve", "run", "scenes/pair-settling.toml"], cwd=folder)
        return f"built without a network in {built:.0f} s, run in {ran:.1f} s"


def try_book(archive):
    with unpacked(archive) as folder:
        pages = list(folder.rglob("*.html"))
        if not (folder / "index.html").exists():
            raise SystemExit("the book has no index.html")
        return f"{len(pages)} pages"


def main():
    call(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd=OUT)
    parts = {
        "*.whl": try_wheel,
        "*-linux.tar.xz": try_binary,
        "*-source.tar.xz": try_source,
        "*-book.tar.xz": try_book,
    }
    for pattern, trial in parts.items():
        path = one(pattern)
        said = trial(path) if path else "is not there"
        size = f"{path.stat().st_size / 1e6:.1f} MB" if path else ""
        print(f"| {path.name if path else pattern} | {size} | {said} |", flush=True)


if __name__ == "__main__":
    main()
