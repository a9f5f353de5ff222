# SPDX-License-Identifier: Apache-2.0
"""A run of the program: it renders by itself, and tells what it does in lines of JSON."""

import json
import queue
import subprocess
import threading
from dataclasses import dataclass, field
from pathlib import Path

# After this the program is ended without waiting for its frame; it then goes on from the frame before.
GRACE_S = 30.0
PREFIX = "gazetrace: error: "


@dataclass
class Progress:
    """What the program has told so far."""

    done: int = 0
    count: int = 0
    warnings: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)

    def share(self) -> float:
        """The part of the frames that is done, 0 to 1."""
        return self.done / self.count if self.count else 0.0

    def hear(self, line: str) -> None:
        """Takes a line of `--progress json`. Other lines are the program's words about what went wrong."""
        try:
            event = json.loads(line)
        except ValueError:
            event = None
        if not isinstance(event, dict):
            if line.strip():
                self.errors.append(line.strip().removeprefix(PREFIX))
            return
        self.count = event.get("count", self.count)
        if event.get("event") == "frame":
            self.done = event["done"]
        elif event.get("event") == "warning":
            self.warnings.append(event["text"])
        elif event.get("event") == "end" and "error" in event:
            self.errors.append(event["error"].removeprefix(PREFIX))


class Run:
    """A process that renders a job. `poll` never waits."""

    def __init__(self, program: str, settings_file: Path) -> None:
        self.progress = Progress()
        self._lines: queue.Queue[str] = queue.Queue()
        self._process = subprocess.Popen(
            [program, "render", "--config", settings_file.name, "--progress", "json"],
            cwd=settings_file.parent,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            stdin=subprocess.DEVNULL,
            text=True,
            encoding="utf-8",
            errors="replace",
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        with self._process.stderr as told:
            for line in told:
                self._lines.put(line)

    def _hear_all(self) -> None:
        while not self._lines.empty():
            self.progress.hear(self._lines.get())

    def poll(self) -> int | None:
        """Takes in what was told meanwhile; the exit code once the program has ended and everything is heard."""
        ended = self._process.poll() is not None and not self._reader.is_alive()
        self._hear_all()
        return self._process.returncode if ended else None

    def wait(self) -> int:
        """Waits for the end, and returns the exit code."""
        self._process.wait()
        self._reader.join()
        self._hear_all()
        return self._process.returncode

    def cancel(self) -> None:
        """Asks the program to end after its frame; finished frames stay."""
        if self._process.poll() is None:
            self._process.terminate()
            threading.Timer(GRACE_S, self._process.kill).start()
