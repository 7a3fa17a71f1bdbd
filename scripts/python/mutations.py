"""Mutations of the program, in a random order that does not depend on edits elsewhere."""

import collections
import dataclasses
import hashlib
import json
import subprocess
import tomllib


@dataclasses.dataclass(frozen=True)
class Mutation:
    """One change of one place."""

    # The change and its source line, which are unaffected by edits elsewhere and by
    # moving the file.
    key: str
    # The folder of the crate.
    crate: str
    file: str
    # Lines and columns, from 1, of the first character and of the one after the last.
    start: tuple
    end: tuple
    replacement: str
    # The same for the enclosing function, if any.
    function: tuple | None

    @property
    def folder(self):
        """The folder at the root of the repository, which may hold several crates."""
        return self.crate.split("/")[0]

    @property
    def place(self):
        return f"{self.file}:{self.start[0]}"

    @staticmethod
    def offset(text, edge):
        """Offset of a line and column in a source text."""
        line, column = edge
        return sum(map(len, text.splitlines(keepends=True)[: line - 1])) + column - 1

    def apply(self, text):
        """The source with the change made."""
        return text[: self.offset(text, self.start)] + self.replacement + text[self.offset(text, self.end) :]


def edges(span):
    return tuple((span[edge]["line"], span[edge]["column"]) for edge in ("start", "end"))


def all_mutations(root):
    """Mutations of all crates."""
    command = ["cargo", "mutants", "--workspace", "--list", "--json", "--config", "scripts/mutants.toml"]
    listed = json.loads(subprocess.run(command, cwd=root, check=True, capture_output=True, text=True).stdout)
    seen, sources = collections.Counter(), {}
    for one in listed:
        file, (start, end) = one["file"], edges(one["span"])
        if file not in sources:
            sources[file] = (root / file).read_text().splitlines()
        change = one["name"].split(": ", 1)[1]
        key = f"{change}: {sources[file][start[0] - 1].strip()}"
        seen[key] += 1
        key += f" ({seen[key]})" if seen[key] > 1 else ""
        function = edges(one["function"]["span"]) if one["function"] else None
        yield Mutation(key, file.split("/src/")[0], file, start, end, one["replacement"], function)


def sampled(mutations, seed):
    """All mutations in the random order of a seed: the first ones are a random sample of any size."""
    return sorted(mutations, key=lambda one: hashlib.sha256(f"{seed} {one.key}".encode()).digest())


def known_as_equal(root):
    """Reasons why some mutations are equivalent, by key."""
    with open(root / "scripts" / "mutants-equal.toml", "rb") as file:
        return {one["mutation"]: one["reason"] for one in tomllib.load(file).get("equal", [])}
