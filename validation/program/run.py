"""Runs the tests of this folder, or the named ones, and prints their number in the last line."""

import pathlib
import signal
import sys
import unittest

if __name__ == "__main__":
    # A background job ignores these signals, and so would the programs that the tests start and stop.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    folders = sys.argv[1:] or [str(pathlib.Path(__file__).parent)]
    suite = unittest.TestSuite(unittest.TestLoader().discover(folder) for folder in folders)
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    bad = len(result.failures) + len(result.errors)
    print(f"{result.testsRun - bad} passed, {bad} failed")
    sys.exit(not result.wasSuccessful())
