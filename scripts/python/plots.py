"""The plotting package of this checkout, without its compiled module."""

import importlib.util
import pathlib
import sys

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "python" / "fcm_solve" / "plots"


def load(name="fcm_solve_plots"):
    """Loads the package under a separate name."""
    options = {"submodule_search_locations": [str(PACKAGE)]}
    spec = importlib.util.spec_from_file_location(name, PACKAGE / "__init__.py", **options)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
