# SPDX-License-Identifier: Apache-2.0
"""Comparing pictures and sequences: a test against its reference."""

import os
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np

from . import _core
from ._columns import columns_of, frame_of, unknown
from ._errors import Error
from ._options import as_texts, split
from ._table import as_html
from .rendering import Frame

_FIRST_METRICS = ["mse", "relmse", "psnr", "ssim", "flip"]


@dataclass
class _Shown:
    """A picture with its known properties."""

    number: int
    picture: object
    gaze_px: tuple | None = None
    gaze_class: str = "unclassified"
    exposure_ev: float | None = None


class _Arrays:
    """Frames, and arrays of the shape (height, width, 3), in order."""

    def __init__(self, pictures, what, linear):
        self.view = self.color = self.frames_per_second = self.regions = None
        self._pictures = iter([pictures] if isinstance(pictures, Frame) or _is_picture(pictures) else pictures)
        self._what = what
        self._linear = linear

    def __iter__(self):
        for number, one in enumerate(self._pictures, start=1):
            if isinstance(one, Frame):
                core = one._core
                self.view, self.color, self.frames_per_second = core.view, core.color, core.frames_per_second
                picture = _core.Picture(core.radiance, True, self._what)
                yield _Shown(one.frame, picture, core.gaze_px, core.gaze_class, one.exposure_ev)
            else:
                yield _Shown(number, _picture(one, self._what, self._linear))


class _Files:
    """The files of a pattern such as "out/frame.####.exr", or one file."""

    def __init__(self, pattern):
        self._pattern = pattern
        self._numbers = _core.find_frames(pattern)
        first = self._read(self._numbers[0])
        self._run = _core.recorded_run(pattern, first.settings_digest)
        width, height = first.size
        self.view = self._run.view(width, height) if self._run else None
        self.color = self._run.color() if self._run else None
        self.regions = self._run.regions if self._run else None
        self.frames_per_second = first.frames_per_second or (self._run.frames_per_second if self._run else None)

    def _read(self, number):
        return _core.read_picture(_core.frame_file_name(self._pattern, number))

    def __iter__(self):
        for number in self._numbers:
            picture = self._read(number)
            gaze_px, gaze_class = picture.gaze(self._run)
            yield _Shown(number, picture, gaze_px, gaze_class, picture.exposure_ev)


def _is_picture(pictures):
    return isinstance(pictures, np.ndarray) and pictures.ndim == 3


def _picture(array, what, linear):
    array = np.asarray(array)
    if array.dtype in (np.uint8, np.uint16):
        return _core.Picture(array / np.float32(np.iinfo(array.dtype).max), False, what)
    return _core.Picture(array, linear, what)


def _source(pictures, what, linear):
    if isinstance(pictures, (str, os.PathLike)):
        return _Files(os.fspath(pictures))
    return _Arrays(pictures, what, linear)


def _pairs(reference, test):
    for one, other in zip_longest(reference, test):
        if one is None or other is None:
            raise Error("reference and test have different numbers of frames", "input")
        if one.number != other.number:
            raise Error(f"the reference has frame {one.number} where the test has frame {other.number}", "input")
        if one.picture.size != other.picture.size:
            sizes = ["{}x{}".format(*shown.picture.size) for shown in (other, one)]
            raise Error(f"the test has {sizes[0]} pixels, the reference {sizes[1]}; compare pictures of one size", "input")
        if one.picture.is_linear != other.picture.is_linear:
            kinds = ["linear light" if shown.picture.is_linear else "a display image" for shown in (other, one)]
            raise Error(f"the test is {kinds[0]}, the reference {kinds[1]}; compare two of a kind", "input")
        yield one, other


def _is_files(pictures):
    return isinstance(pictures, (str, os.PathLike))


def _gaze_list(gaze):
    """Gaze in fractions of the frame as pairs; none where it is a log, or not given."""
    if gaze is None or _is_files(gaze):
        return []
    return [tuple(pair) if np.isfinite(pair).all() else None for pair in np.atleast_2d(np.asarray(gaze, dtype=float))]


def _gaze_at(gaze, index, size):
    """Gaze in fractions of the frame, one for all frames or one a frame, in pixels."""
    gaze = np.asarray(gaze, dtype=float)
    u, v = gaze if gaze.ndim == 1 else gaze[index]
    return (float(u) * size[0], float(v) * size[1]) if np.isfinite(u) and np.isfinite(v) else None


