"""Every call by which a run changes its folder is made to fail, one at a time."""

import collections
import dataclasses
import errno
import os
import shutil
import signal

from runs import patience
from state import differences, end_state, unreadable

CALLS = ("open", "write", "sync", "rename", "unlink", "truncate", "mkdir", "close")
KILLS, PARTS = ("killed", "torn"), ("short", "torn")
ERRORS = (errno.ENOSPC, errno.EIO, errno.EDQUOT)


@dataclasses.dataclass(frozen=True)
class Fault:
    """The n-th call of a kind fails: once, from then on, or, of a write, after half of its bytes. Or the program is killed
    before the call, or, of a write, after half of its bytes."""

    call: str
    at: int
    error: int
    how: str

    @property
    def kills(self):
        return self.how in KILLS

    def __str__(self):
        return f"{self.call} {self.at}, {errno.errorcode[self.error]}, {self.how}"


class Place:
    """The folder in which runs of one kind are tried, with the library that makes system calls fail."""

    def __init__(self, run, folder, library):
        self.run, self.out, self.log = run, folder / "out", folder / "log"
        self.former, self.library = folder / "former", library
        self.patience = patience(self.run.whole(self.out))
        self.expected = end_state(self.out)

    def call(self, arguments, environment=None):
        return self.run.call(arguments, environment, self.patience)

    def environment(self, fault=None, rank=0):
        variables = {"LD_PRELOAD": self.library, "FAULT_FOLDER": self.out, "FAULT_LOG": self.log, "FAULT_RANK": rank}
        if fault:
            variables |= {"FAULT_CALL": fault.call, "FAULT_AT": fault.at, "FAULT_ERROR": fault.error}
            variables |= {"FAULT_HOW": fault.how}
        return {name: str(value) for name, value in variables.items()}

    def reset(self):
        """The folder as it is before a run that is tried, and an empty log."""
        shutil.rmtree(self.out, ignore_errors=True)
        if self.former.exists():
            shutil.copytree(self.former, self.out)
        self.log.unlink(missing_ok=True)

    def arguments(self):
        return self.run.go_on(self.out) if self.former.exists() else self.run.from_start(self.out)

    def stop_halfway(self):
        """From now on runs that are tried go on with one that found the disk full in its middle."""
        writes = sum(call == "write" for call in self.calls())
        self.reset()
        self.call(self.arguments(), self.environment(Fault("write", 3 * writes // 4, errno.ENOSPC, "stays")))
        shutil.copytree(self.out, self.former)

    def calls(self, rank=0):
        """The calls of a run in which all of them pass, in order, as the library's log names them."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(rank=rank))
        if code != 0 or differences(end_state(self.out), self.expected):
            raise RuntimeError(f"{self.run.name} with all calls listed ended with {code}:\n{said}")
        return [line.split()[0] for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def survives(self, fault):
        """None if the run bears the fault; else what went wrong."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(fault))
        if not self.log.exists():
            return f"the call was not made: {said}"
        return self.wrong_end(fault, code, said) or self.wrong_after(code)

    def wrong_end(self, fault, code, said):
        """Fault in the way in which the run ended, or None."""
        if code is None:
            return f"it hangs: {said}"
        if fault.kills and code != -signal.SIGKILL and not (self.run.is_family and code in (0, 1)):
            return f"it was not killed: it ended with {code}: {said}"
        if "panicked" in said or (not fault.kills and code not in (0, 1)):
            return f"it ended with {code}: {said}"
        if code == 1 and str(self.out) not in said:
            return f"it names no file: {said}"
        broken = unreadable(self.out)
        return f"it left unreadable files: {broken}; {said}" if broken else None

    def wrong_after(self, code):
        """Fault after the run has been resumed, or None; a run that survived the failed call has nothing left to do."""
        if code != 0:
            code, said = self.call(self.run.go_on(self.out))
            if code != 0:
                return f"going on ended with {code}: {said}"
        missed = differences(end_state(self.out), self.expected)
        return f"other results: {missed}" if missed else None


def faults(calls, ways):
    """The faults to try: at every call each of the ways, all errors in turn. Only long writes can end early."""
    counts = collections.Counter()
    for place, call in enumerate(calls):
        counts[call] += 1
        for number, way in enumerate(ways):
            fault = Fault(call, counts[call], ERRORS[(place + number) % len(ERRORS)], way)
            if call in CALLS and (way not in PARTS or calls[place + 1 : place + 2] == ["long"]):
                yield fault


def sample(all_faults, most):
    """So many of them, evenly; all if there is no bound."""
    all_faults = list(all_faults)
    step = max(1, -(-len(all_faults) // most)) if most else 1
    return all_faults[::step]


def try_run(run, folder, library, ways, most):
    """Tries faults from the run's start and when it goes on; returns how many, what was not survived, and how many calls
    other ranks than the first make."""
    os.makedirs(folder)
    place = Place(run, folder, library)
    tried, failures = 0, []
    others = sum(len(place.calls(rank)) for rank in range(1, run.ranks or 1))
    for start in ("from the start", "going on"):
        if start == "going on":
            place.stop_halfway()
        for fault in sample(faults(place.calls(), ways), most):
            wrong = place.survives(fault)
            tried += 1
            if wrong:
                failures.append(f"{run.name}, {start}, {fault}: {wrong}")
                print(failures[-1], flush=True)
    return tried, failures, others
