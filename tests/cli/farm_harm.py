# SPDX-License-Identifier: Apache-2.0
"""What is done to the tasks of a farm while it runs, each chunk at most once, and what their attempts took."""

import json
import os
import re
import signal
import sys
from pathlib import Path

METER = Path(__file__).with_name("cpu_meter.py")


class Harm:
    def __init__(self, folder, program, random, chunks):
        self.folder = Path(os.path.realpath(folder))
        self.program = os.path.realpath(program).encode()
        self.random = random
        self.chunks = chunks
        self.done = {}  # chunk -> what was done to it

    def __str__(self):
        return ", ".join(f"chunk {chunk} {what}" for chunk, what in sorted(self.done.items()))

    def count(self, what=None):
        return sum(what in (None, one) for one in self.done.values())

    def renderers(self):
        """The processes that render a chunk of this farm, by chunk."""
        found = {}
        for entry in Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0") if entry.name.isdigit() else []
                if words[:2] == [self.program, b"render"] and b"--chunk" in words and \
                        os.readlink(entry / "cwd") == str(self.folder):
                    found[int(re.match(rb"\d+", words[words.index(b"--chunk") + 1])[0])] = int(entry.name)
            except (OSError, TypeError):
                continue
        return found

    def kill(self, only=None):
        """Ends one that renders without a word; nothing where all that run were harmed before."""
        running = {chunk: process for chunk, process in self.renderers().items()
                   if chunk not in self.done and only in (None, chunk)}
        if not running:
            return
        chunk = self.random.choice(sorted(running))
        try:
            os.kill(running[chunk], signal.SIGKILL)
            self.done[chunk] = "killed"
        except ProcessLookupError:
            pass


class CpuTimes:
    """Of every attempt of a farm, by the words before its program (`farm --container`)."""

    def __init__(self, path):
        self.path = Path(path)
        self.words = f"{sys.executable} {METER} {path}"

    def attempts(self):
        return [json.loads(line) for line in self.path.read_text().splitlines()] if self.path.exists() else []

    def seconds(self, stage, is_whole):
        """Of the attempts that trace (or finish), those that ended in order or those that did not."""
        return [attempt["cpu_s"] for attempt in self.attempts() if stage in attempt["command"] and (attempt["code"] == 0) == is_whole]
