# SPDX-License-Identifier: Apache-2.0
"""The page on a recording: one file that loads nothing."""

import html
import re

import pandas

from . import drawing, tables, words
from .sweep_page import templates

MOST_TRIALS = 12  # that the page shows; the diagrams of others are written by --parts


def known(value, unit="", digits=3):
    return "not known" if value is None else words.number(value, digits) + (f" {unit}" if unit else "")


def loss(q):
    return known(None if q["data_loss"] is None else 100 * q["data_loss"], "%")


def quality(numbers):
    rows = {
        "Sampling rate": lambda q: known(q["sampling_rate_hz"], "Hz", 4),
        "Effective rate": lambda q: known(q["effective_rate_hz"], "Hz", 4),
        "Data loss": loss,
        "Accuracy, mean": lambda q: known(q["accuracy_deg"], "deg"),
        "Accuracy, worst": lambda q: known(q["accuracy_max_deg"], "deg"),
        "Precision, RMS-S2S": lambda q: known(q["precision_rms_s2s"], q["precision_unit"]),
        "Precision, SD": lambda q: known(q["precision_sd"], q["precision_unit"]),
        "Recorded": lambda q: known(q["duration_s"], "s", 5),
        "Samples": lambda q: str(q["samples"]),
    }
    frame = pandas.DataFrame([[name, *(value(q) for q in numbers["quality"])] for name, value in rows.items()], columns=["", *(q["of"] for q in numbers["quality"])])
    return tables.table(frame, "Quality of the data")


def events(numbers):
    rows = []
    for movement, of in numbers["events"].items():
        if of["count"] and movement != "unclassified":
            amplitude = of["amplitude_deg_median"]
            rows.append((movement, of["count"], f"{of['duration_ms_median']:.0f} ms", f"{of['duration_ms_q1']:.0f} to {of['duration_ms_q3']:.0f} ms",
                         "" if amplitude is None else f"{amplitude:.2f} deg"))
    frame = pandas.DataFrame(rows, columns=["", "count", "median duration", "middle half", "median amplitude"])
    return tables.table(frame, f"Events by {numbers['method']}") if rows else "<p>No event was found.</p>\n"


def with_options(text):
    """A warning as markup: options, which no line may break."""
    return re.sub(r"(?<!\S)--[a-z][a-z-]*", r"<code>\g<0></code>", html.escape(text.replace("`", "")))


def make(numbers, diagrams):
    name = numbers["source"] + (f", trial {numbers['trial']}" if numbers.get("trial") else "")
    trials = len(numbers["trials"]) if len(numbers["trials"]) > 1 else 0
    shown = [one for one in diagrams if one.section != "places" or not trials or int(one.name.rsplit("_", 1)[1]) <= MOST_TRIALS]
    figures = {"events": [], "places": [], "time": []}
    for n, one in enumerate(shown):
        figures[one.section].append({"svg": drawing.in_page(one.svg, one.title, n), "note": one.note, "title": one.title})
    warnings = [text.split(": ", 1)[1] if text.startswith(f"{numbers['source']}: ") or f"/{numbers['source']}: " in text else text for text in numbers["warnings"]]
    q = numbers["quality"][0]
    facts = f"{q['samples']} samples in {words.number(q['duration_s'], 5)} s, {numbers['events']['fixation']['count']} fixations, data loss {loss(q)}"
    return templates().get_template("gaze.html").render(
        title=f"Gaze: {name}", facts=facts, warnings=[with_options(text) for text in warnings], quality=quality(numbers), events=events(numbers), figures=figures,
        trials=trials, most_trials=MOST_TRIALS, method=numbers["method_words"].replace("`", ""), program=numbers["program"])
