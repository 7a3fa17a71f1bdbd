"""Makes each call that changes the folder of a run fail, one at a time."""

import collections
import concurrent.futures
import dataclasses
import errno
import itertools
import os
import queue
import shutil
import signal

from runs import patience
from state import differences, end_state, unreadable

CALLS = ("open", "write", "sync", "rename", "unlink", "truncate", "mkdir", "close")
KILLS, PARTS = ("killed", "torn"), ("short", "torn")
ERRORS = (errno.ENOSPC, errno.EIO, errno.EDQUOT)


@dataclasses.dataclass(frozen=True)
class Fault:
    """The n-th call of a kind fails in each process: once, from then on, or, for a write, after half of its bytes. Or the program is killed
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
        writes = max(process.count("write") for process in self.calls())
        self.reset()
        self.call(self.arguments(), self.environment(Fault("write", 3 * writes // 4, errno.ENOSPC, "stays")))
        shutil.copytree(self.out, self.former)

    def calls(self, rank=0):
        """The calls of each process of a run without faults, in order, as named in the log of the library."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(rank=rank))
        if code != 0 or differences(end_state(self.out), self.expected):
            raise RuntimeError(f"{self.run.name} with all calls listed ended with {code}:\n{said}")
        processes = collections.defaultdict(list)
        for line in self.log.read_text().splitlines() if self.log.exists() else []:
            call, process = line.split()[:2]
            processes[process].append(call)
        return list(processes.values())

    def survives(self, fault):
        """None if the run survives the fault; otherwise the failure."""
        self.reset()
        code, said = self.call(self.arguments(), self.environment(fault))
        if not self.log.read_text():
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


def faults(processes, ways):
    """The faults to try: every kind at every call of a process, with the errors in turn. A call of the same number fails in
    all processes at once."""
    of_processes = (of_process(calls, ways) for calls in processes)
    return {(fault.call, fault.at, fault.how): fault for fault in itertools.chain(*of_processes)}.values()


def of_process(calls, ways):
    """The faults of one process. Only long writes can end early."""
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


class Places:
    """Folders in which runs of one kind are tried at the same time, as many as the processors allow."""

    def __init__(self, run, folder, library):
        places = max(1, (os.cpu_count() or 1) // (run.ranks or 1))
        self.all = []
        for number in range(places):
            os.makedirs(folder / str(number))
            self.all.append(Place(run, folder / str(number), library))
        self.free = queue.SimpleQueue()
        for place in self.all:
            self.free.put(place)

    def survives(self, fault):
        """The fault, and None if the run survives it; otherwise the failure."""
        place = self.free.get()
        try:
            return fault, place.survives(fault)
        finally:
            self.free.put(place)

    def try_all(self, chosen):
        """Yields each fault with its failure or None."""
        with concurrent.futures.ThreadPoolExecutor(len(self.all)) as threads:
            yield from threads.map(self.survives, chosen)


def try_run(run, folder, library, ways, most):
    """Tries faults from the start of the run and in its continuation; returns their number, the failures, and the number of
    calls by ranks other than the first."""
    places = Places(run, folder, library)
    first = places.all[0]
    tried, failures = 0, []
    others = sum(len(calls) for rank in range(1, run.ranks or 1) for calls in first.calls(rank))
    for start in ("from the start", "going on"):
        if start == "going on":
            for place in places.all:
                place.stop_halfway()
        for fault, wrong in places.try_all(sample(faults(first.calls(), ways), most)):
            tried += 1
            if wrong:
                failures.append(f"{run.name}, {start}, {fault}: {wrong}")
                print(failures[-1], flush=True)
    return tried, failures, others
