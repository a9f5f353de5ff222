# SPDX-License-Identifier: Apache-2.0
"""Gaze logs as arrays."""

import html
import json
import os
from pathlib import Path

import numpy as np

from . import _core
from ._columns import as_array, column_of, columns_of, flattened, frame_of
from ._errors import Error, warn
from ._options import split
from ._table import Events, Table, as_html

KINDS = {"screen": "gaze on a screen", "direction": "directions of gaze"}


def read_gaze(path, *, keep_ids=False, **options):
    """Reads a gaze log of any known format.

    `options` are those of `gazetrace gaze import` (`format`, `order`, `unit`, `gaze_eye`, ...) and where the viewer sat
    (`screen`, `screen_px`, ...). Texts of messages, which may name a person, are empty unless `keep_ids`.
    """
    file, screen = split(options, _core.gaze_file_options(), _core.screen_options())
    return GazeLog(_core.read_gaze(os.fspath(path), file, screen), keep_ids)


class GazeLog:
    """A gaze log. The arrays `t_ns`, `u`, `v`, `direction`, `confidence`, `pupil` and `row` are the library's memory.
    `log[100:200]` is the log of those samples, with the events and messages of their time."""

    def __init__(self, core, keep_ids=False):
        self._core = core
        self._keep_ids = keep_ids

    def __len__(self):
        return len(self._core)

    def __getitem__(self, key):
        if isinstance(key, str):
            return column_of(self.columns, key)
        if not isinstance(key, slice) or key.step not in (None, 1):
            raise TypeError("a log is cut by a slice without a step, such as log[100:200]; its arrays take any index")
        begin, end, _ = key.indices(len(self))
        if begin >= end:
            raise IndexError("no sample lies there")
        return GazeLog(self._core.part(begin, end), self._keep_ids)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._core, name)

    @property
    def t_s(self):
        """Time since the first sample, in seconds; t_ns has the log's own clock."""
        t_ns = self._core.t_ns
        return (t_ns - t_ns[:1]) * 1e-9

    @property
    def validity(self):
        """ok, off_screen, blink, lost, ... of each sample; `valid` says which of them can be used."""
        return np.array(self._core.validity())

    @property
    def eye(self):
        return np.array(self._core.eye())

    @property
    def events(self):
        """What the log says has happened, one row an event: fixations, saccades, blinks, blocks, messages. The texts of
        messages are empty unless the log was read with `keep_ids`."""
        rows = self._core.events()
        for row in rows:
            if row["type"] == "message" and not self._keep_ids:
                row["text"] = ""
        names = ("type", "eye", "begin_ns", "end_ns", "text", "row")
        return Table({name: as_array([row[name] for row in rows]) for name in names})

    def detect_events(self, method="auto", *, device=None):
        """Fixations, saccades and blinks by a published method, as `gazetrace gaze events` finds them: `Events`.

        `method` is a preset (`gazetrace list event-methods`), "auto", or "log" for the events that the log itself states.
        `device` is "desktop" or "head-mounted", where places or directions do not tell. Where the events are not to be relied
        on, a warning says why, and which methods or steps of `process()` suit the log better.
        """
        text, doubts = self._core.detected_events(method, device or "")
        warn(doubts)
        found = json.loads(text)
        columns = columns_of([flattened(event) for event in found["events"]])
        if not columns:
            columns = {name: np.array([]) for name in ("movement", "onset_ns", "offset_ns", "duration_ms")}
        first = self._core.t_ns[0] if len(self) else 0
        times = {f"{name}_s": (columns[f"{name}_ns"] - first) * 1e-9 for name in ("onset", "offset")}
        return Events({"movement": columns.pop("movement"), **times, **columns})

    def process(self, *steps):
        """The log after steps of the option `gaze_process`, such as "median:samples=5"."""
        return GazeLog(self._core.processed(list(steps)), self._keep_ids)

    @property
    def facts(self):
        """How the file was understood, and why."""
        return self._core.facts()

    @property
    def columns(self):
        names = ["t_ns", "t_s", "valid", "validity", "eye", "confidence", "pupil", "row"]
        names[2:2] = ["direction"] if self._core.kind == "direction" else ["u", "v"]
        return {name: getattr(self, name) for name in names}

    def to_pandas(self):
        return frame_of(self.columns)

    def __repr__(self):
        if not len(self):
            return f"<GazeLog {Path(self.source).name}: no sample>"
        seconds = self.t_s[-1]
        step = np.median(np.diff(self.t_ns)) if seconds > 0 else 0  # whatever pauses there are between blocks
        rate = f", {1e9 / step:.4g} Hz" if step > 0 else ""
        return (f"<GazeLog {Path(self.source).name}: {len(self)} samples of {KINDS.get(self.kind, 'gaze on a picture')} in {seconds:.4g} s{rate}, "
                f"{100 * self.valid.mean():.3g} % usable>")

    def _repr_html_(self):
        return as_html(self.columns, repr(self)[1:-1]) if len(self) else html.escape(repr(self))


def write_log(gaze, path):
    """A gaze log, or an array or table of gaze, as a file that the option `gaze` reads."""
    if isinstance(gaze, GazeLog):
        gaze._core.write(os.fspath(path))
        return
    t_ns, u, v = _columns_of_gaze(gaze)
    known = np.isfinite(u) & np.isfinite(v)
    _check(t_ns, u[known], v[known])
    with open(path, "w", encoding="utf-8") as file:
        file.write("# gazetrace-gaze 1\nt[ns],u[1],v[1],valid,eye\n")
        for row in zip(t_ns, u, v, known):
            file.write("{},{!r},{!r},{},cyclopean\n".format(int(row[0]), float(row[1]), float(row[2]), "ok" if row[3] else "lost"))


def _check(t_ns, u, v):
    back = np.flatnonzero(np.diff(t_ns) < 0)
    if len(back):
        raise Error(f"`gaze`: times go on from row to row, and row {back[0] + 1} is at {t_ns[back[0] + 1] * 1e-9:g} s after {t_ns[back[0]] * 1e-9:g} s; sort the rows")
    far = np.maximum(abs(u - 0.5), abs(v - 0.5)) > 1.5
    if far.mean() > 0.5 if len(far) else False:
        raise Error(f"`gaze`: u and v are fractions of the screen, 0 at its left and top and 1 at its right and bottom, and most of these lie far beside it, such as "
                    f"{u[far][0]:g}, {v[far][0]:g}; divide pixels by the size of the screen")


def _columns_of_gaze(gaze):
    """Times in nanoseconds and places in fractions of the screen; NaN where there is no gaze."""
    names = getattr(gaze, "columns", None) if not isinstance(gaze, dict) else gaze
    if names is not None:
        if not {"u", "v"} <= set(names) or not {"t_s", "t_ns"} & set(names):
            raise Error("`gaze`: a table of gaze has the columns t_s (or t_ns), u and v, in fractions of the screen")
        times = np.asarray(gaze["t_ns"]) if "t_ns" in set(names) else np.rint(np.asarray(gaze["t_s"], dtype=float) * 1e9)
        places = np.asarray(gaze["u"], dtype=float), np.asarray(gaze["v"], dtype=float)
        if "valid" in set(names):
            places = tuple(np.where(np.asarray(gaze["valid"], dtype=bool), place, np.nan) for place in places)
        return times, *places
    rows = np.asarray(gaze, dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 3 or not len(rows):
        raise Error("`gaze`: an array of gaze has three columns: time in seconds, u and v, in fractions of the screen")
    return np.rint(rows[:, 0] * 1e9), rows[:, 1], rows[:, 2]
