# SPDX-License-Identifier: Apache-2.0
"""What is done to the tasks of a farm while it runs, and what their attempts took."""

import json
import os
import re
import signal
import sys
from pathlib import Path

from gliding_job import processes_in

METER = Path(__file__).with_name("cpu_meter.py")


def renderers(folder, program):
    """The processes that render a chunk of the farm whose tasks work in this folder, by chunk."""
    program = os.path.realpath(program)
    return {int(re.match(rb"\d+", words[words.index(b"--chunk") + 1])[0]): process
            for process, words in processes_in(folder).items()
            if os.path.realpath(words[0].decode(errors="replace")) == program and words[1:2] == [b"render"] and b"--chunk" in words}


class Attempts:
    """Of a farm's tasks, by the words before its program (`farm --container`): how long each took, and where to hold it."""

    def __init__(self, path):
        self.path = Path(path)
        self.words = f"{sys.executable} {METER} {path}"

    def all(self):
        return [json.loads(line) for line in self.path.read_text().splitlines()] if self.path.exists() else []

    def seconds(self, word, is_whole):
        """Of the attempts with this word in their command, those that ended in order or those that did not."""
        return [attempt["cpu_s"] for attempt in self.all() if word in attempt["command"] and (attempt["code"] == 0) == is_whole]

    def hold(self, chunk, seconds):
        """The next attempt at this chunk stands still once it has run for so long, until it is told to end."""
        Path(f"{self.path}.held-{chunk}").unlink(missing_ok=True)
        Path(f"{self.path}.hold-{chunk}").write_text(str(seconds))

    def held(self):
        """Chunk -> process of the attempts that were made to stand still."""
        found = {}
        for path in self.path.parent.glob(f"{self.path.name}.held-*"):
            text = path.read_text()
            if text.endswith("\n"):
                found[int(path.name.rpartition("-")[2])] = int(text)
        return found


class Harm:
    """What is to be done to which chunks, once to each: fates, such as {3: "killed"}, and `done` so far."""

    def __init__(self, attempts, fates, seconds_of):
        self.attempts = attempts
        self.fates = fates
        self.done = {}
        for chunk in fates:
            attempts.hold(chunk, seconds_of())

    def __str__(self):
        return ", ".join(f"chunk {chunk} {what}" for chunk, what in sorted(self.done.items()))

    def is_over(self, *kinds):
        return all(chunk in self.done for chunk, fate in self.fates.items() if not kinds or fate in kinds)

    def harm(self, ways):
        """Does to each chunk that is held what it is to suffer. `ways`: fate -> what does it to (chunk, process), true once
        it is done."""
        for chunk, process in self.attempts.held().items():
            # Earlier harm may have left its marks.
            if chunk in self.fates and chunk not in self.done and ways[self.fates[chunk]](chunk, process):
                self.done[chunk] = self.fates[chunk]


def kill(_, process):
    """Ends a process without a word."""
    os.kill(process, signal.SIGKILL)
    return True
