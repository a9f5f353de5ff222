# SPDX-License-Identifier: Apache-2.0
"""Rendering, frame by frame."""

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from . import _core
from ._columns import columns_of, frame_of
from ._errors import Error
from ._exr import write_exr
from ._png import png_of
from ._table import as_html


class Gaze(NamedTuple):
    """Where the eye was, in fractions of the screen from its top left corner; NaN without gaze."""

    u: float
    v: float
    valid: bool


def _gaze(item):
    state, missing = item["state"], item["no_gaze"]
    nan = float("nan")
    u, v = (nan if item.get(name) is None else item[name] for name in "uv")
    return Gaze(u, v, state in ("measured", "held") and not missing)


def _parsed(text):
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


_TIMING_COLUMNS = _core.timing_columns()


def _timing_row(text):
    return dict(zip(_TIMING_COLUMNS, map(_parsed, text.split(","))))


class SamplingMap:
    """Where the samples of a frame went: how many, and how they lie."""

    def __init__(self, core):
        self._core = core

    @property
    def region(self):
        """The region of each pixel, an index into `regions`."""
        return self._core.region

    @property
    def regions(self):
        """Name, block size, pixels, sites and samples of each region."""
        return self._core.regions

    @property
    def samples(self):
        """The number of samples of the whole frame."""
        return self._core.samples

    @property
    def samples_per_pixel(self):
        """Samples of the site that a pixel belongs to over its pixels."""
        return self._core.samples_per_pixel()

    @property
    def sites(self):
        """One entry for each site: its block, samples, pixels and region, as arrays by name."""
        return self._core.sites()

    def __repr__(self):
        return f"<SamplingMap {self._core.width}x{self._core.height}: {self.samples} samples in {len(self.regions)} regions>"

    def _repr_html_(self):
        return as_html(columns_of(self.regions), repr(self)[1:-1])


class Frame:
    """A rendered frame. Its arrays are the memory of the renderer, which lives as long as one of them does."""

    __slots__ = ("_core", "_request")

    def __init__(self, core):
        self._core = core
        self._request = None

    @property
    def request(self):
        """Everything that was planned for the frame, as `gazetrace plan --json` prints it."""
        if self._request is None:
            self._request = json.loads(self._core.request_json())["frames"][0]
        return self._request

    @property
    def frame(self):
        """The frame's number, from 1."""
        return self._core.frame

    @property
    def t_ns(self):
        """The middle of the frame in video time, in nanoseconds."""
        return self._core.t_video_ns

    @property
    def t_s(self):
        """The same in seconds."""
        return self.t_ns * 1e-9

    @property
    def gaze(self):
        """The gaze that steered the samples."""
        return _gaze(self.request["gaze_render"])

    @property
    def gaze_true(self):
        """The gaze of the unprocessed log at the frame's own time, which measurements use."""
        return _gaze(self.request.get("gaze_true", self.request["gaze_render"]))

    @property
    def radiance(self):
        """Linear light with Rec.709 primaries, (height, width, 3), before exposure."""
        return self._core.radiance

    @property
    def exposure_ev(self):
        """The exposure in stops; the view shows `radiance * 2**exposure_ev`."""
        return self._core.exposure_ev

    @property
    def samples(self):
        """Effective samples behind each pixel."""
        return self._core.samples

    @property
    def variance(self):
        """Of each pixel's mean luminance."""
        return self._core.variance

    @property
    def squared_error(self):
        """Estimate of the squared error of each pixel's luminance; None where the filter makes none."""
        return self._core.squared_error

    @property
    def eccentricity(self):
        """How far each pixel is from the gaze, in degrees; None without gaze."""
        return self._core.eccentricity()

    @property
    def aovs(self):
        """The further channels that there are, by the names of the option `aov`, which asks for first hits."""
        arrays = {
            "albedo": self._core.albedo,
            "normal": self._core.normal,
            "depth": self._core.depth,
            "samples": self._core.samples,
            "variance": self._core.variance,
            "eccentricity": self.eccentricity,
        }
        arrays.update({name: self._core.layer(name) for name in _core.aov_names() if name not in arrays})
        return {name: array for name, array in arrays.items() if array is not None}

    def matte(self, layer, name):
        """How much of each pixel something covers, by its name in a layer such as "crypto_object"."""
        return self._core.matte(layer, name)

    def matte_names(self, layer):
        """The names that matte() knows in a layer."""
        return list(json.loads(self._core.manifest(layer)))

    @property
    def sampling_map(self):
        return SamplingMap(self._core.sampling_map)

    @property
    def timing(self):
        """The frame's row of timing.csv, as a dictionary."""
        return _timing_row(self._core.timing_text())

    def display(self, bits=8):
        """The picture as a display shows it, through the job's view: (height, width, 3) with 8 or 16 bits."""
        return self._core.display(bits)

    def save(self, path, bits=8):
        """Writes the frame: .png as a display shows it, with 8 or 16 bits; .exr or .npy its radiance."""
        path = Path(path)
        if path.suffix == ".png":
            path.write_bytes(png_of(self.display(bits)))
        elif path.suffix == ".exr":
            write_exr(path, {name: self.radiance[..., c] for c, name in enumerate("RGB")})
        elif path.suffix == ".npy":
            np.save(path, self.radiance)
        else:
            raise Error(f"{path}: a frame is saved as .png, .exr or .npy")

    def _repr_png_(self):
        return png_of(self.display(8))

    def __array__(self, dtype=None, copy=None):
        radiance = self.radiance
        return np.array(radiance, dtype=dtype) if copy else np.asarray(radiance, dtype=dtype)

    def __repr__(self):
        return f"<Frame {self.frame}: {self._core.width}x{self._core.height}>"


class Rendering:
    """The frames of a job, in order; each is rendered when it is asked for.

    Nothing is rendered ahead, so that a frame's times are its own. Ctrl-C gives up the frame in hand and raises
    KeyboardInterrupt; leaving a `with` block or calling close() ends the sequence likewise. Either way the files that
    were finished stay, the run's record says that it was interrupted, and the job goes on with `resume=True`.
    """

    def __init__(self, core, keep=None):
        self._core = core
        self._keep = keep
        self._told = 0

    def __iter__(self):
        return self

    def __next__(self):
        core = self._core.next()
        if core is None:
            raise StopIteration
        return Frame(core)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Ends the sequence, in the middle of a frame if need be."""
        self._core.close()

    @property
    def frames(self):
        """The numbers of the frames that the job asks for."""
        return self._core.frames()

    @property
    def skipped(self):
        """Frames that `resume` found finished; they are not yielded. Known once the sequence has ended."""
        return self._core.skipped()

    @property
    def left(self):
        """Frames that an interrupted sequence left. Known once it has ended."""
        return self._core.left()

    @property
    def timing(self):
        """timing.csv as arrays by column, of the frames of this run. Known once the sequence has ended."""
        return columns_of([_timing_row(row) for row in self._core.timing()])

    @property
    def files(self):
        """Every file that the run writes."""
        return self._core.files()

    @property
    def view(self):
        """The view of display images."""
        return self._core.view()

    @property
    def decisions(self):
        return self._core.decisions()

    @property
    def warnings(self):
        return self._core.warnings()

    def timing_to_pandas(self):
        return frame_of(self.timing)
