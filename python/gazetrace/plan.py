# SPDX-License-Identifier: Apache-2.0
"""Plans as arrays."""

import json

import numpy as np

from ._columns import column_of, columns_of, flattened, frame_of
from ._table import as_html, row_of
from .rendering import SamplingMap


class Plan:
    """What would be rendered, one row a frame.

    `plan.frame`, `plan.t_s`, `plan.u`, `plan.v` and `plan.valid` are arrays; `plan.columns` has everything that
    `gazetrace plan --json` prints, by the names that are there, such as "gaze_render_age_ns" or "camera_position_m".
    u and v are those of the gaze that steers, in fractions of the screen, and NaN where a frame has none; `valid` says
    where the log had gaze at that time.
    """

    def __init__(self, planned):
        self._core = planned
        items = [flattened(item) for item in json.loads(planned.json())["frames"]]
        self._rows = list(range(len(items)))
        self.columns = columns_of(items)
        self._samples = None

    def __len__(self):
        return len(self._rows)

    def __getitem__(self, key):
        """A column by its name, a row by its number as a dictionary, or the plan of a slice of the frames."""
        if isinstance(key, str):
            return column_of(self.columns, key)
        if isinstance(key, (int, np.integer)):
            return row_of(self.columns, key, len(self))
        part = object.__new__(Plan)
        part._core, part._rows = self._core, list(np.array(self._rows, dtype=int)[key])
        part.columns = {name: values[key] for name, values in self.columns.items()}
        part._samples = None if self._samples is None else self._samples[key]
        return part

    def __repr__(self):
        if not len(self):
            return "<Plan of no frame>"
        return f"<Plan of {len(self)} frames: {self.frame[0]} to {self.frame[-1]}, {100 * self.valid.mean():.3g} % with gaze>"

    def _repr_html_(self):
        names = ("frame", "t_s", "u", "v", "valid")
        return as_html({name: getattr(self, name) for name in names}, repr(self)[1:-1])

    @property
    def frame(self):
        return self.columns["frame"]

    @property
    def t_ns(self):
        """The middle of each frame in video time, in nanoseconds."""
        return self.columns["t_video_ns"]

    @property
    def t_s(self):
        return self.t_ns * 1e-9

    @property
    def u(self):
        return self._number("gaze_render_u")

    @property
    def v(self):
        return self._number("gaze_render_v")

    @property
    def valid(self):
        state = self.columns["gaze_render_state"]
        return np.isin(state, ["measured", "held"]) & ~self.columns["gaze_render_no_gaze"]

    @property
    def samples(self):
        """How many samples each frame takes; made from its sampling map. Raises where a pilot decides them."""
        if self._samples is None:
            self._samples = np.array(self._core.samples(), dtype=np.uint64)[self._rows]
        return self._samples

    def sampling_map(self, index):
        """The sampling map of the frame in this row."""
        if not -len(self) <= index < len(self):
            raise IndexError(f"there is no row {index}: there are {len(self)}")
        return SamplingMap(self._core.sampling_map(self._rows[index]))

    @property
    def decisions(self):
        """Decisions where the job left a choice, as pairs."""
        return self._core.decisions()

    @property
    def warnings(self):
        return self._core.warnings()

    def to_pandas(self):
        return frame_of(self.columns)

    def _number(self, name):
        return self.columns.get(name, np.full(len(self), np.nan))
