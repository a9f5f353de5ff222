# SPDX-License-Identifier: Apache-2.0
"""The diagrams of a recording: main sequence, histograms, where the eye was in each trial, and its course over time."""

from dataclasses import dataclass

import numpy
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from . import drawing, words
from .results import Estimate

LEFT, RIGHT, GAZE, GREEN = "#0072b2", "#d55e00", "#1c1c1c", "#009e73"
EVENTS = {"fixation": "#7fb7a3", "saccade": "#e0a458", "microsaccade": "#e0a458", "blink": "#9a86b8", "lost": "#c8463c", "pursuit": "#56b4e9"}
MOST_MARKS = 3000    # of a scatter plot; more are thinned
MOST_COLUMNS = 1200  # of a course; more samples are shown by the lowest and highest of each column
MOST_NUMBERED = 40   # fixations of a scanpath
COLUMNS = 240        # of the grid of a heat map


@dataclass
class Diagram:
    name: str  # of its files
    title: str
    svg: str
    section: str  # of the page: "events", "places" or "time"
    note: str = ""


@dataclass
class Recording:
    """What was measured, its tables, and what was seen."""

    numbers: dict
    events: object
    samples: object
    vergence: object = None
    picture: object = None  # pixels of a picture, or None
    heat_sigma_deg: float = 1

    def __post_init__(self):
        first = self.numbers["first_ns"]
        for table in (self.events, self.samples, self.vergence):
            if table is not None:
                for name in [name for name in table.columns if name.endswith("_ns")]:
                    table[name[:-2] + "s"] = (table[name] - first) * 1e-9

    def trials(self):
        """Name, begin and end in seconds of each trial; the whole recording where it has none."""
        trials = self.numbers["trials"]
        if len(trials) < 2:
            return [("", -numpy.inf, numpy.inf)]
        first = self.numbers["first_ns"]
        return [(f"trial {trial['number']}" + (f": {trial['name']}" if trial["name"] else ""), (trial["onset_ns"] - first) * 1e-9, (trial["offset_ns"] - first) * 1e-9)
                for trial in trials]


def draw_all(recording):
    made = [main_sequence(recording)]
    for movement, column, name, title, label, color in (("fixation", "duration_ms", "fixation_durations", "Durations of fixations", "duration [ms]", GREEN),
                                                        ("saccade", "amplitude_deg", "saccade_amplitudes", "Amplitudes of saccades", "amplitude [deg]", LEFT)):
        values = recording.events.loc[recording.events.movement == movement, column] if column in recording.events else []
        summary = recording.numbers["events"][movement]
        made.append(histogram(name, title, label, values, summary["duration_ms_median" if column == "duration_ms" else "amplitude_deg_median"], color))
    several = len(recording.trials()) > 1
    for number, (trial, begin, end) in enumerate(recording.trials(), 1):
        suffix = f"_trial_{number:03}" if several else ""
        made += [heat_map(recording, trial, begin, end, suffix), scanpath(recording, trial, begin, end, suffix)]
    return [diagram for diagram in made + courses(recording) if diagram]


