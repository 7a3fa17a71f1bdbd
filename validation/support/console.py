"""Commands with what they print, as pages show them in blocks of `console`: a line that begins with `$ ` is a command."""

import os
import pathlib
import re
import subprocess

from .program import PROGRAM

BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
# A command may be followed by this, and only its last lines are shown then.
TAIL = re.compile(r" \| tail -n (\d+)$")


def commands(block):
    """The commands of a block, each with the lines that it prints."""
    found = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


def printed(command, folder):
    """The lines that a command prints in a folder, output and errors in the order of their appearance."""
    path = f"{pathlib.Path(PROGRAM).resolve().parent}:{os.environ['PATH']}"
    shell = ["bash", "-o", "pipefail", "-c", command]
    ended = subprocess.run(shell, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=os.environ | {"PATH": path})
    if ended.returncode:
        raise RuntimeError(f"{command} ended with {ended.returncode}:\n{ended.stdout}")
    return ended.stdout.rstrip("\n").splitlines()


def run_page(text, folder):
    """The text of a page with what its commands print now, called one after another in a folder."""

    def again(match):
        lines = []
        for command, _ in commands(match[1]):
            lines += [f"$ {command}", *printed(command, folder)]
        return "```console\n" + "".join(f"{line}\n" for line in lines) + "```"

    return BLOCK.sub(again, text)


def without_numbers(text):
    """A text in which numbers, bars of progress and widths of columns may differ."""
    return [re.sub(r"\s+", " ", NUMBER.sub("0", line)).strip() for line in text.splitlines()]
