"""Pictures of results: runs of every kind of scene, and families of runs.

They need numpy and matplotlib, h5py where a run has a trajectory, and no other part of the package, so that a
checkout draws without building anything.
"""

from pathlib import Path

from .error import PlotError

__all__ = ["PlotError", "animate", "draw", "save"]


def draw(folder, by="excess", only=None, notes=None):
    """The picture of the results in a folder, as a figure of matplotlib.

    folder  folder of a run or of a family of runs
    by      quantity shown by colours, or the gray of disks: "excess" velocity over the fluid's or along the force, "speed",
            or "species"
    only    a quantity of the answers of a suspension, whose panel alone is drawn
    notes   a list to which notes on omitted parts, with reasons, are added
    """
    from . import family, grains, page, run, scene, style

    folder = Path(folder)
    kept = scene.read_scene(folder)
    with style.applied():
        if family.is_one(folder, kept) and only is None and grains.sweep.is_one(folder, kept):
            figure = grains.sweep.draw(folder, kept)
        elif family.is_one(folder, kept):
            figure = family.draw(folder, kept, only)
        elif kept.kind in grains.KINDS and only is not None:
            raise PlotError(f"{folder} holds grains, whose quantities are drawn together; leave {only} out")
        elif kept.kind in grains.KINDS:
            figure = grains.draw(folder, kept, by)
        else:
            results = run.Run(folder, kept)
            figure = page.draw(results, by, only)
            if notes is not None:
                notes += dict.fromkeys(results.notes)
        # Ticks and their positions are computed here, with the sizes of this style.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    return figure


def animate(folder, picture, by="excess"):
    """Writes all frames of disks as a GIF."""
    from . import family, grains, output, scene

    folder = Path(folder)
    kept = scene.read_scene(folder)
    if kept.kind != "granular-disks" or family.is_one(folder, kept):
        raise PlotError(
            f"{folder} is no run of disks, of which alone animations are made; fcm-solve report shows spheres in motion"
        )
    output.write(output.checked(picture, ("gif",)), grains.disks.animation(folder, kept, by))


def save(figure, picture):
    """Writes a figure as PNG, SVG or PDF, by the suffix of the file."""
    from . import output

    output.save(figure, picture)