def compare(
    reference,
    test,
    *,
    metrics=None,
    gaze=None,
    fps=None,
    exposure=None,
    linear=True,
    display="",
    view="",
    regions=None,
    maps=False,
    threads=0,
    on_frame=None,
    **options,
):
    """Scores a test against its reference, as `gazetrace compare` does.

    Each of the two is a pattern of files ("out/frame.####.exr"), one file, an array of the shape (height, width, 3), a
    `Frame`, or an iterable of arrays or Frames, such as `job.render()`, of which only one at a time is in memory.
    Arrays of floats hold linear light or, where `linear` is false, code values from 0 to 1; arrays of 8 or 16 bits hold
    code values.

    What files and Frames know themselves (screen, gaze, exposure, frame rate, view) need not be given. `gaze` is a pair
    of fractions of the frame, or one pair a frame, NaN where there is none; between files also a gaze log. `options` are
    those of the screen (`screen`, `screen_px`, ...), of the metrics (`peak_cd_m2`, `relmse_epsilon`, ...) and of colour
    (`ocio`, ...); between files all those of `gazetrace compare`, which also refuses what it refuses: two that differ in
    frames, view, exposure or gaze, unless `anyway` is set.

    Without `metrics`: mse, relmse, psnr, ssim, flip and, where screen and gaze are known and time can be seen,
    fovvideovdp; between files flicker as well, where they show a second. `maps` keeps the error maps of every frame.
    Returns a `ComparisonResult`.
    """
    if _is_files(reference) and _is_files(test):
        given = {"metrics": metrics, "fps": fps, "exposure": exposure, "display": display or None, "view": view or None,
                 "region_eccentricities": regions,
                 "threads": threads, **options}
        if _is_files(gaze):
            given["gaze"] = gaze
        if _is_files(maps):
            given["maps"] = maps
        compared = _core.compare_files(
            os.fspath(reference), os.fspath(test), as_texts(_core.compare_options(), given),
            _gaze_list(gaze), maps is True, on_frame,
        )
        return ComparisonResult(**compared)
    metric_options, screen, color_options = split(
        options, _core.metric_options(), _core.screen_options(), _core.color_options()
    )
    one, other = _source(reference, "reference", linear), _source(test, "test", linear)
    comparison = None
    frames = []
    for index, (shown, shown_test) in enumerate(_pairs(one, other)):
        size = shown.picture.size
        gaze_px, gaze_class = shown.gaze_px, shown.gaze_class
        if gaze is not None:
            gaze_px = _gaze_at(gaze, index, size)
            gaze_class = "fixation" if gaze_px else "no-gaze"
        elif gaze_px is None and shown_test.gaze_px is not None:
            gaze_px, gaze_class = shown_test.gaze_px, shown_test.gaze_class
        if comparison is None:
            seen = _core.view_of_screen(screen, *size) or one.view or other.view
            rate = fps or one.frames_per_second or other.frames_per_second or 0
            is_sequence = _is_sequence(reference) or _is_sequence(test)
            names = metrics.split(",") if isinstance(metrics, str) else metrics
            chosen = list(names) if names is not None else _default_metrics(seen, gaze_px, is_sequence, rate)
            color = one.color or other.color
            if display or view or color_options or color is None:
                color = _core.color_pipeline(display, view, color_options)
            comparison = _core.Comparison(
                metrics=chosen,
                options=metric_options,
                view=seen,
                frames_per_second=float(rate) if is_sequence else 0.0,
                want_maps=maps,
                regions=regions or other.regions or one.regions,
                color=color,
                threads=threads,
            )
        stops = exposure if exposure is not None else shown.exposure_ev or 0.0
        scores = comparison.add(
            shown.number, shown.picture, shown_test.picture, stops, gaze_px, gaze_class
        )
        frames.append(scores)
        if on_frame is not None:
            on_frame(scores)
    if comparison is None:
        raise Error("there are no frames to compare", "input")
    return ComparisonResult(frames, comparison.summary())


def _is_sequence(pictures):
    if isinstance(pictures, (str, os.PathLike)):
        return _core.has_frame_number(os.fspath(pictures)) and len(_core.find_frames(os.fspath(pictures))) > 1
    return not (isinstance(pictures, Frame) or _is_picture(pictures))


def _default_metrics(view, gaze_px, is_sequence, rate):
    shows_time = rate > 4  # above it, two frames are within the 250 ms that FovVideoVDP sees
    if view is not None and gaze_px is not None and (not is_sequence or shows_time):
        return [*_FIRST_METRICS, "fovvideovdp"]
    return list(_FIRST_METRICS)


class ComparisonResult:
    """Scores for each frame (`frames`) and for the sequence (`summary`: all frames first, then what the eye did).

    `result["flip"]` is the number to quote: that of fixations where there are any, else that of all frames. Of files
    `conditions` says what the scores depend on, and `over_limits` which of `fail_above` and `fail_below` are not kept.
    """

    def __init__(self, frames, summary, conditions=(), over_limits=()):
        self.frames = frames
        self.summary = summary
        self.conditions = dict(conditions)
        self.over_limits = list(over_limits)

    @property
    def headline(self):
        return next((one for one in self.summary if one["gaze_class"] == "fixation"), self.summary[0])

    @property
    def metrics(self):
        return [scores["metric"] for scores in self.summary[0]["scores"]]

    def scores(self, metric):
        """Value, weighted value, bands, regions, quantiles and worst frame of a metric over the sequence."""
        for scores in self.headline["scores"]:
            if scores["metric"] == metric:
                return scores
        raise KeyError(unknown("metric", metric, self.metrics))

    def __getitem__(self, metric):
        return self.scores(metric)["value"]

    @property
    def columns(self):
        """One row a frame: its number, the eye movement, and the value of each metric, as arrays."""
        return columns_of(
            [
                {
                    "frame": one["frame"],
                    "gaze_class": one["gaze_class"],
                    **{scores["metric"]: scores["value"] for scores in one["scores"]},
                }
                for one in self.frames
            ]
        )

    def maps(self, metric):
        """The error maps of a metric, one a frame; `compare(..., maps=True)` keeps them."""
        return [one["maps"].get(metric) for one in self.frames]

    def to_pandas(self):
        return frame_of(self.columns)

    def __repr__(self):
        values = ", ".join(f"{metric}={'not known' if self[metric] is None else format(self[metric], '.4g')}" for metric in self.metrics)
        return f"<ComparisonResult of {len(self.frames)} frames: {values}>"

    def _repr_html_(self):
        return as_html(self.columns, repr(self)[1:-1])
