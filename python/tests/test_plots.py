"""Figures of results: their contents, omitted parts, and errors of one line."""

import math
import sys
import warnings

import fcm_solve as fcm
import matplotlib.image
import numpy as np
import plot_folders as folders
import pytest
from fcm_solve import __main__ as program
from fcm_solve import plots
from fcm_solve.plots import answers
from fcm_solve.plots.csv_table import read_table
from fcm_solve.plots.slabs import slab_means, volume_fractions
from fcm_solve.plots.spheres import nearest_to_viewer, render
from fcm_solve.plots.units import Units, with_error


@pytest.fixture(autouse=True)
def no_warnings():
    """Checks that a figure is drawn without a warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def panel(figure, label):
    """The axes whose vertical label begins with `label`."""
    found = [axes for axes in figure.axes if axes.get_ylabel().startswith(label)]
    assert len(found) == 1, [axes.get_ylabel() for axes in figure.axes]
    return found[0]


def command(capsys, *words):
    """The exit status of the command, its output and its errors, as lines."""
    status = program.main(["plot", *map(str, words)])
    said = capsys.readouterr()
    return status, said.out.splitlines(), said.err.splitlines()


def test_settling_velocities_are_over_the_stokes_velocity(tmp_path):
    figure = plots.draw(folders.run(tmp_path / "run"))
    line = panel(figure, "settling velocity").lines[0]
    np.testing.assert_allclose(line.get_ydata(), 0.5)
    along, across = panel(figure, "velocity fluctuation").lines[:2]
    np.testing.assert_allclose(along.get_ydata(), 0.2)
    np.testing.assert_allclose(across.get_ydata(), 0.2)


def test_stresses_in_shear_are_over_the_strain(tmp_path):
    viscosity, first = np.linspace(2, 3, 11), np.linspace(0, 4, 11)
    columns = {"relative_viscosity": viscosity, "first_normal_stress_difference": first}
    figure = plots.draw(folders.run(tmp_path / "run", folders.SHEAR, **columns))
    line = panel(figure, "relative viscosity").lines[0]
    np.testing.assert_allclose(line.get_xdata(), np.linspace(0, 2, 11))
    np.testing.assert_allclose(line.get_ydata(), viscosity)
    np.testing.assert_allclose(panel(figure, "stress").lines[0].get_ydata(), first / 2)


def test_strain_adds_up_where_the_flow_is_reversed(tmp_path):
    scene = folders.SHEAR + "reversal_at = [0.5]\n"
    strain = np.concatenate([np.linspace(0, 1, 6), np.linspace(0.8, 0, 5)])
    columns = {"strain": strain, "shear_rate": np.ones(11), "relative_viscosity": np.ones(11)}
    figure = plots.draw(folders.run(tmp_path / "run", scene, **columns))
    axes = panel(figure, "relative viscosity")
    np.testing.assert_allclose(axes.lines[0].get_xdata(), np.linspace(0, 2, 11), atol=1e-12)
    assert axes.get_xlabel() == "accumulated strain"


def test_answers_are_bands_over_their_series_and_a_table(tmp_path):
    folder = folders.run(tmp_path / "run", folders.SHEAR, relative_viscosity=np.linspace(2, 3, 11))
    row = ["relative_viscosity", "all", 2.5, 0.25, 20, 0.3, "too short", 4.2, ""]
    other = ["segregation", "all", "", "", "", 0.3, "meaningless", "", ""]
    folders.write_csv(folder / "summary.csv", folders.ANSWERS, [row, other])
    figure = plots.draw(folder)
    axes = panel(figure, "relative viscosity")
    band = axes.collections[0].get_paths()[0].get_extents()
    np.testing.assert_allclose([band.x0, band.x1, band.y0, band.y1], [0.6, 2.0, 2.25, 2.75])
    shade = axes.patches[0].get_path().get_extents(axes.patches[0].get_patch_transform())
    np.testing.assert_allclose([shade.x0, shade.x1], [0.0, 0.6])
    cells = figure.axes[-1].tables[0].get_celld()
    texts = [cells[1, column].get_text().get_text() for column in range(3)]
    assert texts == ["relative viscosity", "2.50 \u00b1 0.25", "too short: 4.2 times longer"]
    assert [cells[2, column].get_text().get_text() for column in (1, 2)] == ["\u2013", "too short for any value"]


def test_verdicts_are_in_the_words_of_the_program():
    def judged(verdict, longer=math.nan):
        return answers.Answer("a", "all", 1.0, 0.1, 0.0, longer, verdict, "").judged

    assert judged("too short", 229.7) == "too short: 230 times longer"
    assert judged("too short", 1.01) == "too short: 1.1 times longer"
    assert [judged("converged"), judged("drifting")] == ["converged", "still drifting"]


def test_one_quantity_is_drawn_alone(tmp_path, capsys):
    folder = folders.run(tmp_path / "run")
    for quantity in ("settling_velocity", "hindered_settling_function"):
        figure = plots.draw(folder, only=quantity)
        assert [axes.get_ylabel().split("\n")[0] for axes in figure.axes] == ["settling velocity"]
    assert len(fcm.open(folder).plot(only="velocity_fluctuation_parallel").axes) == 1
    status, _, errors = command(capsys, folder, "--only", "viscosity")
    assert (
        status == 1 and "has no series of viscosity; it has hindered_settling_function, settling_velocity" in errors[0]
    )
    family(tmp_path / "family")
    assert len(plots.draw(tmp_path / "family", only="shear_stress").axes) == 1
    status, _, errors = command(capsys, tmp_path / "family", "--only", "viscosity")
    assert status == 1 and "has no mean of viscosity; it has shear_stress" in errors[0]


def test_every_answer_of_a_channel_has_a_panel(tmp_path):
    scene = folders.SHEAR.replace('kind = "shear"\nrate = 2.0', 'kind = "poiseuille"\npressure_gradient = 1.0')
    scene = scene.replace("[fluid]", 'boundaries = ["periodic", "periodic", "walls"]\n[fluid]')
    columns = {
        f"{name}[heavy]": np.ones(11) for name in ("height_mean", "height_deviation", "particle_flux_x", "migration_z")
    }
    walls = {f"wall_shear_stress_x[{wall}]": np.ones(11) for wall in ("lower", "upper")}
    folder = folders.run(tmp_path / "run", scene, **columns, **walls, pressure_gradient=np.ones(11))
    answers = "particle_flux slip_velocity migration mean_height pressure_gradient lower_wall_shear_stress"
    for quantity in answers.split():
        assert len(plots.draw(folder, only=quantity).axes) == 1, quantity
    labels = [axes.get_ylabel() for axes in plots.draw(folder).axes]
    assert {"migration", "particle flux", "slip velocity", "pressure gradient"} <= set(labels)


def test_units_of_scenes_in_si_units_have_names(tmp_path):
    scene = folders.SETTLING.replace("radius = 1.0", "radius = 1.0e-6")
    scene += "density_difference = 1000.0\n[gravity]\nacceleration = [0.0, 0.0, -9.81]\n"
    figure = plots.draw(folders.run(tmp_path / "run", scene))
    assert panel(figure, "settling velocity").get_xlabel() == "time (s)"
    assert panel(figure, "smallest gap").get_ylabel() == "smallest gap (mm)"
    units = Units(True)
    assert units.scale("length", [2.5e-6]) == (pytest.approx(1e6), "\u00b5m")
    assert units.scale("length^2/time", [4e-12]) == (pytest.approx(1e12), "\u00b5m\u00b2/s")
    assert units.scale("force/length^2", [5500.0]) == (pytest.approx(1e-3), "kPa")
    assert Units(False).scale("length", [2.5e-6]) == (1.0, "")
    assert Units(False).axis("length", [2.5e-6]) == (pytest.approx(1e6), "10\u207b\u2076")
    assert Units(False).axis("length", [250.0]) == (1.0, "")
    assert units.axis("1/time", [2e6]) == (pytest.approx(1e-6), "10\u2076 1/s")


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (15.32, 0.4, "15.32 \u00b1 0.40"),
        (268.0, 24.0, "268 \u00b1 24"),
        (-7.0e-6, 2e-7, "(\u22127.00 \u00b1 0.20)\u00b710\u207b\u2076"),
        (3.0, 0.0, "3"),
        (float("nan"), 1.0, "\u2013"),
    ],
)
def test_errors_have_two_digits(value, error, text):
    assert with_error(value, error) == text


def family(folder):
    """The folder of a family of two points."""
    folders.run(folder, folders.SHEAR + "[sweep]\n", rows=0, frames=0)
    rows = [
        [f"point-{n}", f"fluid.viscosity = {x}", "shear_stress", "all", "", "force/length^2", x, y, 0.1, 4, 0.2, 0.1, 1]
        for n, (x, y) in enumerate([(2.0, 5.0), (1.0, 3.0)], start=1)
    ]
    folders.write_csv(folder / "family.csv", folders.FAMILY.split(","), rows)
    return folder


def test_a_family_has_curves_with_errors_over_the_first_key(tmp_path):
    folder = family(tmp_path / "family")
    axes = panel(plots.draw(folder), "shear stress")
    assert axes.get_xlabel() == "fluid.viscosity"
    curve = axes.containers[0]
    np.testing.assert_allclose(curve.lines[0].get_xydata(), [[1, 3], [2, 5]])
    np.testing.assert_allclose(curve.lines[2][0].get_segments()[0][:, 1], [2.9, 3.1])
    (folder / "family.csv").unlink()
    with pytest.raises(plots.PlotError, match="has no answers yet"):
        plots.draw(folder)


def test_a_family_without_means_has_the_series_of_its_runs(tmp_path):
    folder = folders.run(tmp_path / "family", folders.SHEAR + "[ensemble]\nseeds = 2\n", rows=0, frames=0)
    for number, member in enumerate(["point-0001/seed-0001", "point-0001/seed-0002", "point-0002/seed-0001"]):
        (folder / member).mkdir(parents=True)
        viscosity = np.full(11, float(number))
        folders.run(folder / member, folders.SHEAR, frames=0, relative_viscosity=viscosity)
    axes = panel(plots.draw(folder), "relative viscosity")
    assert [line.get_ydata()[0] for line in axes.lines] == [0, 1, 2]
    assert axes.lines[0].get_color() == axes.lines[1].get_color() != axes.lines[2].get_color()
    assert [text.get_text() for text in axes.get_legend().texts] == ["point 1", "point 2"]


NAMES = ["a, b", "$x_1$", "_hidden", "\u7389 und gro\u00df", "x" * 100]


@pytest.mark.parametrize("name", NAMES)
def test_names_of_any_letters_are_labels(tmp_path, name):
    scene = folders.SETTLING.replace('"heavy"', f"'{name}'") + '[[species]]\nname = "light"\nradius = 1.0\ncount = 1\n'
    scene += "force = [0.0, 0.0, 1.0]\n"
    folder = folders.run(tmp_path / "run", scene)
    columns, rows = folders.series(np.linspace(0, 1, 5))
    light = [column.replace("heavy", "light") for column in columns if "heavy" in column]
    named = [column.replace("heavy", name) for column in columns]
    folders.write_csv(folder / "observables.csv", named + light, [[*row, *row[2:8]] for row in rows])
    figure = plots.draw(folder, by="species")
    figure.savefig(tmp_path / "picture.png")
    labels = [text.get_text() for text in panel(figure, "settling").get_legend().texts]
    assert len(labels) == 2 and all(len(label) <= 33 for label in labels)


def test_species_without_names_are_those_of_their_numbers(tmp_path):
    folder = folders.run(tmp_path / "run", folders.SETTLING.replace('name = "heavy"\n', ""))
    columns, rows = folders.series(np.linspace(0, 1, 5))
    folders.write_csv(folder / "observables.csv", [column.replace("heavy", "1") for column in columns], rows)
    (folder / "statistics").mkdir()
    pairs = [("1", "1", 2.0, 1.5), ("1", "1", 3.0, 1.0)]
    folders.write_csv(folder / "statistics" / "pairs.csv", ["first", "second", "distance", "g"], pairs)
    figure = plots.draw(folder)
    assert len(panel(figure, "settling").lines[0].get_xdata()) == 5
    np.testing.assert_allclose(panel(figure, "pair distribution").lines[0].get_xydata(), [[2, 1.5], [3, 1]])


def test_what_is_missing_or_damaged_is_left_out_and_named(tmp_path, capsys):
    folder = folders.run(tmp_path / "run", frames=0)
    status, said, errors = command(capsys, folder)
    assert (status, errors) == (0, []) and "output.trajectory_every" in said[0]
    assert said[1] == f"picture    {folder / 'picture.png'}"
    (folder / "trajectory.h5").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    status, said, errors = command(capsys, folder)
    assert (status, errors) == (0, []) and said[0].startswith("left out   spheres: can't read")
    with (folder / "observables.csv").open("a") as file:
        file.write("11,1.1")
    assert len(read_table(folder / "observables.csv")) == 11, "the row that is not whole is left out"
    with (folder / "observables.csv").open("a") as file:
        file.write("\n")
    status, said, errors = command(capsys, folder)
    assert status == 1 and len(errors) == 1 and "row 13 has 2 cells" in errors[0]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({}, "holds no run: it has no scene.toml"),
        ({"scene.toml": "x = ["}, "scene.toml is damaged"),
        ({"scene.toml": "species = 3"}, "scene.toml is damaged"),
        ({"scene.toml": "box = 3"}, "scene.toml is damaged"),
        ({"scene.toml": folders.SETTLING}, "has nothing to draw"),
        ({"scene.toml": folders.SETTLING + "[ensemble]\nseeds = 2\n"}, "has no answers yet"),
        ({"scene.toml": 'kind = "granular-disks"\n[sweep]\n'}, "has no answers yet"),
        ({"scene.toml": 'kind = "granular-disks"\n'}, "neither time series nor trajectory"),
        ({"scene.toml": 'kind = "shear-cell"\n'}, "has no averages yet"),
        ({"scene.toml": 'kind = "shear-cell-continuum"\n'}, "run the scene anew"),
        ({"scene.toml": 'kind = "shear-cell-continuum"\n', "profile.csv": "y\n1\n"}, "has no column speed"),
    ],
)
def test_errors_take_one_line(tmp_path, capsys, files, message):
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    status, said, errors = command(capsys, tmp_path)
    assert (status, said, len(errors)) == (1, [], 1) and errors[0].startswith("error: ") and message in errors[0]


def test_formats_are_by_suffix_or_by_name(tmp_path, capsys):
    folder = folders.run(tmp_path / "run")
    for format_name, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        assert command(capsys, folder, "--format", format_name)[0] == 0
        assert (folder / f"picture.{format_name}").read_bytes().startswith(start)
        assert command(capsys, folder, tmp_path / f"other.{format_name}")[0] == 0
    refused = {
        ("x.jpg",): "end in one of .png, .svg, .pdf",
        ("x.png", "--format", "svg"): "two formats",
        (tmp_path / "none" / "x.png",): "there is no folder",
        ("--animate",): "is no run of disks",
    }
    for words, message in refused.items():
        status, _, errors = command(capsys, folder, *words)
        assert status == 1 and len(errors) == 1 and message in errors[0]
    assert not list(folder.glob(".*"))


def test_a_run_is_drawn_from_python(tmp_path):
    folder, settings = folders.run(tmp_path / "run"), dict(matplotlib.rcParams)
    figure = fcm.open(folder).plot(tmp_path / "picture.png")
    assert figure._suptitle.get_text() == "Settling"
    assert matplotlib.image.imread(tmp_path / "picture.png").std() > 0.01
    assert dict(matplotlib.rcParams) == settings, "the style of others is left alone"
    (folder / "observables.csv").unlink()
    (folder / "trajectory.h5").unlink()
    with pytest.raises(fcm.Error, match="has nothing to draw"):
        fcm.open(folder).plot()


def test_a_package_that_is_missing_is_named(tmp_path, capsys, monkeypatch):
    folder = folders.run(tmp_path / "run")
    monkeypatch.setitem(sys.modules, "h5py", None)
    status, said, errors = command(capsys, folder)
    assert (status, errors) == (0, []) and "h5py" in said[0]


def test_volumes_in_slabs_add_up_to_those_of_the_spheres():
    heights, radii = np.array([1.0, 2.2, 5.0]), np.array([1.0, 0.5, 1.5])
    edges = np.linspace(0, 7, 30)
    fractions = volume_fractions(heights, radii, edges, area=4.0)
    assert np.sum(fractions * np.diff(edges)) * 4.0 == pytest.approx(4 / 3 * np.pi * np.sum(radii**3))
    half = volume_fractions(np.array([0.0]), np.array([1.0]), np.array([-1.0, 0.0, 1.0]), area=1.0)
    np.testing.assert_allclose(half, 2 / 3 * np.pi)
    np.testing.assert_array_equal(
        slab_means(np.array([0.5, 0.6]), np.array([1.0, 3.0]), np.array([0, 1, 2])), [2, np.nan]
    )


def test_the_nearest_sphere_is_seen():
    places, radii = np.array([[0.0, 0.0, 0.0]] * 30_000), np.ones(30_000)
    places[:, 2] = np.random.default_rng(1).permutation(30_000)
    assert np.argmax(places[:, 2]) in nearest_to_viewer(places, radii)
    assert len(nearest_to_viewer(places, radii)) < 100
    colours = np.array([[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0]])
    image, _ = render(np.array([[5.0, 5.0, 5.0], [5.0, -5.0, 5.0]]), np.ones(2), colours, 10 * np.eye(3), 200)
    assert image[..., 0].max() > 0.5 and image[..., 1].max() > 0.5
