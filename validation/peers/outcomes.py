"""A plugin of pytest: skips tests that do not apply, each with the reason, and writes all outcomes."""

import collections
import importlib.util
import json
import os

import pytest

FULL = os.environ.get("PEERS_FULL") == "1"
SLOW = "takes many minutes; run with --full"
REASONS = {
    "reference": "compares with values of its own kernel to 1e-5 or less; spheres here are Gaussian envelopes",
    "self": "SelfMobility: not available; there is no solver without hydrodynamic interactions here",
    "wall": "NBody at a wall: boxes with a wall are periodic along it here",
    "words": "asserts its own error messages or limits of its method",
    "batches": "tests parameters of its algorithm",
    "refuses": "asserts that a feature is refused which is supported here",
    "arrays": "arrays of other libraries than NumPy are not supported here",
    "inside": "examines internal matrices of its scheme",
}
# By the name of a test, without its parameters.
TESTS = {
    **dict.fromkeys(("test_self_mobility_linear", "test_pair_mobility_linear", "test_self_mobility_angular"), "reference"),
    **dict.fromkeys(("test_pair_mobility_angular", "test_pair_mobility_angular_nbody"), "reference"),
    **dict.fromkeys(("test_dpstokes_matching_rpy", "test_non_square_matching_rpy", "test_nbody_wall_height_parameter"), "wall"),
    **dict.fromkeys(("test_wall_position_errors", "test_dpstokes_narrow_channel", "test_dpstokes_open_errors"), "words"),
    **dict.fromkeys(("test_nbody_good_batch_parameters", "test_nbody_bad_parameters"), "batches"),
    **dict.fromkeys(("test_pse_torques_unsupported", "test_pse_seed_unsupported"), "refuses"),
    "test_self_mobility_selfmobility": "self",
    "test_thermal_realspace": "inside",
}
# Tests of ten thousand draws and more; in a periodic box they take seconds.
SLOW_TESTS = ("test_deterministic_divM_matches_rfd", "test_fluctuation_dissipation_linear", "test_fluctuation_dissipation_angular")


def reason_for(item):
    """Why a test does not apply; nothing if it does."""
    parameters = item.callspec.params if hasattr(item, "callspec") else {}
    solver = getattr(parameters.get("Solver"), "__name__", "")
    periodicity = parameters.get("periodicity", ("", "", ""))
    name = item.originalname
    if solver == "SelfMobility":
        return REASONS["self"]
    if solver == "NBody" and periodicity[2] == "single_wall":
        return REASONS["wall"]
    if name in TESTS:
        return REASONS[TESTS[name]]
    if parameters.get("framework", "numpy") != "numpy":
        return REASONS["arrays"]
    if not FULL and name.startswith(SLOW_TESTS) and solver != "PSE":
        return SLOW
    return None


def pytest_collection_modifyitems(items):
    for item in items:
        if reason := reason_for(item):
            item.add_marker(pytest.mark.skip(reason=reason))


class Outcomes:
    """Outcomes of the tests, by file and name."""

    def __init__(self):
        self.counts = collections.defaultdict(lambda: collections.Counter())

    def pytest_runtest_logreport(self, report):
        name = report.nodeid.split("[")[0].split("/")[-1]
        if report.skipped:
            said = report.longrepr[2].removeprefix("Skipped: ") if isinstance(report.longrepr, tuple) else "no reason"
            self.counts[name]["skipped: " + said.split(": sphere")[0]] += 1
        elif report.when == "call" or report.failed:
            self.counts[name]["failed" if report.failed else "passed"] += 1

    def pytest_sessionfinish(self):
        with open(os.environ["PEERS_OUTCOMES"], "w", encoding="utf-8") as file:
            json.dump(self.counts, file)


def pytest_configure(config):
    config.pluginmanager.register(Outcomes())
    assert importlib.util.find_spec("fcm_solve"), "the package fcm_solve is not installed"
