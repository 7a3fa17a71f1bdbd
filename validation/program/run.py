"""Runs the tests of this folder, or of those named, and counts them in the last line; with --quick without the files that
set `HEAVY`, the seconds that they take beside others, if these are more than some twenty.

A file of tests is a process. Twice as many of them as there are cores run at a time, since many tests wait for a
program that they stop or kill."""

import concurrent.futures
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest

HEAVY = re.compile(r"^HEAVY = (.+)$", re.MULTILINE)
COUNT = re.compile(r"(\d+) passed, (\d+) failed$")


def run_file(path):
    """Runs the tests of a file in this process."""
    # A background job ignores these, and so would the programs that the tests start and stop.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    suite = unittest.TestLoader().discover(str(path.parent), pattern=path.name)
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    bad = len(result.failures) + len(result.errors)
    print(f"{sum(os.times()[:4]):.0f} s of a core")
    print(f"{result.testsRun - bad} passed, {bad} failed")
    return result.wasSuccessful()


def run_apart(path):
    """Runs the tests of a file in a process of its own, and prints what it says at its end; passed, failed."""
    begin = time.monotonic()
    command = [sys.executable, __file__, str(path)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    text = done.stdout.rstrip()
    count = COUNT.search(text)
    passed, failed = (int(count[1]), int(count[2])) if count else (0, 1)
    # Without the count, which the last line of all is alone with.
    print(f"{path.name}, {time.monotonic() - begin:.0f} s\n{text.removesuffix(count[0] if count else '')}", flush=True)
    return passed, max(failed, int(done.returncode != 0))


def main():
    quick = "--quick" in sys.argv
    given = [pathlib.Path(word) for word in sys.argv[1:] if word != "--quick"] or [pathlib.Path(__file__).parent]
    if len(given) == 1 and given[0].is_file():
        sys.exit(not run_file(given[0]))
    texts = {file: file.read_text() for place in given for file in place.glob("test_*.py")}
    seconds = {file: int(found[1]) if (found := HEAVY.search(text)) else 0 for file, text in texts.items()}
    # Those that take longest first, then the longest texts, so that no long file is left alone at the end.
    files = sorted(texts, key=lambda file: (-seconds[file], -len(texts[file])))
    files = [file for file in files if not quick or seconds[file] == 0]
    with concurrent.futures.ThreadPoolExecutor(2 * os.cpu_count()) as pool:
        counts = list(pool.map(run_apart, files))
    passed, failed = (sum(numbers) for numbers in zip(*counts))
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
