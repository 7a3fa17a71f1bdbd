"""Commands with what they print, as pages show them in blocks of `console`: a line that begins with `$ ` is a command."""

import os
import pathlib
import re
import subprocess

from .program import PROGRAM

BLOCK = re.compile(r"^```console\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
VERDICT = re.compile(r"\+-|(?<= )-(?= )|converged|still drifting|too short for any value|too short: +times longer|, s$|, +s$")


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
    """The lines of a text without what another machine may find otherwise: numbers, verdicts, warnings and parentheses."""
    kept = [line for line in text.splitlines() if not line.startswith(("warning: ", "step "))]
    return [" ".join(VERDICT.sub(" ", NUMBER.sub(" ", re.sub(r"\(.*\)", "", line))).split()) for line in kept]
