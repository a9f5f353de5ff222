# SPDX-License-Identifier: Apache-2.0
"""Values of options as the text that the library's schemas read. Nothing here knows a single option."""

import datetime
import numbers
import os

import numpy as np

from . import _core


def by_name(options):
    return {option["name"]: option for option in options}


def one_text(value):
    """A single value or a part of one: true, 0.5, "out/frame.####.exr"."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    raise TypeError(f"{value!r} is neither text, a number, a path, nor True or False")


def duration_text(value):
    """Seconds, or a timedelta, as the schemas read durations; texts such as "50ms" stay."""
    if isinstance(value, np.timedelta64):
        return f"{value / np.timedelta64(1, 'us'):.0f}us"
    if isinstance(value, datetime.timedelta):
        return f"{value // datetime.timedelta(microseconds=1)}us"
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        return f"{float(value):.9f}".rstrip("0").rstrip(".") + "s"
    return value


def texts_of(option, value):
    """The texts of a value; `option` is None for an option that the schema does not know, and will say so."""
    if option is not None and option["unit"] == "DURATION":
        value = duration_text(value)
    if isinstance(value, (bool, str, os.PathLike, numbers.Real)):
        return [one_text(value)]
    parts = [one_text(part) for part in value]
    if option is None or option["shape"] == "repeated":
        return parts
    # A size is written 1280x720; all other values of several parts have commas between them.
    return [("x" if option["unit"] == "WxH" else ",").join(parts)]


def as_texts(options, given):
    """Options as a dictionary of texts; those that are None are not given."""
    known = by_name(options)
    return {
        name: texts_of(known.get(name), value) for name, value in given.items() if value is not None
    }


def split(given, *schemas):
    """Divides options among schemas, for functions that take those of several."""
    shares = [{} for _ in schemas]
    names = [by_name(schema).keys() for schema in schemas]
    for name, value in given.items():
        owner = next((share for share, known in zip(shares, names) if name in known), None)
        if owner is None:
            _core.refuse_option(name, [one for known in names for one in known])
        owner[name] = value
    return [as_texts(schema, share) for schema, share in zip(schemas, shares)]
