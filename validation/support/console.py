"""Commands with their output, as pages show them in `console` blocks: a line that begins with `$ ` is a command."""

import os
import pathlib
import re
import shutil
import subprocess

from .page import BOOK
from .program import PROGRAM, ROOT

CHOSEN = [ROOT / "README.md", *(BOOK / f"{name}.md" for name in ("getting-started", "tutorial", "families"))]
PAGES = [*CHOSEN, *sorted((BOOK / "how-to").glob("*.md"))]
BLOCK = re.compile(r"^```(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
INCLUDED = re.compile(r"\{\{#include (\S+)\}\}")
# A command with arguments, and a pattern of commands, whose arguments are words in capitals.
COMMAND = r"(?:fcm-solve [a-z-]+|scripts/[a-z-]+|mpirun|cargo|pip|python|curl|module) "
INLINE = re.compile(rf"`({COMMAND}[^`]+)`")
FORM = re.compile(r" [A-Z]+(?: |$)")


def commands(block):
    """The commands of a block, each with the lines of its output."""
    found = []
    for line in block.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        else:
            found[-1][1].append(line)
    return found


def blocks(text):
    """The blocks of commands with their output."""
    return [block for kind, block in BLOCK.findall(text) if kind == "console"]


def inline_commands(text):
    """The commands in the text of a page, outside its blocks."""
    found = [" ".join(command.split()) for command in INLINE.findall(BLOCK.sub("", text))]
    return [command for command in found if not FORM.search(command)]


def unprinted_commands(text):
    """The commands of a page without their output: in shell blocks, and in indented or unnamed blocks."""
    shell = [line for kind, block in BLOCK.findall(text) if kind in ("sh", "bash") for line in block.splitlines()]
    others = [line for kind, block in BLOCK.findall(text) if kind in ("", "text") for line in block.splitlines()]
    others += re.findall(r"^ {4}(\S.*)$", BLOCK.sub("", text), re.MULTILINE)
    lines = shell + [line for line in others if re.match(rf"(?:\$ )?{COMMAND}", line)]
    lines = [re.split(r"(?:^|\s)#", line)[0].strip() for line in lines]
    return [line for line in lines if line]


def prepare(text, folder):
    """Puts the files that a page needs into a folder: the scripts and scenes of the checkout, and the files that it includes."""
    for name in ("scripts", "scenes"):
        (folder / name).symlink_to(ROOT / name)
    for name in INCLUDED.findall(text):
        shutil.copy(BOOK / name, folder)


def printed(command, folder):
    """The lines that a command prints when run in a folder, output and errors in order."""
    path = f"{pathlib.Path(PROGRAM).resolve().parent}:{os.environ['PATH']}"
    shell = ["bash", "-o", "pipefail", "-c", command]
    ended = subprocess.run(shell, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=os.environ | {"PATH": path})
    if ended.returncode:
        raise RuntimeError(f"{command} ended with {ended.returncode}:\n{ended.stdout}")
    return ended.stdout.rstrip("\n").splitlines()


def run_page(text, folder):
    """The text of a page with the present output of its commands, run one after another in a folder."""

    def again(match):
        if match[1] != "console":
            return match[0]
        lines = []
        for command, _ in commands(match[2]):
            lines += [f"$ {command}", *printed(command, folder)]
        return "```console\n" + "".join(f"{line}\n" for line in lines) + "```"

    return BLOCK.sub(again, text)
