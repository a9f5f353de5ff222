# SPDX-License-Identifier: Apache-2.0
"""The diagrams of a sweep: error against time, by eccentricity, and over video time; each with its numbers as a table."""

import re
from dataclasses import dataclass

import pandas
from matplotlib.lines import Line2D

from . import drawing, words
from .results import ROLES

EVENTS = {"fixation": "#7fb7a3", "in-flight": "#e0a458", "saccade": "#e0a458", "blink": "#9a86b8"}


@dataclass
class Diagram:
    kind: str  # "pareto", "bands" or "time"
    place: tuple
    metric: str
    row: str  # id of the test; empty for "pareto", which shows all of a scene and gaze
    title: str
    svg: str
    pdf: bytes | None
    numbers: pandas.DataFrame
    name: str = ""  # of its files


def draw_all(results, with_pdf=False):
    made = []
    for metric in results.metrics:
        for place in results.places:
            made.append(_pareto(results, place, metric, with_pdf))
        for test in results.tests:
            made += [_bands(results, test, metric, with_pdf), _over_time(results, test, metric, with_pdf)]
    made = [diagram for diagram in made if diagram]
    taken = set()
    for diagram in made:
        stem = "_".join(re.sub(r"[^A-Za-z0-9.-]", "-", part) for part in (diagram.kind, *((diagram.row,) if diagram.row else diagram.place), diagram.metric) if part)[:200]  # names of files end at 255
        diagram.name = next(name for name in (stem, *(f"{stem}-{n}" for n in range(2, 10000))) if name not in taken)
        taken.add(diagram.name)
    return made


def _title(place, more="", most=60):
    """What fits above the axes: a longer name would leave them no room."""
    name = words.place(*place)
    return (name if len(name + more) <= most else name[:most - len(more) - 1] + "…") + more


def _finish(fig, kind, place, metric, row, title, numbers, with_pdf):
    return Diagram(kind, place, metric.name, row, title, drawing.svg_of(fig, title), drawing.pdf_of(fig, title) if with_pdf else None, pandas.DataFrame(numbers))


def _shown(results, place):
    return [row for row in results.rows if row.place == place and row.role != "wrong-gaze"]


def _legend(axes, rows, below=0.19, lines=False):
    """The roles that are there, below the axes."""
    roles = [ROLES[name] for name in ROLES if any(row.role == name for row in rows)]
    handles = [Line2D([], [], color=role.color, marker=role.marker, linestyle=_line(role) if lines else "none", label=role.words) for role in roles]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(-0.1, -below), ncol=1 if len(roles) < 3 else 2, handlelength=2 if lines else 1, fontsize=7.5,
                columnspacing=0.8, borderaxespad=0)


def _line(role):
    return (0, role.dash) if role.dash[0] else "-"


def _span(estimates):
    """The range that a diagram shows: all means, and of the intervals what is not far beyond them."""
    means = [estimate.mean for estimate in estimates]
    low, high = min(means), max(means)
    room = max(0.5 * (high - low), 0.1 * abs(high))
    least = max(low / 2, low - room) if low >= 0 else low - room
    bounds = [(max(e.low, least), min(e.high, high + room)) for e in estimates if e.low is not None]
    return means + [value for pair in bounds for value in pair]


def _limits(axis, values, from_zero=False):
    drawing.scale_of(axis, values)
    low, high = min(values), max(values)
    if axis.get_scale() == "log":
        factor = (high / low) ** 0.09 if high > low else 1.3
        limits = low / factor, high * factor
    else:
        room = 0.09 * (high - low) or 0.1 * abs(high) or 1
        limits = 0 if from_zero and low >= 0 else low - room, high + room
    (axis.axes.set_ylim if axis.axis_name == "y" else axis.axes.set_xlim)(limits)


