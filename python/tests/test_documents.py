"""Python examples of the documentation run unchanged."""

import json
import re
from pathlib import Path

import fcm_solve as fcm
import matplotlib
import nbclient
import nbformat
import numpy as np
import pytest

PACKAGE = Path(__file__).resolve().parents[1]
NOTEBOOKS = sorted((PACKAGE / "notebooks").glob("*.ipynb"))
matplotlib.use("Agg")


def blocks(path):
    return re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(path, tmp_path):
    assert all(not cell.get("outputs") for cell in json.loads(path.read_text())["cells"])
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()


def test_the_readme_runs(capsys):
    (block,) = blocks(PACKAGE / "README.md")
    exec(block, {})
    assert capsys.readouterr().out.count("[") == 3


def test_the_twenty_lines_run(tmp_path, monkeypatch, capsys, pair):
    page = PACKAGE.parent / "docs" / "src" / "python.md"
    monkeypatch.chdir(tmp_path)
    shear = {"kind": "shear", "rate": 1.0}
    output = {"trajectory_every": 100, "observables_every": 100}
    scene = fcm.Scene.from_dict(pair).set({"flow": shear, "output": output})
    (tmp_path / "my.toml").write_text(scene.to_toml())
    block = next(block for block in blocks(page) if "sim.run(steps=1000)" in block)
    names = {}
    exec(block.replace("steps=1000", "steps=200"), names)
    said = capsys.readouterr().out
    assert "tolerance" in said and [line.split()[0] for line in said.splitlines()[-3:]] == ["0", "100", "200"]
    assert names["A"].shape == (192, 192) and names["ds"]["position"].shape == (3, 2, 3)


def test_the_block_with_libmobility_s_names_runs():
    page = PACKAGE.parent / "docs" / "src" / "python.md"
    names = {}
    exec(next(block for block in blocks(page) if "fcm_solve.libmobility" in block), names)
    assert names["linear"].shape == names["angular"].shape == (2, 3)


def test_the_blocks_about_simulations_run(tmp_path, monkeypatch, pair):
    page = PACKAGE.parent / "docs" / "src" / "python.md"
    monkeypatch.chdir(tmp_path)
    scene = fcm.Scene.from_dict(pair).set({"flow": {"kind": "shear", "rate": 1.0}, "time.steps": 40})
    shown = [block for block in blocks(page) if "sim." in block and "import fcm_solve" not in block]
    assert len(shown) >= 2
    for number, block in enumerate(shown):
        with fcm.Simulation(scene, out=f"run-{number}") as sim:
            exec(block, {"fcm": fcm, "np": np, "sim": sim})
