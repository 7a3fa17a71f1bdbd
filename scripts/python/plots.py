"""The package of plots of this checkout, without the compiled module beside it."""

import importlib.util
import pathlib
import sys

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "python" / "fcm_solve" / "plots"


def load(name="fcm_solve_plots"):
    """The package, under a name of its own."""
    options = {"submodule_search_locations": [str(PACKAGE)]}
    spec = importlib.util.spec_from_file_location(name, PACKAGE / "__init__.py", **options)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
