# SPDX-License-Identifier: Apache-2.0
"""Offline foveated path tracing driven by recorded gaze.

A `Job` is what one run is asked to do. `Job.plan()` says what would be rendered, `Job.render()` renders it frame by
frame; `compare()` and the functions of `gazetrace.metrics` measure pictures; `read_gaze()` reads gaze logs; `sweep()`
measures many settings, and `report()` makes the page on them.
"""

from . import _build

try:
    from . import _core
except ImportError as problem:
    raise ImportError(
        f"{problem}; this gazetrace was built on {_build.distribution} and needs the libraries of that distribution: "
        "docs/python.md lists them"
    ) from problem

import numpy as _numpy

if int(_numpy.__version__.split(".")[0]) >= 2 and not _core.knows_numpy_2:
    raise ImportError(
        f"this gazetrace was built with a pybind11 that does not know NumPy {_numpy.__version__}; install a NumPy before 2, "
        "or build with pybind11 2.12 or newer, as `pip install .` does"
    )

from gazetrace_report import report
from gazetrace_report.results import Results

from . import metrics
from ._errors import Error, GazetraceWarning
from ._table import Events, Table
from .comparison import ComparisonResult, compare
from .gaze import GazeLog, read_gaze
from .job import Job, Scene, options, write_density
from .plan import Plan
from .rendering import Frame, Gaze, Rendering, SamplingMap
from .sweep import sweep

__version__ = _core.version
__all__ = [
    "ComparisonResult",
    "Error",
    "Events",
    "Frame",
    "Gaze",
    "GazeLog",
    "GazetraceWarning",
    "Job",
    "Plan",
    "Rendering",
    "Results",
    "SamplingMap",
    "Scene",
    "Table",
    "compare",
    "metrics",
    "options",
    "read_gaze",
    "report",
    "sweep",
    "write_density",
]
