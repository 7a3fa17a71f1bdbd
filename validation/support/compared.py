"""Differences between the output of a command and the output shown on a page, beyond those between processors."""

import re

VALUE = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
NUMBER = re.compile(rf"(?<![\w.-]){VALUE}")
ESTIMATE = re.compile(rf"({VALUE}) \+- ({VALUE})")
SCALED = re.compile(rf"\(({VALUE}) \+- ({VALUE})\)(e[-+]?\d+)")
SIZE = re.compile(rf"({VALUE}) (?:kB|MB|GB)")
# Durations, and values derived from them, differ between machines and runs.
TIMING = re.compile(
    rf"{VALUE} (?:s|ms|microseconds|seconds|minutes|hours|days)\b|\bby its first \d+ steps|\b\d+(?= (?:runs )?at a time)|^run \d+ of (?=\d)"
)
# Verdicts depend on errors, and whether a value is given on the verdict: both change with the last bit of a chaotic run.
VERDICT = re.compile(
    rf"converged|still drifting|too short for any value|too short: {VALUE} times longer|has no value"
    r"|: not seen|: small|: matters|(?<= )-(?= )"
)
# Two runs of a chaotic suspension agree within their errors, which short runs estimate to a factor of two or three; the
# spread of few seeds that agree by chance is even less reliable.
ERRORS, RELATIVE, MEMORY = 10, 0.25, 2
ROUNDED = 0.02
# Lines that depend on the last bit: overlaps, progress, and the small changes that are seen.
LEFT_OUT = ("warning: spheres overlap", "step ", "changes it by less than its error: ", "makes no difference that these seeds show: ")


class Line:
    """A line of output in its parts: words, estimates with their errors, sizes in memory and plain numbers."""

    def __init__(self, line):
        text = SCALED.sub(r"\1\3 +- \2\3", line)
        text = re.sub(r"\([^()]*\)", "", text)
        text = VERDICT.sub(" ", TIMING.sub(" ", text))
        self.estimates = [(float(value), float(error)) for value, error in ESTIMATE.findall(text)]
        text = ESTIMATE.sub(" ", text)
        self.sizes = [float(size) for size in SIZE.findall(text)]
        text = SIZE.sub(" ", text)
        self.numbers = [float(number) for number in NUMBER.findall(text)]
        self.words = NUMBER.sub("#", text).split()

    def agrees(self, other):
        """Whether both agree, within differences between processors."""
        return (
            self.words == other.words
            and len(self.numbers) == len(other.numbers)
            and all(map(same_number, self.numbers, other.numbers))
            and all(max(pair) <= MEMORY * min(pair) for pair in zip(self.sizes, other.sizes))
            and all(map(same_estimate, self.estimates, other.estimates))
        )


def same_number(one, other):
    """Whether numbers without an error are equal, up to rounding if they are not integers."""
    if one.is_integer() and other.is_integer():
        return one == other
    return abs(one - other) <= ROUNDED * max(abs(one), abs(other))


def same_estimate(one, other):
    """Whether means are equal within their errors."""
    (value, error), (mean, spread) = one, other
    return abs(value - mean) <= max(ERRORS * max(error, spread), RELATIVE * max(abs(value), abs(mean)))


def kept(lines):
    """The lines that are compared: without progress, counts of overlaps and lists of small changes, with members of a family in order."""
    lines = [line for line in lines if not line.startswith(LEFT_OUT)]
    members = iter(sorted((line for line in lines if line.startswith("run ")), key=lambda line: line.split(": ", 1)[1]))
    return [next(members) if line.startswith("run ") else line for line in lines]


def differences(shown, now):
    """The lines that differ between the page and the output of the command."""
    shown, now = kept(shown), kept(now)
    if len(shown) != len(now):
        return [f"{len(shown)} lines on the page, {len(now)} now:", *now]
    return [f"{old!r} is now {new!r}" for old, new in zip(shown, now) if not Line(old).agrees(Line(new))]
