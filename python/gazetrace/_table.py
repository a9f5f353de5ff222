# SPDX-License-Identifier: Apache-2.0
"""Tables of columns by name, and how they look in a notebook."""

import html

import numpy as np

from ._columns import column_of, frame_of, unknown

SHOWN = 8  # rows of a table in a notebook


def shown(value):
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def as_html(columns, title):
    """The first rows of columns."""
    names = list(columns)
    count = len(columns[names[0]]) if names else 0
    head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
    rows = "".join("<tr>" + "".join(f"<td>{html.escape(shown(columns[name][i]))}</td>" for name in names) + "</tr>" for i in range(min(count, SHOWN)))
    more = f"<p>and {count - SHOWN} more rows</p>" if count > SHOWN else ""
    return f"<p><b>{html.escape(title)}</b></p><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{more}"


def row_of(columns, index, count):
    """A row as a dictionary."""
    if not -count <= index < count:
        raise IndexError(f"there is no row {index}: there are {count}")
    return {name: values[index].item() if np.ndim(values[index]) == 0 and hasattr(values[index], "item") else values[index] for name, values in columns.items()}


class Table:
    """Columns by name: `table["u"]` or `table.u` is an array, `table[3]` a row as a dictionary, `table[2:5]` and
    `table[table.u < 0.5]` are tables of those rows; iterating gives the rows."""

    def __init__(self, columns):
        self.columns = columns

    def __len__(self):
        return len(next(iter(self.columns.values()))) if self.columns else 0

    def __iter__(self):
        return (self[i] for i in range(len(self)))

    def __getitem__(self, key):
        if isinstance(key, str):
            return column_of(self.columns, key)
        if isinstance(key, (int, np.integer)):
            return row_of(self.columns, key, len(self))
        return type(self)({name: values[key] for name, values in self.columns.items()})

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self.columns:
            raise AttributeError(unknown("column", name, [one for one in dir(self) if not one.startswith("_")]))
        return self.columns[name]

    def __dir__(self):
        return [*super().__dir__(), *self.columns]

    def to_pandas(self):
        return frame_of(self.columns)

    def __repr__(self):
        return f"<{type(self).__name__} of {len(self)} rows: {', '.join(self.columns)}>"

    def _repr_html_(self):
        return as_html(self.columns, f"{type(self).__name__} of {len(self)} rows")


class Events(Table):
    """What the eye did, one row an event, in the order of time: `movement`, `onset_s` and `offset_s` from the first sample
    on, `onset_ns` and `offset_ns` on the log's clock, `duration_ms`, the place `u`, `v` or `direction`, and of saccades
    `amplitude_deg` and `peak_velocity_deg_s`."""

    def of(self, movement):
        """The events of one movement: "fixation", "saccade", "microsaccade", "pursuit", "blink", "lost", ..."""
        return self[self.columns["movement"] == movement]

    @property
    def fixations(self):
        return self.of("fixation")

    @property
    def saccades(self):
        return self.of("saccade")

    @property
    def blinks(self):
        return self.of("blink")
