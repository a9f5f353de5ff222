# SPDX-License-Identifier: Apache-2.0
"""Columns by name: the parts of plans, timing and gaze logs."""

import difflib

import numpy as np


def flattened(item, prefix=""):
    """{"gaze": {"u": 1}, "at": [1, 2]} as {"gaze_u": 1, "at": [1, 2]}."""
    flat = {}
    for key, value in item.items():
        if isinstance(value, dict):
            flat.update(flattened(value, f"{prefix}{key}_"))
        else:
            flat[prefix + key] = value
    return flat


def as_array(values):
    """Numbers as numbers, truth as truth, text as text. None, where a number is missing, becomes NaN."""
    known = [value for value in values if value is not None]
    if known and all(isinstance(value, bool) for value in known):
        return np.array([bool(value) for value in values])
    if known and all(isinstance(value, list) for value in known):
        size = max(len(value) for value in known)
        missing = [None] * size
        rows = [as_array(missing if value is None else value).astype(float) for value in values]
        return np.stack(rows) if all(len(row) == size for row in rows) else np.array(values, dtype=object)
    if any(isinstance(value, str) for value in known):
        return np.array(["" if value is None else str(value) for value in values])
    if known and len(known) == len(values) and all(isinstance(value, int) for value in known):
        return np.array(values, dtype=np.int64)
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def unknown(what, name, known):
    """Words for a name that is not there."""
    near = difflib.get_close_matches(str(name), known, 1)
    return f"unknown {what} {name!r}; " + (f"did you mean {near[0]!r}? " if near else "") + f"Known: {', '.join(known)}"


def column_of(columns, name):
    if name not in columns:
        raise KeyError(unknown("column", name, list(columns)))
    return columns[name]


def columns_of(items):
    """The columns of a list of dictionaries, whose keys are those of any of them."""
    names = list(dict.fromkeys(name for item in items for name in item))
    return {name: as_array([item.get(name) for item in items]) for name in names}


def frame_of(columns):
    """A pandas.DataFrame; columns with several numbers a row become several columns."""
    import pandas

    table = {}
    for name, values in columns.items():
        if values.ndim == 1:
            table[name] = values
        else:
            for part, suffix in enumerate("xyzw"[: values.shape[1]] if values.shape[1] <= 4 else range(values.shape[1])):
                table[f"{name}_{suffix}"] = values[:, part]
    return pandas.DataFrame(table)
