"""Runs killed at random moments between start and end, and ranks suspended for a while."""

import os
import pathlib
import random
import shutil
import signal
import time

from runs import patience
from state import differences, end_state, unreadable


def children(process):
    path = pathlib.Path(f"/proc/{process}/task/{process}/children")
    try:
        return [int(child) for child in path.read_text().split()]
    except OSError:
        return []


def send(process, what):
    try:
        os.kill(process, what)
    except ProcessLookupError:
        pass  # It ended before.


def at_work(out):
    """Whether any process still has this folder in its command line: ranks outlive their launcher by a moment."""
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if str(out).encode() in path.read_bytes():
                return True
        except OSError:
            pass
    return False


def end(process, out, until):
    """Waits for a limited time until a killed run is gone."""
    said = "".join(process.communicate(timeout=until))
    deadline = time.monotonic() + until
    while at_work(out):
        if time.monotonic() > deadline:
            raise RuntimeError(f"a rank outlives its job by {until} s: {said}")
        time.sleep(0.01)


class Kills:
    """A run, its duration, and its undisturbed results."""

    def __init__(self, run, folder):
        self.run, self.out = run, folder / "out"
        os.makedirs(folder)
        self.seconds = run.whole(self.out)
        self.patience = patience(self.seconds)
        self.expected = end_state(self.out)

    def kill(self):
        """Kills one process of the job, possibly the launcher, at a random moment; None if the run can be continued."""
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.run.start(self.run.from_start(self.out))
        time.sleep(random.uniform(0, self.seconds))
        victim = random.choice([process.pid, *children(process.pid)])
        send(victim, signal.SIGKILL)
        end(process, self.out, self.patience)
        broken = unreadable(self.out)
        if broken:
            return f"unreadable files: {broken}"
        code, said = self.run.call(self.run.go_on(self.out), None, self.patience)
        if code != 0:
            return f"continuing ended with {code}: {said}"
        return self.wrong()

    def stop_for_a_while(self, seconds):
        """Suspends one rank for a while at a random moment; None if the results are unchanged."""
        shutil.rmtree(self.out, ignore_errors=True)
        process = self.run.start(self.run.from_start(self.out))
        time.sleep(random.uniform(0, self.seconds))
        victim = random.choice(children(process.pid) or [process.pid])
        send(victim, signal.SIGSTOP)
        time.sleep(seconds)
        send(victim, signal.SIGCONT)
        said = "".join(process.communicate(timeout=self.patience))
        return f"it ended with {process.returncode}: {said}" if process.returncode else self.wrong()

    def wrong(self):
        missed = differences(end_state(self.out), self.expected)
        return f"other results: {missed}" if missed else None


def try_kills(runs, folder, number):
    """Kills runs in turn; returns the failures."""
    return repeat(runs, folder / "kills", number, "kill", Kills.kill)


def try_stops(runs, folder, number):
    """Stops ranks of parallel runs in turn; returns the failures."""
    return repeat(runs, folder / "stops", number, "stop", lambda kills: kills.stop_for_a_while(0.5))


def repeat(runs, folder, number, what, attempt):
    random.seed(1)
    kept = [Kills(run, folder / str(place)) for place, run in enumerate(runs[:number])]
    failures = []
    for count in range(number if kept else 0):
        kills = kept[count % len(kept)]
        wrong = attempt(kills)
        if wrong:
            failures.append(f"{kills.run.name}, {what} {count + 1}: {wrong}")
            print(failures[-1], flush=True)
    return failures
