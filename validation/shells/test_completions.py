"""Each shell completes commands with the script that the program prints for it."""

import os
import pty
import select
import subprocess
import tempfile
import time
import unittest

from program import PROGRAM, run

# Text typed before the tab, and the shell's completion of it.
WORDS = {
    "run --wa": "run --walltime",
    "che": "check",
    "resume --acc": "resume --accept",
    "mobility --tol": "mobility --tolerance",
}
# The same for words that are not options, which scripts for fish lack.
VALUES = {"completions fi": "completions fish", "new settl": "new settling"}
SHELLS = {
    "bash": (["bash", "--norc", "--noprofile", "-i"], "source {script}"),
    "zsh": (["zsh", "-f", "-i"], "autoload -Uz compinit && compinit -u -d {script}.dump && source {script}"),
}
PATIENCE = 20


class Completions(unittest.TestCase):
    def script(self, shell):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        path = os.path.join(place.name, f"completions.{shell}")
        with open(path, "w") as file:
            file.write(run(["completions", shell]))
        return path

    def completed(self, shell, typed):
        """The line that an interactive shell shows after a tab."""
        words, load = SHELLS[shell]
        process, terminal = pty.fork()
        if process == 0:
            os.execvpe(words[0], words, os.environ | {"PS1": "", "TERM": "dumb", "HOME": "/nonexistent"})
        self.addCleanup(os.close, terminal)
        self.addCleanup(os.waitpid, process, 0)
        self.addCleanup(os.kill, process, 9)
        os.write(terminal, f"{load.format(script=self.script(shell))}; echo rea''dy\n".encode())
        self.read_until(terminal, "ready\r")
        os.write(terminal, f"fcm-solve {typed}\t".encode())
        return self.read_until(terminal, f"fcm-solve {(WORDS | VALUES)[typed]}")

    def read_until(self, terminal, wanted):
        """Output of the terminal until the text has appeared, or the time limit."""
        shown, end = "", time.monotonic() + PATIENCE
        while wanted not in shown and time.monotonic() < end:
            if select.select([terminal], [], [], 0.1)[0]:
                shown += os.read(terminal, 4096).decode(errors="replace")
        self.assertIn(wanted, shown)
        return shown

    def test_bash(self):
        for typed in WORDS | VALUES:
            self.completed("bash", typed)

    def test_zsh(self):
        for typed in WORDS | VALUES:
            self.completed("zsh", typed)

    def test_fish(self):
        script = self.script("fish")
        for typed, whole in WORDS.items():
            command = ["fish", "--no-config", "-c", f"source {script}; complete -C 'fcm-solve {typed}'"]
            found = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True).stdout
            self.assertIn(whole.split()[-1], [line.split("\t")[0] for line in found.splitlines()], typed)

    def test_bash_lists_what_there_is(self):
        """After a command, its options and those of the program are offered."""
        script = self.script("bash")
        lines = f"""source {script}; PATH={os.path.dirname(PROGRAM)}:$PATH
            COMP_WORDS=(fcm-solve run --) COMP_CWORD=2
            $(complete -p fcm-solve | sed 's/.*-F \\([^ ]*\\) .*/\\1/') fcm-solve -- run; echo "${{COMPREPLY[@]}}" """
        found = subprocess.run(["bash", "-c", lines], capture_output=True, text=True, timeout=PATIENCE, check=True).stdout
        self.assertLessEqual({"--out", "--set", "--walltime", "--threads"}, set(found.split()))
