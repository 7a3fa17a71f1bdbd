"""Compares version, addresses and the oldest Rust in everything that names them with Cargo.toml, the one place where they are set.

`python packaging/check.py --set` writes what Cargo.toml says into the other files."""

import argparse
import pathlib
import re
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]
# By file, patterns of which the group is to be a value of [workspace.package].
NAMED = {
    "CITATION.cff": {
        r"^version: (.*)$": "version",
        r'^repository-code: "(.*)"$': "repository",
        r'^url: "(.*)"$': "homepage",
    },
    "python/pyproject.toml": {
        r'^Homepage = "(.*)"$': "homepage",
        r'^Documentation = "(.*)"$': "documentation",
        r'^Repository = "(.*)"$': "repository",
        r'^Issues = "(.*)/issues"$': "repository",
    },
    "packaging/conda-forge/recipe.yaml": {
        r'^  version: "(.*)"$': "version",
        r"^  url: (.*)/releases/": "repository",
        r"^  homepage: (.*)$": "homepage",
        r"^  repository: (.*)$": "repository",
        r"^  documentation: (.*)$": "documentation",
    },
    "packaging/spack/package.py": {
        r'^    homepage = "(.*)"$': "homepage",
        r'^    url = "(.*)/releases/': "repository",
        r"/download/v(.*)/fcm-solve-": "version",
        r"/fcm-solve-(.*)-source": "version",
        r'^    git = "(.*)\.git"$': "repository",
        r'version\("(.*)", sha256': "version",
        r'"rust@(.*):"': "rust-version",
    },
    "packaging/easybuild/fcm-solve-0.2.0-foss-2024a.eb": {
        r"^version = '(.*)'$": "version",
        r"^homepage = '(.*)'$": "homepage",
        r"^source_urls = \['(.*)/releases/": "repository",
    },
    "packaging/apptainer/fcm-solve.def": {r"^From: rust:(.*)-bookworm$": "rust-version"},
    "Containerfile": {r"/rust:(.*)-bookworm": "rust-version"},
    ".github/ISSUE_TEMPLATE/config.yml": {r"url: (.*)/discussions": "repository"},
    "docs/src/support.md": {r"\((\S*)/discussions\)": "repository", r"\((\S*)/issues\)": "repository"},
    "SECURITY.md": {r"<(.*)>": "repository"},
}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--set", action="store_true", help="write what Cargo.toml says into the other files")
    is_set = parser.parse_args().set
    package = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]
    wrong = []
    for name, patterns in NAMED.items():
        text = (ROOT / name).read_text()
        for pattern, key in patterns.items():
            found = re.findall(pattern, text, re.MULTILINE)
            if not found:
                wrong.append(f"{name}: nothing matches {pattern}")
            wrong += [f"{name}: {value} is not the {key} of Cargo.toml, {package[key]}" for value in found if value != package[key]]
            if is_set:
                text = re.sub(pattern, lambda match: match[0].replace(match[1], package[key]), text, flags=re.MULTILINE)
        if is_set:
            (ROOT / name).write_text(text)
    if wrong and not is_set:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
