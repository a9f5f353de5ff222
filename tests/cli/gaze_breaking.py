# SPDX-License-Identifier: Apache-2.0
"""Ways to break real gaze logs, each as a function from text to text. What is done is what happens to logs in practice:
a wrong unit in a header, an axis that grows the other way, a spreadsheet of another locale, rows out of order."""

import math
import random
import re


def lines_of(text):
    return text.split("\n")


def map_rows(text, is_row, change):
    return "\n".join(change(line) if is_row(line) else line for line in lines_of(text))


def begins_with_digit(line):
    return line[:1].isdigit()


def shuffled(text, is_row, seed=1):
    """Rows exchange their places, everything else stays in its line."""
    lines = lines_of(text)
    places = [i for i, line in enumerate(lines) if is_row(line)]
    order = places[:]
    random.Random(seed).shuffle(order)
    result = lines[:]
    for place, source in zip(places, order):
        result[place] = lines[source]
    return "\n".join(result)


def repeated(text, is_row, begin=200, count=150):
    """A block of rows stands twice, one after the other, as after a failed copy."""
    lines = lines_of(text)
    places = [i for i, line in enumerate(lines) if is_row(line)][begin:begin + count]
    assert len(places) == count
    end = places[-1] + 1
    return "\n".join(lines[:end] + [lines[i] for i in places] + lines[end:])


def cells_changed(text, is_row, separator, change):
    """`change` gets a row's cells and alters them in place."""

    def one(line):
        cells = line.split(separator)
        change(cells)
        return separator.join(cells)

    return map_rows(text, is_row, one)


def decimal_commas(text, is_row):
    return map_rows(text, is_row, lambda line: re.sub(r"(?<=\d)\.(?=\d)", ",", line))


def degrees(px, extent_px, extent_cm, distance_cm):
    """Angle from straight ahead of a place on a flat display, along one axis."""
    return math.degrees(math.atan((px / extent_px - 0.5) * extent_cm / distance_cm))
