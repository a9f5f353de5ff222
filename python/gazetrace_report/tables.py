# SPDX-License-Identifier: Apache-2.0
"""Tables of a sweep, made by pandas, as HTML."""

import html
import re

import pandas

from . import findings, words
from .results import ROLES, Estimate

NUMBER = re.compile(r"([-<>~ ]*[\d.e+-]+( to [\d.e+-]+)?( ([kMGs%]|ms|deg|Hz))?|–|not known|)$")  # a cell of figures
FOLDED = 10  # rows of a long table that stand open


def cell(value):
    """Its markup: an estimate with its interval below it, a text escaped."""
    if isinstance(value, Estimate):
        small = words.interval(value) if value.resolved else "unresolved"
        return f'<span class="{"value" if value.resolved else "unresolved"}">{words.number(value.mean)}' + (f"<small>{small}</small>" if small else "") + "</span>"
    if isinstance(value, tuple):  # a text and what stands small below it
        return html.escape(value[0]) + (f"<small>{html.escape(value[1])}</small>" if value[1] else "")
    if value is None or isinstance(value, float):
        return words.number(value)
    return html.escape(str(value))


def table(frame, caption, classes=()):
    """The frame's first column heads its rows; names of columns may be a text and a small one. Texts stand to the left,
    numbers to the right."""
    sides = ["text" if len(frame) and isinstance(frame.iloc[0, i], str) and not NUMBER.match(frame.iloc[0, i]) else "value" for i in range(frame.shape[1])]
    parts = [f'<p class="caption">{html.escape(caption)}</p><div class="scroll" tabindex="0" role="region" aria-label="{html.escape(caption, True)}"><table>',
             "<thead><tr>", *(f'<th scope="col" class="{side}">{cell(name)}</th>' for name, side in zip(frame.columns, sides)), "</tr></thead><tbody>"]
    for i, row in enumerate(frame.itertuples(index=False, name=None)):
        kind = f' class="{classes[i]}"' if classes else ""
        parts.append(f'<tr{kind}><th scope="row">{cell(row[0])}</th>' + "".join(
            f'<td class="{side}">{cell(value)}</td>' for value, side in zip(row[1:], sides[1:])) + "</tr>")
    return "\n".join(parts) + "</tbody></table></div>\n"


def folded(frame, caption):
    """A long table: its first rows, and the others on request."""
    if len(frame) <= FOLDED + 2:
        return table(frame, caption)
    return (table(frame.head(FOLDED), caption) + f"<details><summary>{len(frame) - FOLDED} more</summary>\n" + table(frame.iloc[FOLDED:], caption + ", the others") +
            "</details>\n")


def _head(metric):
    return metric.words, metric.better


def runs(results, place):
    """Time, speed and scores of every run; what they cost stands in a table of its own."""
    rows = [row for row in results.rows_in_order(place) if row.role != "wrong-gaze"]  # those stand among the controls
    said = [(row.name, findings.beside(row)) for row in rows]
    frame = {"run": said, ("time", "s a frame"): [row.estimate("time_s") for row in rows], "speed-up": [row.estimate("speed_up") for row in rows]}
    for metric in results.metrics:
        frame[_head(metric)] = [row.score(metric.name) for row in rows]
    frame = pandas.DataFrame({i: pandas.Series(values, dtype=object) for i, values in enumerate(frame.values())}).set_axis(list(frame), axis=1)
    classes = [f"role-{row.role}" for row in rows]
    references = results.references(place)
    for reference in references:
        name = f"reference {reference['key']}" if len(references) > 1 else "reference"
        floors = [_floor(results, reference, place[1], metric.name) for metric in results.metrics]
        frame.loc[len(frame)] = [(f"{name} from itself", "floor"), "", "", *floors]
        classes.append("role-floor")
    return table(frame, words.place(*place), classes)


def _floor(results, reference, gaze, metric):
    value = results.floor(reference, gaze, metric)
    return "–" if value is None else Estimate(value)


def costs(results, place):
    rows = results.rows_in_order(place)
    frame = pandas.DataFrame({
        "run": [(row.name, ROLES[row.role].words) for row in rows],
        "samples a pixel": [words.number(row.raw.get("spp_mean")) for row in rows],
        "samples": [words.count(row.raw.get("samples")) for row in rows],
        "rays": [words.count(row.raw.get("rays")) for row in rows],
        "MiB": [words.number(row.raw.get("peak_mib")) for row in rows],
        "end-to-end": [words.number(row.raw.get("end_to_end")) for row in rows],
        "efficiency": [words.number(row.raw.get("efficiency")) for row in rows],
    }).set_axis(["run", "samples a pixel", "samples", "rays", ("peak", "MiB"), ("end-to-end", "with output"), "efficiency"], axis=1)
    return table(frame, f"Cost, {words.place(*place)}")


