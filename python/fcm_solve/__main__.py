"""`python -m fcm_solve COMMAND`."""

import sys

from .plots import command

USAGE = "usage: python -m fcm_solve plot FOLDER [PICTURE] [--by WHAT] [--only QUANTITY] [--format FORMAT] [--animate]"


def main(words):
    """Carries out a command and returns its exit status."""
    if words[:1] == ["plot"]:
        return command.main(words[1:], "python -m fcm_solve plot")
    is_help = words[:1] in (["-h"], ["--help"])
    print(
        USAGE if is_help else f"error: there is one command, plot\n{USAGE}", file=sys.stdout if is_help else sys.stderr
    )
    return 0 if is_help else 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
