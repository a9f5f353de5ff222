# SPDX-License-Identifier: Apache-2.0
"""python -m gazetrace_report sweep|gaze WORDS..."""

import sys

from .command_line import end
from .errors import Error


def sweep(finds_itself=False):
    from .sweep_command import main
    end("gazetrace report", main, finds_itself)


def gaze(finds_itself=False):
    from .gaze_command import main
    end("gazetrace gaze report", main, finds_itself)


def iohub(finds_itself=False):
    from .iohub_command import main
    end("gazetrace gaze iohub", main, finds_itself)


def import_scene(finds_itself=False):
    from .import_command import main
    end("gazetrace import", main, finds_itself)


def which(words):
    commands = {"sweep": sweep, "gaze": gaze}
    if not words or words[0] not in commands:
        raise Error("name the report: sweep or gaze")
    del sys.argv[1]
    commands[words[0]]()


if __name__ == "__main__":
    end("gazetrace_report", which)