def _bars(axes, x, y, color):
    """The intervals of a point."""
    if x.low is not None:
        axes.plot([x.low, x.high], [y.mean, y.mean], color=color, lw=0.9, solid_capstyle="butt")
    if y.low is not None:
        axes.plot([x.mean, x.mean], [y.low, y.high], color=color, lw=0.9, solid_capstyle="butt")


def _fronts(results, place, metric):
    """Ids of each Pareto front that the sweep has found; each reference has its own, as scores against different ones do
    not compare."""
    name = "/".join(place)
    names = {name, *(f"{name}/{reference.get('key')}" for reference in results.references(place))}
    return [ids for key, ids in ((results.raw.get("pareto") or {}).get(metric.name) or {}).items() if key in names]


def _pareto(results, place, metric, with_pdf):
    points = [(row, row.estimate("time_s"), row.score(metric.name)) for row in _shown(results, place)]
    points = [point for point in points if point[1] and point[2]]
    if not points:
        return None
    title = f"{metric.name} against time, {words.place(*place)}"
    fronts = _fronts(results, place, metric)
    with drawing.figure(4.6, 3.9) as (fig, axes):
        axes.set_title(_title(place))
        _limits(axes.xaxis, _span([time for _, time, _ in points]))
        _limits(axes.yaxis, _span([score for *_, score in points]))
        axes.set_xlabel("time of a frame [s]")
        axes.set_ylabel(f"{metric.words}, {metric.better}")
        floors = [results.floor(reference, place[1], metric.name) for reference in results.references(place)]
        floors = [floor for floor in floors if floor is not None and axes.get_ylim()[0] < floor < axes.get_ylim()[1]]
        for floor in floors:
            axes.axhline(floor, color=drawing.INK, lw=0.8, ls=(0, (2, 4)))
        for ids in fronts:
            front = sorted((time.mean, score.mean) for row, time, score in points if row.id in ids)
            if len(front) > 1:
                axes.plot(*zip(*front), color="#0072b2", alpha=0.35, lw=3, zorder=1.5)
        for row, time, score in points:
            role = ROLES[row.role]
            _bars(axes, time, score, role.color)
            axes.plot([time.mean], [score.mean], role.marker, color=role.color, mfc=role.color if score.resolved else "none", ls="none")
        _legend(axes, [row for row, *_ in points])
        labels = drawing.Labels(fig, axes)
        for _, time, score in points:
            labels.keep_clear(time, score)
        for row, time, score in points:
            labels.put(time.mean, score.mean, row.short + ("" if score.resolved else ", unresolved"), ROLES[row.role].color, 8 if len(points) < 13 else 6.5)
        for floor in floors:
            labels.along(floor, "reference from itself")
        on_front = {name for ids in fronts for name in ids}
        numbers = [{"id": row.id, "role": row.role, "label": row.label, "time_s": time.mean, "time_s_low": time.low, "time_s_high": time.high, metric.name: score.mean,
                    "low": score.low, "high": score.high, "resolved": int(score.resolved), "front": int(row.id in on_front)} for row, time, score in points]
        return _finish(fig, "pareto", place, metric, "", title, numbers, with_pdf)