def main_sequence(recording):
    saccades = recording.events[recording.events.movement.isin(["saccade", "microsaccade"])]
    measured = "amplitude_deg" in saccades and "peak_velocity_deg_s" in saccades
    saccades = saccades[(saccades.amplitude_deg > 0) & (saccades.peak_velocity_deg_s > 0)] if measured else saccades[:0]
    title = f"Main sequence of {len(saccades)} saccades"
    with drawing.figure(4.6, 3.4) as (fig, axes):
        axes.set(xscale="log", yscale="log", xlabel="amplitude [deg]", ylabel="peak velocity [deg/s]", title=title)
        shown = saccades[:: len(saccades) // MOST_MARKS + 1]
        for micro, color in ((False, LEFT), (True, GREEN)):
            some = shown[(shown.movement == "microsaccade") == micro]
            if len(some):
                axes.plot(some.amplitude_deg, some.peak_velocity_deg_s, "o", ms=3, alpha=0.55, mew=0, color=color)
        low, high = (min(1, saccades.amplitude_deg.min()), max(10, saccades.amplitude_deg.max())) if len(saccades) else (1, 10)
        amplitude = numpy.geomspace(low, high, 60)
        # As in synthetic gaze: 15/8 amplitude / duration, by the durations of the main sequence.
        axes.plot(amplitude, 1.875 * amplitude / (0.021 + 0.0022 * amplitude), "--", color="#8a8a8a", lw=1.2, label="expected (Carpenter 1988)")
        fit = recording.numbers["main_sequence"]
        if fit["factor"] is not None:
            axes.plot(amplitude, fit["factor"] * amplitude ** fit["exponent"], color=LEFT, lw=1,
                      label=f"fit: {fit['factor']:.0f} A^{fit['exponent']:.2f}, r = {fit['correlation']:.2f}")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_minor_locator(NullLocator())
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.legend(loc="lower right")
        return Diagram("main_sequence", title, drawing.svg_of(fig, title), "events")


def histogram(name, title, label, values, median, color):
    values = numpy.asarray(values, dtype=float)
    values = values[numpy.isfinite(values)]
    title = f"{title} ({len(values)})"
    with drawing.figure(4.6, 3.4) as (fig, axes):
        axes.set(xlabel=label, ylabel="share [%]", title=title)
        if len(values):
            most = numpy.quantile(values, 0.98, method="lower")
            most = 1.1 * (values.max() if len(values) < 20 or values.max() < 1.5 * most else most) or 1  # a single far one leaves no axis empty
            bins = numpy.linspace(0, most, 19)
            axes.hist(values, bins, weights=numpy.full(len(values), 100 / len(values)), color=color, alpha=0.8, rwidth=0.93)
            axes.axvline(median, color=drawing.INK, lw=1.1, ls=(0, (3, 3)))
            right = median < most / 2
            axes.annotate(f"median {words.number(median, 3)}", (median, 1), (5 if right else -5, -4), xycoords=("data", "axes fraction"), textcoords="offset points",
                          ha="left" if right else "right", va="top", fontsize=8)
            beyond = int((values > most).sum())
            if beyond:
                axes.annotate(f"{beyond} farther right", (1, 0), (0, 4), xycoords="axes fraction", textcoords="offset points", ha="right", fontsize=7.5)
        return Diagram(name, title, drawing.svg_of(fig, title), "events")


# Where the eye was ------------------------------------------------------------------------------------------------


def _fixations(recording, begin=-numpy.inf, end=numpy.inf):
    """Fixations with a place: fractions of the picture, or degrees."""
    events = recording.events
    fixations = events[(events.movement == "fixation") & (events.onset_s >= begin) & (events.onset_s <= end)].copy()
    if recording.numbers["kind"] == "direction":
        # Azimuths go on where a viewer turns past what lies behind: they are counted from the middle of all directions.
        middle = numpy.arctan2(events.dx[events.movement == "fixation"].mean(), -events.dz[events.movement == "fixation"].mean())
        azimuth = numpy.arctan2(fixations.dx, -fixations.dz)
        fixations["x"] = numpy.degrees(middle + numpy.remainder(azimuth - middle + numpy.pi, 2 * numpy.pi) - numpy.pi)
        fixations["y"] = numpy.degrees(numpy.arctan2(fixations.dy, numpy.hypot(fixations.dx, fixations.dz)))
    else:
        fixations["x"], fixations["y"] = (fixations["u"], fixations["v"]) if "u" in fixations else (numpy.nan, numpy.nan)
    return fixations.dropna(subset=["x", "y"])


def _directions(recording):
    """The azimuths and elevations that hold all fixations of the recording, so that its trials have the same axes."""
    fixations = _fixations(recording)
    ranges = []
    for values in (fixations.x, fixations.y):
        low, high = (values.min(), values.max()) if len(values) else (0, 0)
        room = max(5, 0.08 * (high - low))
        ranges.append((low - room, high + room))
    return ranges


def _shape(recording):
    """Height by width of the axes of what was looked at."""
    if recording.numbers["kind"] == "direction":
        (left, right), (low, high) = _directions(recording)
        return (high - low) / (right - left)
    return recording.numbers["picture"]["aspect"] if recording.numbers["picture"] else 1


def _plane(recording, axes):
    """Axes of what was looked at: the picture in percent of its sides, or degrees."""
    if recording.numbers["kind"] == "direction":
        across, up = _directions(recording)
        axes.set(xlim=across, ylim=up, aspect="equal", xlabel="azimuth [deg], right", ylabel="elevation [deg], up")
        return 1
    aspect = recording.numbers["picture"]["aspect"]
    seen = "screen" if recording.numbers["kind"] == "screen" else "picture"
    axes.set(xlim=(0, 1), ylim=(1, 0), aspect=aspect, xlabel=f"across the {seen} [%]", ylabel="down [%]")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:.0f}"))
    axes.set_xticks([0, 0.25, 0.5, 0.75, 1])
    axes.set_yticks([0, 0.25, 0.5, 0.75, 1])
    if recording.picture is not None:
        axes.imshow(recording.picture, extent=(0, 1, 1, 0), aspect=aspect, zorder=0, interpolation="nearest")
        axes.grid(False)
    return aspect


