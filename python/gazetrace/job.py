# SPDX-License-Identifier: Apache-2.0
"""Jobs: descriptions of a run."""

import contextlib
import json
import os
import tempfile
import weakref
from pathlib import Path

import numpy as np

from . import _core
from ._errors import Error, warn
from ._exr import write_gray_exr
from ._options import by_name, texts_of
from .gaze import GazeLog, write_log
from .plan import Plan
from .rendering import Rendering

_OPTIONS = by_name(_core.job_options())

Scene = _core.Scene


def options():
    """Every option of a job: name, group, unit, help, shape and defaults, from the library's schema."""
    return _core.job_options()


class Job:
    """A job from a settings file, from options, or from both; options win.

    `Job("job.toml", size=(640, 360), gaze_start="2s")`: the names are those of the program's options with underscores,
    and the values are checked by the same definitions. A value of several parts may be a sequence, None stands for an
    option that is not given.

    `density` may be an array, too, which says where the samples of a frame go, in samples a pixel, or as relative rates
    where `spp` is given: of the shape (height, width), of any size, or a dictionary of such arrays by the numbers of
    frames.

    `gaze` may be a `GazeLog`, too, an array whose columns are time in seconds, u and v, or a table with the columns t_s
    (or t_ns), u, v and, where there is one, valid. Places are fractions of the screen, and NaN where there is no gaze.
    Both are written to temporary files. Durations are seconds, a timedelta, or text such as "50ms".
    """

    def __init__(self, path=None, /, *, density=None, gaze=None, **options):
        self._core = _core.Job()
        self._folders = []
        self._written = {}  # what stands in temporary files, for people
        if path is not None:
            self._core.add_file(os.fspath(path))
        self._set(options, density, gaze)

    @classmethod
    def from_toml(cls, text, path="settings"):
        """A job from the text of a settings file; `path` is its name in messages."""
        job = cls()
        job._core.add_toml(text, path)
        return job

    def replace(self, *, density=None, gaze=None, **options):
        """Another job, with these options on top."""
        other = Job()
        other._core = _core.Job(self._core)
        other._folders, other._written = list(self._folders), dict(self._written)
        other._set(options, density, gaze)
        return other

    def _set(self, options, density, gaze):
        if "density_map" in options and not isinstance(options["density_map"], (str, os.PathLike, type(None))):
            raise Error("`density_map` is now `density`, which takes names, files and arrays")
        given = [(name, texts_of(_OPTIONS.get(name), value)) for name, value in options.items() if value is not None]
        if density is not None:
            given.append(("density", [self._density_text(density)]))
        if gaze is not None:
            given.append(("gaze", [self._gaze_text(gaze)]))
        self._core.set(given)

    def _new_folder(self):
        self._folders.append(_TemporaryFolder())
        return self._folders[-1].path

    @contextlib.contextmanager
    def _in_its_words(self):
        """Messages name an array, and not the temporary file that it is written to."""
        try:
            yield
        except Error as problem:
            text = str(problem)
            for path in self._written:
                text = text.replace(path, f"`{'gaze' if Path(path).name == 'gaze.csv' else 'density'}`")
            if text == str(problem):
                raise
            raise Error(text, problem.kind) from None

    def _gaze_text(self, gaze):
        if isinstance(gaze, (str, os.PathLike)):
            return os.fspath(gaze)
        path = self._new_folder() / "gaze.csv"
        write_log(gaze, path)
        self._written[os.fspath(path)] = repr(gaze) if isinstance(gaze, GazeLog) else f"<gaze of {len(gaze['u'] if hasattr(gaze, 'keys') else gaze)} samples>"
        return os.fspath(path)

    def _density_text(self, density):
        if isinstance(density, (str, os.PathLike)):
            return os.fspath(density)
        folder = self._new_folder()
        self._written.update({os.fspath(folder / name): "<array>" for name in ("density.####.exr", "density.exr")})
        if isinstance(density, dict):
            for frame, array in density.items():
                write_gray_exr(folder / f"density.{int(frame):04d}.exr", array)
            return os.fspath(folder / "density.####.exr")
        write_gray_exr(folder / "density.exr", density)
        return os.fspath(folder / "density.exr")

    def __getitem__(self, name):
        """The value of an option as text; of one that may be given several times, a list; None where it is not set."""
        values = self._core.values(name)
        if _OPTIONS[name]["shape"] == "repeated":
            return values
        return values[0] if values else None

    def to_toml(self):
        """Every option with its value, as a settings file; reading it gives the same job."""
        return self._core.as_toml()

    def __repr__(self):
        given = {
            name: self[name] for name in _OPTIONS if self._core.values(name) != list(_OPTIONS[name]["defaults"])
        }
        words = {name: self._written.get(str(value)) or repr(value) for name, value in given.items() if value is not None}
        return f"Job({', '.join(f'{name}={value}' for name, value in words.items())})"

    def plan(self):
        """The plan of the run, made before the first ray: a `Plan`. Needs the scene only if the camera is in it."""
        with self._in_its_words():
            planned = _core.Planned(self._core)
        warn(planned.warnings())
        return Plan(planned)

    def outlines(self):
        """Where each object of the scene is seen in each frame, exact to the pixel: what `gazetrace gaze aois --outlines`
        writes, as a dictionary. docs/gaze.md says what is in it."""
        with self._in_its_words():
            text, warnings = _core.outlines(self._core)
        warn(warnings)
        return json.loads(text)

    def load_scene(self):
        """The job's scene with its environment, for `render(scene=...)` of several jobs that share it."""
        return _core.load_scene(self._core)

    def render(self, *, scene=None):
        """Renders the job: a `Rendering`, which yields a `Frame` for each frame when it is asked for.

        Whatever is wrong with the job is raised here, before the first ray. With `output`, `map` and the like the files
        of the program are written as well, with its checks, and NAME.timing.csv and NAME.run.json beside them; without,
        nothing is written.
        """
        with self._in_its_words():
            rendering = Rendering(_core.Rendering(self._core, scene), keep=self._folders)
        warn(rendering.warnings)
        return rendering

    def run(self, on_frame=None, *, scene=None):
        """Renders all frames, and calls `on_frame(frame)` with each; returns the `Rendering`, which has ended."""
        with self.render(scene=scene) as rendering:
            for frame in rendering:
                if on_frame is not None:
                    on_frame(frame)
        return rendering


class _TemporaryFolder:
    """A folder that lasts as long as the jobs and renderings that read from it."""

    def __init__(self):
        folder = tempfile.TemporaryDirectory(prefix="gazetrace.")
        self.path = Path(folder.name)
        self._finalizer = weakref.finalize(self, folder.cleanup)


def write_density(path, array):
    """Writes a density as an EXR that the option `density` reads, for runs that are to be repeatable."""
    write_gray_exr(Path(path), np.asarray(array))
