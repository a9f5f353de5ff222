# SPDX-License-Identifier: Apache-2.0
"""Gaze logs as arrays."""

import os

import numpy as np

from . import _core
from ._columns import frame_of
from ._options import split


def read_gaze(path, **options):
    """Reads a gaze log of any known format.

    `options` are those of a job that say how a log is read (`gaze_format`, `gaze_sort`, `gaze_eye`, ...) and where the
    viewer sat (`screen`, `screen_px`, ...).
    """
    file, screen = split(options, _core.gaze_file_options(), _core.screen_options())
    return GazeLog(_core.read_gaze(os.fspath(path), file, screen))


class GazeLog:
    """A gaze log. The arrays `t_ns`, `u`, `v`, `direction`, `confidence`, `pupil` and `row` are the library's memory."""

    def __init__(self, core):
        self._core = core

    def __len__(self):
        return len(self._core)

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
        """What the log says has happened: fixations, saccades, blinks, messages."""
        return self._core.events()

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