def heat(recording, fixations):
    """Seconds of fixation per square degree at each place of a grid over the picture, by a spot of `heat_sigma_deg`
    around each fixation; None where angles are not known."""
    screen = recording.numbers["picture"]
    if recording.numbers["kind"] != "screen" or "left" not in (screen or {}) or not len(fixations):
        return None
    rows = max(1, round(COLUMNS * screen["aspect"]))
    x = screen["left"] + (numpy.arange(COLUMNS) + 0.5) / COLUMNS * (screen["right"] - screen["left"])
    y = screen["top"] + (numpy.arange(rows) + 0.5) / rows * (screen["bottom"] - screen["top"])
    places = numpy.stack(numpy.broadcast_arrays(x[None, :], y[:, None], -1.0), -1)
    places /= numpy.linalg.norm(places, axis=-1, keepdims=True)
    values, sigma = numpy.zeros((rows, COLUMNS)), numpy.radians(recording.heat_sigma_deg)
    peak = 1 / (2 * numpy.pi * recording.heat_sigma_deg**2)
    for direction, seconds in zip(fixations[["dx", "dy", "dz"]].to_numpy(), fixations.duration_ms / 1000):
        # For small angles the square of the angle is that of the chord.
        squares = ((places - direction) ** 2).sum(-1) / sigma**2
        values += seconds * peak * numpy.exp(-0.5 * squares)
    return values


def heat_map(recording, trial, begin, end, suffix):
    fixations = _fixations(recording, begin, end)
    values = heat(recording, fixations)
    if values is None or not values.max() > 0:
        return None
    title = "Heat map" + (f", {trial}" if trial else "")
    with drawing.figure(4.6, 1.3 + 3.9 * min(recording.numbers["picture"]["aspect"], 1.2)) as (fig, axes):
        aspect = _plane(recording, axes)
        levels = values.copy()
        levels[levels < values.max() / 9] = numpy.nan
        drawn = axes.imshow(levels, extent=(0, 1, 1, 0), aspect=aspect, cmap="inferno", alpha=0.7 if recording.picture is not None else 0.9, vmin=0, vmax=values.max(),
                            zorder=1, interpolation="nearest")
        axes.set_title(title)
        fig.colorbar(drawn, ax=axes, label="fixation [s per square degree]", orientation="horizontal", fraction=0.06, pad=0.02)
        return Diagram("heat_map" + suffix, title, drawing.svg_of(fig, title), "places")


def scanpath(recording, trial, begin, end, suffix):
    fixations = _fixations(recording, begin, end)
    title = "Scanpath" + (f", {trial}" if trial else "")
    with drawing.figure(4.6, 0.6 + 3.9 * min(max(_shape(recording), 0.3), 1.2)) as (fig, axes):
        _plane(recording, axes)
        axes.set_title(title)
        on_picture = recording.picture is not None and recording.numbers["picture"]
        fill, line = ("#ffd34d", "#ffffff") if on_picture else ("#56b4e9", "#8a8a8a")
        seconds = fixations.duration_ms / 1000
        axes.plot(fixations.x, fixations.y, color=line, lw=0.8, alpha=0.8, zorder=2)
        radii = numpy.clip(11 * numpy.sqrt(seconds), 2.5, 20)  # points
        axes.scatter(fixations.x, fixations.y, (2 * radii) ** 2, color=fill, alpha=0.55, lw=0.6, edgecolor="#0a3d62", zorder=3)
        note = f"{len(fixations)} fixations, area by duration"
        if 0 < len(fixations) <= MOST_NUMBERED:
            labels = drawing.Labels(fig, axes)
            for x, y, radius in zip(fixations.x, fixations.y, radii):
                labels.keep_clear(Estimate(x), Estimate(y), radius)
            for number, (x, y, radius) in enumerate(zip(fixations.x, fixations.y, radii), 1):
                labels.put(x, y, str(number), drawing.INK if not on_picture else "#ffffff", 7, radius)
            note += ", numbered in their order"
        if recording.numbers["picture"]:
            beside = int(((fixations.x < 0) | (fixations.x > 1) | (fixations.y < 0) | (fixations.y > 1)).sum())
            note += f"; {beside} beside it are not shown" if beside else ""
        return Diagram("scanpath" + suffix, title, drawing.svg_of(fig, title), "places", note + ".")


# Over time --------------------------------------------------------------------------------------------------------


def thinned(seconds, values, size):
    """The lowest and highest of each `size` values, so that no excursion is lost."""
    padded = numpy.append(values, numpy.full(-len(values) % size, numpy.nan)).reshape(-1, size)
    known = numpy.isfinite(padded)
    some = known.any(1)
    low = numpy.where(some, numpy.where(known, padded, numpy.inf).min(1), numpy.nan)
    high = numpy.where(some, numpy.where(known, padded, -numpy.inf).max(1), numpy.nan)
    return numpy.repeat(seconds[::size], 2), numpy.stack([low, high], 1).ravel()


