"""Makes each call that changes the folder of a run fail, one at a time."""

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
    """The n-th call of a kind fails: once, from then on, or, for a write, after half of its bytes. Or the program is killed
    before the call or, for a write, after half of its bytes."""

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
    """The folder of the runs of one kind, with the library that makes system calls fail."""

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
        """Restores the folder to its state before a run, with an empty log."""
        shutil.rmtree(self.out, ignore_errors=True)
        if self.former.exists():
            shutil.copytree(self.former, self.out)
        self.log.unlink(missing_ok=True)

    def arguments(self):
        return self.run.go_on(self.out) if self.former.exists() else self.run.from_start(self.out)

    def stop_halfway(self):
        """From now on runs continue one that was stopped halfway by a full disk."""
        writes = sum(call == "write" for call in self.calls())
        self.reset()
        self.call(self.arguments(), self.environment(Fault("write", 3 * writes // 4, errno.ENOSPC, "stays")))
        shutil.copytree(self.out, self.former)

    def calls(self, rank=0):
        """The calls of a run without faults, in order, as named in the log of the library."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(rank=rank))
        if code != 0 or differences(end_state(self.out), self.expected):
            raise RuntimeError(f"{self.run.name} with all calls listed ended with {code}:\n{said}")
        return [line.split()[0] for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def survives(self, fault):
        """None if the run survives the fault; otherwise the failure."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(fault))
        if not self.log.exists():
            return f"the call was not made: {said}"
        return self.wrong_end(fault, code, said) or self.wrong_after(code)

    def wrong_end(self, fault, code, said):
        """Failure in the end of the run, or None."""
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
        """Failure after the run has been resumed, or None; a run that tolerated the failed call is already finished."""
        if code != 0:
            code, said = self.call(self.run.go_on(self.out))
            if code != 0:
                return f"continuing ended with {code}: {said}"
        missed = differences(end_state(self.out), self.expected)
        return f"other results: {missed}" if missed else None


def faults(calls, ways):
    """The faults to try: every kind at every call, with the errors in turn. Only long writes can end early."""
    counts = collections.Counter()
    for place, call in enumerate(calls):
        counts[call] += 1
        for number, way in enumerate(ways):
            fault = Fault(call, counts[call], ERRORS[(place + number) % len(ERRORS)], way)
            if call in CALLS and (way not in PARTS or calls[place + 1 : place + 2] == ["long"]):
                yield fault


def sample(all_faults, most):
    """An equally spaced sample of limited size; all without a limit."""
    all_faults = list(all_faults)
    step = max(1, -(-len(all_faults) // most)) if most else 1
    return all_faults[::step]


def try_run(run, folder, library, ways, most):
    """Tries faults from the start of the run and in its continuation; returns their number, the failures, and the number of
    calls by ranks other than the first."""
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