def _bands(results, test, metric, with_pdf):
    rows = [row for row in results.family(test) if row.role != "wrong-gaze"]
    parts = [part for part in results.parts if any(row.score(metric.name, part) for row in rows)]
    rows = [row for row in rows if any(row.score(metric.name, part) for part in parts)]
    if not rows:
        return None
    title = f"{metric.name} by eccentricity and region, {words.place(*test.place)}: {test.label}"
    bands = [part for part in parts if part in results.bands]
    with drawing.figure(4.6, 3.7) as (fig, axes):
        axes.set_title(_title(test.place, f": {test.short}"))
        _limits(axes.yaxis, _span([score for row in rows for part in parts if (score := row.score(metric.name, part))]))
        step = 0.7 / len(rows)
        for r, row in enumerate(rows):
            role = ROLES[row.role]
            for p, part in enumerate(parts):
                score = row.score(metric.name, part)
                if not score:
                    continue
                x = p + (r - (len(rows) - 1) / 2) * step
                if score.low is not None:
                    axes.plot([x, x], [score.low, score.high], color=role.color, lw=0.9)
                axes.plot([x], [score.mean], role.marker, color=role.color, mfc=role.color if score.resolved else "none", ls="none", ms=4.5)
        if 0 < len(bands) < len(parts):
            axes.axvline(len(bands) - 0.5, color="#8a8a8a", lw=0.8)
        axes.set_xlim(-0.6, len(parts) - 0.4)
        axes.set_xticks(range(len(parts)), [{"intermediate": "interm.", "periphery": "periph.", "weighted": "weight."}.get(part, part) for part in parts], fontsize=7.5,
                        rotation=0 if len(parts) < 8 else 30)
        axes.grid(False, axis="x")
        axes.set_xlabel("eccentricity [deg]; region")
        axes.set_ylabel(f"{metric.words}, {metric.better}")
        _legend(axes, rows, 0.22 if len(parts) < 8 else 0.31)
        numbers = [{"id": row.id, "role": row.role, "label": row.label, "part": part, metric.name: score.mean, "low": score.low, "high": score.high,
                    "resolved": int(score.resolved)} for row in rows for part in parts if (score := row.score(metric.name, part))]
        return _finish(fig, "bands", test.place, metric, test.id, title, numbers, with_pdf)


def _over_time(results, test, metric, with_pdf):
    """Of clips alone: one frame has no course."""
    rows = [row for row in results.family(test) if row.role != "wrong-gaze" and row.frames]
    if len(test.frames) < 2:
        return None
    numbers = [{"id": row.id, "role": row.role, "label": row.label, "frame": frame["index"], "t_s": frame.get("t_s"), "event": frame.get("event", "none"),
                "time_s": frame.get("time_s"), metric.name: (frame.get("scores") or {}).get(metric.name)} for row in rows for frame in row.frames]
    table = pandas.DataFrame(numbers)
    if table[["time_s", metric.name]].isna().all(axis=None):
        return None
    title = f"Speed and {metric.name} over time, {words.place(*test.place)}: {test.label}"
    with drawing.figure(4.6, 4.4, nrows=2, sharex=True) as (fig, (above, below)):
        fig.get_layout_engine().set(hspace=0.14)  # where the colors of the eye's strip are named
        above.set_title(_title(test.place, f": {test.short}"))
        for axes, key, label in ((above, "time_s", "time of a frame [s]"), (below, metric.name, f"{metric.words},\n{metric.better}")):  # one above the other in half the height
            known = table[key].dropna()
            if len(known):
                _limits(axes.yaxis, list(known), key == "time_s")
            for row in rows:
                role, own = ROLES[row.role], table[table.id == row.id]
                axes.plot(own.t_s, own[key].astype(float), color=role.color, ls=_line(role), marker=role.marker if len(own) <= 40 else None, ms=3.5, lw=1.2)
            axes.set_ylabel(label)
        below.set_xlabel("video time [s]")
        _strip(below, test.frames)
        _legend(below, rows, 0.36, True)
        return _finish(fig, "time", test.place, metric, test.id, title, numbers, with_pdf)


def _strip(axes, frames):
    """What the eye did, from the time of a frame to that of the next, along the lower edge."""
    times = [frame.get("t_s") or 0 for frame in frames]
    ends = times[1:] + [times[-1] + (times[-1] - times[-2])]
    named = []
    for begin, end, frame in zip(times, ends, frames):
        event = frame.get("event", "none")
        new = event not in named and event != "none"
        axes.axvspan(begin, end, 0, 0.045, color=EVENTS.get(event, "#bdbdbd"), lw=0, label=f"eye: {event}" if new else None)
        named.append(event)
    if set(named) - {"none"}:
        axes.add_artist(axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=4, fontsize=7, handlelength=1, borderaxespad=0.1, columnspacing=1))