def course(seconds, values):
    """Times and values of a line: it ends where samples are missing, and is thinned between such gaps."""
    gap = 3 * numpy.median(numpy.diff(seconds))
    ends = numpy.flatnonzero(numpy.diff(seconds) > gap) + 1
    parts = zip(numpy.split(seconds, ends), numpy.split(numpy.asarray(values, float), ends))
    if len(values) > 2 * MOST_COLUMNS:
        size = -(-len(values) // MOST_COLUMNS)
        parts = (thinned(*part, size) for part in parts)
    times, values = zip(*((numpy.append(t, t[-1]), numpy.append(v, numpy.nan)) for t, v in parts))
    return numpy.concatenate(times)[:-1], numpy.concatenate(values)[:-1]


def courses(recording):
    numbers, samples = recording.numbers, recording.samples
    both = "left_x" in samples
    eyes = (("left eye", "left_", LEFT), ("right eye", "right_", RIGHT)) if both else (("gaze", "", GAZE),)
    unit = numbers["plane_unit"]
    upwards = "up" if unit == "deg" else "as in the log"
    pupil = numbers["pupil_unit"] or "unit not stated"
    made = []
    for name, title, label, column in (("x_over_time", "Horizontal position", f"x [{unit}], right", "x"), ("y_over_time", "Vertical position", f"y [{unit}], {upwards}", "y")):
        made.append(_course(recording, name, title, label, [(eye, samples[prefix + column], color) for eye, prefix, color in eyes], name.startswith("x")))
    if both and recording.vergence is not None:
        kind = "deg" if "horizontal_deg" in recording.vergence else "share_or_px"
        made.append(_course(recording, "disparity_over_time", "Disparity: left eye less right eye", f"disparity [{unit}]",
                            [("horizontal", recording.vergence[f"horizontal_{kind}"], GAZE), ("vertical", recording.vergence[f"vertical_{kind}"], GREEN)]))
        vergence = numbers["vergence"]
        if vergence.get("missing"):
            if made[-1]:
                made[-1].note = "No vergence: " + vergence["missing"].replace("`", "")
        else:
            made.append(_course(recording, "vergence_over_time", "Vergence: angle between the lines of sight", "vergence [deg]",
                                [("vergence", recording.vergence.vergence_deg, GAZE)]))
            if made[-1]:
                distance = vergence["pupil_distance_mm"]
                made[-1].note = (f"Pupils {distance:.1f} mm apart, {'as stated' if vergence['pupil_distance_is'] == 'stated' else 'by the log'}." if distance
                                 else "Of the directions of the eyes.")
    made.append(_course(recording, "pupil_over_time", f"Pupil size [{pupil}]", f"pupil [{pupil}]", [(eye, samples[prefix + "pupil"], color) for eye, prefix, color in eyes]))
    return [one for one in made if one]


def _course(recording, name, title, label, lines, with_events=False):
    seconds = recording.samples.t_s.to_numpy()
    known = numpy.concatenate([numpy.asarray(values, float)[numpy.isfinite(values)] for _, values, _ in lines])
    if not len(known) or len(seconds) < 2:
        return None
    # The outermost values in a thousand are noise at the edges of losses more often than gaze.
    low, high = numpy.quantile(known, [0.001, 0.999])
    room = max(0.06 * (high - low), 1e-3 * max(abs(high), 1e-6))
    with drawing.figure(5.8, 2.1) as (fig, axes):
        axes.set(xlabel="time [s]", ylabel=label, ylim=(low - room, high + room), xlim=(seconds[0], max(seconds[-1], seconds[0] + 1e-3)), title=title)
        for line, values, color in lines:
            axes.plot(*course(seconds, values), color=color, lw=0.7, label=line)
        if with_events:
            _shade(axes, recording)
        if len(lines) > 1:
            axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=2, borderaxespad=0.2)  # in the line of the title, clear of the course
        return Diagram(name, title, drawing.svg_of(fig, title), "time", ("Shaded: no usable gaze." + (" Dotted: where trials begin." if len(recording.trials()) > 1 else "")) if with_events else "")


def _shade(axes, recording):
    """Where there is no usable gaze, and where trials begin."""
    span = numpy.diff(axes.get_xlim())[0]
    for movement in ("lost", "blink"):
        lost = recording.events[recording.events.movement == movement]
        lost = lost[(lost.offset_s - lost.onset_s) > span / 3000]
        axes.broken_barh(list(zip(lost.onset_s, lost.offset_s - lost.onset_s)), (0, 1), transform=axes.get_xaxis_transform(), color=EVENTS[movement], alpha=0.25, lw=0)
    for trial, begin, _ in recording.trials():
        if trial:
            axes.axvline(begin, color="#8a8a8a", lw=0.8, ls=(0, (1, 2)))
