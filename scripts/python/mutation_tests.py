"""Tests of the program with changes made to it, in a copy of its sources."""

import shutil
import subprocess

from crate_tests import CrateTests
from planting import plant, switch


class Copy:
    """A copy of the sources."""

    def __init__(self, root, folder):
        self.root, self.tree, self.build = root, folder / "tree", folder / "build"
        self.synchronise()

    def synchronise(self):
        """Updates the copy; unchanged files keep their times, so that they are not built again."""
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=self.root, check=True, capture_output=True, text=True).stdout.split("\0")
        for name in filter(None, names):
            source, copy = self.root / name, self.tree / name
            if source.is_symlink() and not copy.is_symlink():
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.symlink_to(source.readlink())
            elif source.is_file() and not (copy.is_file() and copy.read_bytes() == source.read_bytes()):
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, copy)
        for copy in self.tree.rglob("*"):
            if copy.is_file() and not (self.root / copy.relative_to(self.tree)).is_file():
                copy.unlink()

    def outcomes(self, crate, mutations):
        """Each change of a crate with its outcome: detected, missed, unviable (it does not compile) or timed out. Changes that
        compile as branches are built into the crate at once; the others one by one."""
        root = f"{crate}/src/lib.rs" if (self.tree / crate / "src" / "lib.rs").exists() else f"{crate}/src/main.rs"
        sources = {file: (self.tree / file).read_text() for file in {root} | {one.file for one in mutations}}
        tests = CrateTests(crate, self.tree, self.build)
        try:
            changes = dict(enumerate(mutations, 1))
            functions = self.build_planted(tests, (root, sources), changes)
            tests.measure()
            for number, function in functions.items():
                yield changes[number], tests.verdict(lambda stage: tests.tested(stage, number, function))
            for number, mutation in changes.items():
                if number not in functions:
                    self.write(sources | {mutation.file: mutation.apply(sources[mutation.file])})
                    yield mutation, tests.verdict(tests.built_and_tested)
        finally:
            self.write(sources)

    def build_planted(self, tests, source, changes):
        """Builds a crate with the changes that compile as branches, and returns their functions."""
        root, sources = source
        while changes:
            planted = plant(sources, changes)
            functions = {number: function for one in planted.values() for number, function in one.functions.items()}
            texts = sources | {file: one.text for file, one in planted.items()}
            self.write(texts | {root: texts[root] + switch(changes)})
            wrong = tests.errors()
            if not wrong:
                return functions
            guilty = set().union(*(planted[file].lines[line] for file, line in wrong if file in planted))
            changes = {number: changes[number] for number in functions.keys() - guilty} if guilty else {}
        self.write(sources)
        return {}

    def write(self, sources):
        """Writes sources; unchanged ones keep their modification times."""
        for file, text in sources.items():
            if (self.tree / file).read_text() != text:
                (self.tree / file).write_text(text)
