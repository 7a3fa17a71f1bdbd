"""Draws results with the plots of this checkout, without building the package."""

import importlib
import sys

import plots

if __name__ == "__main__":
    command = importlib.import_module(f"{plots.load().__name__}.command")
    sys.exit(command.main(program="scripts/plot"))
