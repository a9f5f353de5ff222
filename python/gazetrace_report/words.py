# SPDX-License-Identifier: Apache-2.0
"""Numbers and names as pages and diagrams say them."""


def number(value, digits=4):
    """A value to so many digits, as it stands in tables, sentences and diagrams; a dash for none."""
    if value is None or value != value:
        return "–"
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-4 <= abs(value) < 1e7:
        text = f"{float(text):.0f}"
    return text


def interval(estimate):
    if estimate is None or estimate.low is None:
        return ""
    return f"{number(estimate.low)} to {number(estimate.high)}" if estimate.tells else "too few repeats for an interval"


def with_interval(estimate):
    if estimate is None:
        return "–"
    between = interval(estimate)
    return number(estimate.mean) + (f" ({between})" if between else "")


def count(value):
    if value is None:
        return "–"
    for unit in ("", " k", " M"):
        if abs(value) < 1000:
            return f"{number(value)}{unit}"
        value /= 1000
    return f"{number(value)} G"


def listed(items):
    items = list(items)
    return items[0] if len(items) == 1 else ", ".join(items[:-1]) + " and " + items[-1] if items else ""


def place(scene, gaze):
    return f"{scene}, gaze {gaze}" if gaze else scene


def part(name):
    if name in ("fovea", "periphery"):
        return f"the {name}"
    return {"intermediate": "the intermediate region", "whole": "the whole frame", "weighted": "the frame weighted by cortical magnification"}.get(
        name, f"{name} degrees")


def ordinal(n):
    """second, third, ... as in "every second of 4 frames"."""
    words = {2: "second", 3: "third", 4: "fourth", 5: "fifth", 8: "eighth"}
    return words.get(n, f"{n}th")