def bands(results, place):
    """Scores by eccentricity and region, a table for each metric."""
    rows, parts = results.rows_in_order(place), results.parts
    shares = (results.raw.get("band_pixel_share") or {}).get(place[1]) or []
    heads = [(part + (" deg" if part in results.bands else ""),
              f"{100 * share:.3g} % of pixels" if (share := dict(zip(results.bands, shares)).get(part)) is not None else "")
             for part in parts]
    made = ""
    for metric in results.metrics if rows else ():
        values = [[(row.name, ROLES[row.role].words), *(row.score(metric.name, part) for part in parts)] for row in rows]
        made += table(pandas.DataFrame(values, dtype=object).set_axis(["run", *heads], axis=1), f"{metric.words}, {metric.better}")
    return made


def published(results):
    rows = [(words.place(*row.place), row.name, row.estimate("speed_up"), words.number(other["speed_up"]), other["source"])
            for row in results.rows for other in row.raw.get("published") or []]
    return table(pandas.DataFrame(rows, columns=["scene and gaze", "run", "here", "published", "where"]), "Speed-up beside the published one") if rows else ""


def fixed_quality(results):
    rows = []
    for fixed in results.raw.get("fixed_quality") or []:
        bound = f"{fixed['bound']} " if fixed.get("bound") else ""
        rows.append((words.place(fixed.get("scene", ""), fixed.get("gaze", "")) + (f", {fixed['curve']}" if fixed.get("curve") else ""),
                     results.metric_words.get(fixed["metric"], fixed["metric"]),
                     words.number(fixed["at"]), bound + words.number(fixed["speed_up"]) if fixed.get("speed_up") is not None else "not known",
                     words.number(fixed.get("model_gain")), fixed.get("why") or ""))
    columns = ["scene and gaze", "metric", "at", "speed-up", "by the model", "why not"]
    return table(pandas.DataFrame(rows, columns=columns), "Speed-up at fixed quality") if rows else ""


def controls(results):
    rows = [(words.place(control.get("scene", ""), control.get("gaze", "")), _name_of(results, control.get("of")), results.metric_words.get(control["metric"], control["metric"]), control.get("wrong") or "", words.number(control.get("right_score")),
             words.number(control.get("wrong_score")), {"sensitive": "yes", "insensitive": "no: insensitive here", "undecided": "undecided"}[results.control_verdict(control)],
             control.get("why") or "") for control in results.raw.get("controls") or []]
    columns = ["scene and gaze", "foveated run", "metric", "gaze", "right", "wrong", "does the metric notice", "why"]
    caption = "The same settings rendered with a wrong gaze and scored with the right one"
    if not rows:
        return ""
    frame = _without_the_only(_without_the_only(pandas.DataFrame(rows, columns=columns), "scene and gaze"), "foveated run")
    reasons = [why for why in dict.fromkeys(frame["why"]) if why]
    if len(reasons) > 1:
        return folded(frame, caption)
    # What is the same for all is said once.
    said = f'<p class="small">Where it does not notice: {html.escape(reasons[0])}.</p>\n' if reasons else ""
    return folded(frame.drop(columns="why"), caption) + said


def _name_of(results, row):
    return results.by_id[row].name if row in results.by_id else ""


def _without_the_only(frame, column):
    """Without a column that says the same in each row."""
    return frame.drop(columns=column) if frame[column].nunique() == 1 else frame


def tally(compared):
    counts = findings.tally(compared)
    if counts.empty:
        return ""
    frame = counts.reset_index()
    frame["beside"] = [beside if i == 0 or beside != frame["beside"][i - 1] else "" for i, beside in enumerate(frame["beside"])]
    return table(frame.rename(columns={"beside": "beside", "metric": "metric"}), "How many foveated runs scored better or worse in whole frames, beside uniform sampling of the same cost")


def losses(compared):
    frame = findings.losses(compared)
    if frame.empty:
        return "<p>The intervals show no loss.</p>\n"
    return folded(_without_the_only(frame, "scene and gaze"), "Where uniform sampling of the same cost scored better")


def shares(results, place):
    """fixation 80 %, in-flight 20 %."""
    found = (results.raw.get("shares") or {}).get(place[1]) or {}
    return words.listed(f"{event} {100 * share:.3g} %" for event, share in found.items() if share > 0)
