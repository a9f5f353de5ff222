# SPDX-License-Identifier: Apache-2.0
"""What the commands share: one rule for --json, files that are written whole, and what can go wrong in one line on the
error stream, with the program's exit codes."""

import argparse
import contextlib
import json
import os
import sys
from pathlib import Path

from .errors import EXIT_CODES, Error

PACKAGES = {"matplotlib": "python3-matplotlib", "jinja2": "python3-jinja2", "pandas": "python3-pandas"}


class Parser(argparse.ArgumentParser):
    """What is wrong stands in one line, as the program's."""

    def __init__(self, prog, **more):
        super().__init__(prog=prog, allow_abbrev=False, **more)

    def error(self, message):
        raise Error(f"{message}; see '{self.prog} --help'")


def end(name, main, finds_itself=False):
    """Runs `main` with the command line's words and ends the process with its exit code. `finds_itself`: the program that was
    started finds this package in any Python, as what pip installs does not."""
    try:
        sys.exit(main(sys.argv[1:]))
    except Error as problem:
        print(f"gazetrace: error: {problem}", file=sys.stderr)
        sys.exit(EXIT_CODES[problem.kind])
    except ModuleNotFoundError as missing:
        if missing.name not in PACKAGES:
            raise
        if finds_itself:
            _try_the_systems_python()
        print(f"gazetrace: error: {name} needs {', '.join(PACKAGES)}: install them, {_how_to_install()}", file=sys.stderr)
        sys.exit(EXIT_CODES["runtime"])
    except KeyboardInterrupt:
        sys.exit(EXIT_CODES["interrupted"])
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _how_to_install():
    """A virtual environment does not see the distribution's packages."""
    if sys.prefix != sys.base_prefix:
        return f"with '{sys.executable} -m pip install {' '.join(PACKAGES)}'"
    return f"on Debian with 'apt-get install {' '.join(PACKAGES.values())}'"


def _try_the_systems_python():
    """Another Python that comes first on the PATH knows nothing of the distribution's packages."""
    system = "/usr/bin/python3"
    if os.access(system, os.X_OK) and not os.environ.get("GAZETRACE_REPORT_TRIED"):
        if os.path.realpath(sys.executable) != os.path.realpath(system) or sys.prefix != sys.base_prefix:
            os.execve(system, [system, *sys.argv], {**os.environ, "GAZETRACE_REPORT_TRIED": "1"})


def add_json_option(parser):
    parser.add_argument("--json", metavar="[FILE]", help="prints the result as JSON in place of the text, or writes it into FILE beside it")


def with_json_joined(words):
    """What follows --json is its file only where it looks like one. Behind -- are no options."""
    joined, rest = [], list(words)
    while rest and rest[0] != "--":
        word = rest.pop(0)
        if word == "--json":
            word = f"--json={rest.pop(0) if rest and (rest[0] == '-' or rest[0].endswith('.json')) else '-'}"
        joined.append(word)
    return joined + rest


def json_file(given, overwrite, read=()):
    """The file that --json names; None for none, or for stdout."""
    path = Path(given) if given not in (None, "-") else None
    if path:
        check_output(path, overwrite, read)
    return path


def say(text, result, given):
    """Prints a command's text, or its result as --json asks."""
    result = json.dumps(result, indent=2) + "\n"
    if given not in (None, "-"):
        write(Path(given), result)
    print(result if given == "-" else text, end="")


def check_output(path, overwrite, read=()):
    """`read`: files that are no output, whatever is overwritten."""
    if any(os.path.exists(path) and os.path.exists(other) and os.path.samefile(path, other) for other in read):
        raise Error(f"{path}: is the input of the report; name another file", "input")
    if path.exists() and not overwrite:
        raise Error(f"{path}: exists already; give --overwrite to replace it", "input")
    if path.is_dir():
        raise Error(f"{path}: is a folder; name a file")
    if path.exists() and not path.is_file():
        raise Error(f"{path}: is a device, pipe or socket, which no file replaces; name a file", "input")


def write(path, content):
    """Whole or not at all: the file takes its name when all of it is there."""
    data = content.encode() if isinstance(content, str) else content
    rest = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with open(rest, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(rest, path)
    except OSError as problem:
        with contextlib.suppress(OSError):
            rest.unlink()
        raise Error(f"{path}: cannot be written: {problem.strerror}", "runtime") from problem
