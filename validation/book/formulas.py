"""Formulas in the Markdown source of the book, and faults that would display them incorrectly.

A formula stands between `\\\\(` and `\\\\)`, or `\\\\[` and `\\\\]` on the page's source. Markdown removes one backslash of each pair, and a
single one before other punctuation, so `\\,` has to be written `\\\\,`; a star is written `\\*`, since `*` marks emphasis."""

import dataclasses
import re

# Code in fences, code indented by four blanks after a blank line, and inline code are shown literally; comments are not shown.
FENCED = r"^ *(`{3,}|~{3,}).*?^ *\1"
INDENTED = r"(?<=\n\n)(?: {4}[^\n]*\n)+"
WITHIN_LINE = r"(`+)(?!`)(?:(?!\n\n).)+?(?<!`)\2(?!`)"
NOT_PROSE = re.compile(f"{FENCED}|{INDENTED}|{WITHIN_LINE}|<!--.*?-->", re.S | re.M)
DELIMITER = re.compile(r"\\\\[()\[\]]")
CLOSED_BY = {r"\\(": r"\\)", r"\\[": r"\\]"}

# Patterns in the source of a formula, with their fault.
FAULTS = {
    r"(?<!\\)(?:\\\\)*\\(?![\\*_])[!-/:-@\[-`{-~]": "Markdown takes the backslash of {0}: write \\{0}",
    r"(?<!\\)(?:\\{4})*\\{2}(?=\s)": "two backslashes are seen as a blank: a new line is \\\\\\\\",
    r"(?<!\\)\*": "* marks emphasis: write \\*",
    r"(?<![\w\\])_": "_ after punctuation may mark emphasis: write \\_",
    r"<(?=[A-Za-z/!?])": "< before a letter begins an HTML tag: write a blank after it",
    r"\n *(?:[-+*]|\d+[.)]) ": "a line that begins like that of a list ends the formula: write the sign at the end of the line before",
    r"\n *[>#=]": "a line that begins with >, # or = ends the formula: write the sign at the end of the line before",
    r"`": "` marks code: formulas have none",
}
# Patterns in the prose between formulas, with their fault.
STRAY = {
    r"\\[A-Za-z]+": "{0} is outside of a formula",
    r"\\[()\[\]]": "{0} is no mark of a formula: write \\{0}",
    r"\$": "$ is no mark of a formula: write \\\\( and \\\\), or set it as code",
}


@dataclasses.dataclass(frozen=True)
class Formula:
    """A formula in the source, with the number of its first line."""

    line: int
    source: str

    @property
    def meant(self):
        """The formula that a reader's browser must receive."""
        return re.sub(r"\\([\\*_])", r"\1", self.source)


def read(text):
    """The formulas of a page and a list of faults, each "line: what is wrong"."""
    prose = NOT_PROSE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
    formulas, faults, between, end, opened = [], [], [], 0, None
    for mark in DELIMITER.finditer(prose):
        if opened is None and mark[0] in CLOSED_BY:
            between.append((end, prose[end : mark.start()]))
            opened = mark
        elif opened is not None and mark[0] == CLOSED_BY[opened[0]]:
            formulas.append(Formula(line_of(prose, opened.start()), prose[opened.end() : mark.start()]))
            opened, end = None, mark.end()
        else:
            faults.append(f"{line_of(prose, mark.start())}: {mark[0]} does not match")
    if opened is not None:
        faults.append(f"{line_of(prose, opened.start())}: {opened[0]} is not closed")
    between.append((end, prose[end:]))
    for formula in formulas:
        faults += found(FAULTS, formula.source, formula.line)
    for start, passage in between:
        faults += found(STRAY, passage, line_of(prose, start))
    return formulas, faults


def line_of(text, place):
    return text.count("\n", 0, place) + 1


def found(patterns, passage, first_line):
    """Faults of a passage that begins on a line."""
    for pattern, fault in patterns.items():
        for match in re.finditer(pattern, passage):
            yield f"{first_line + line_of(passage, match.start()) - 1}: {fault.format(match[0])}"
