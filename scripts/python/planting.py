"""Many changes built into a crate at once: each is a branch of its function, selected by an environment variable."""

import collections
import re

# The active change is the one with the number in the environment, or none. It is read at the start of each function
# with changes, named by the first of them; this also records the functions that tests reach.
SWITCH = """
pub(crate) fn chosen_mutation(function: usize) -> usize {
    use std::sync::{OnceLock, atomic::{AtomicBool, Ordering::Relaxed}};
    static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];
    static CHOSEN: OnceLock<usize> = OnceLock::new();
    let name = |name: &str| std::env::var(name).ok();
    if !REACHED[function].load(Relaxed) && !REACHED[function].swap(true, Relaxed) {
        if let (Some(folder), Some(test)) = (name("MUTATIONS_REACHED"), name("NEXTEST_TEST_NAME")) {
            let _ = std::fs::write(format!("{folder}/{function} {test}"), "");
        }
    }
    *CHOSEN.get_or_init(|| name("MUTATION").map_or(0, |number| number.parse().unwrap()))
}
"""


def switch(changes):
    return SWITCH.replace("COUNT", str(max(changes) + 1))


class Planted:
    """A source with changes as branches, by their numbers."""

    def __init__(self, source, changes):
        self.text, self.at = "", 0
        # Changes by the lines of the text; lines that lead to the branches of a function have all of its changes.
        self.lines = collections.defaultdict(set)
        # The function of each change, by the number of its first one.
        self.functions = {}
        for (start, end), group in self.by_function(source, changes):
            body = self.body(source, start)
            self.add(source[self.at : body], set())
            self.functions |= dict.fromkeys(group, min(group))
            self.add(f"{{ match crate::chosen_mutation({min(group)}) {{\n", set(group))
            for number, change in group.items():
                changed = change.apply(source)
                self.add(f"{number} => {changed[body : end + len(changed) - len(source)]}\n", {number})
            self.add(f"_ => {source[body:end]}\n}} }}", set(group))
            self.at = end
        self.text += source[self.at :]

    def add(self, text, numbers):
        first = self.text.count("\n") + 1
        self.text += text
        if numbers:
            for line in range(first, self.text.count("\n") + 1):
                self.lines[line] |= numbers

    @staticmethod
    def by_function(source, changes):
        """Changes by their functions, in the order of these; excluding functions that contain others."""
        groups = collections.defaultdict(dict)
        for number, change in changes.items():
            if change.function:
                groups[tuple(change.offset(source, edge) for edge in change.function)][number] = change
        spans = sorted(groups)
        for start, end in spans:
            if not any(start < other < end for other, _ in spans):
                yield (start, end), groups[start, end]

    @staticmethod
    def body(source, start):
        """Start of the body of a function: the first brace outside of comments, parentheses and brackets."""
        depth = 0
        for place in re.finditer(r"//.*|[](){[]", source[start:]):
            if place[0] == "{" and depth == 0:
                return start + place.start()
            depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(place[0], 0)
        raise ValueError(f"no body of a function at {start}")


def plant(sources, changes):
    """The changed sources, by file, with the changes of each as branches."""
    files = collections.defaultdict(dict)
    for number, change in changes.items():
        files[change.file][number] = change
    return {file: Planted(sources[file], files[file]) for file in files}
