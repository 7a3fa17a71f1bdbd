"""Optional packages, which only some functions need."""

from importlib import import_module


def needed(module, what):
    """Imports a module, or raises an error that says how to install it."""
    try:
        return import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise ImportError(f"{what} needs {package}, which is not installed: pip install {package}") from error
