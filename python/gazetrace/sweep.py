# SPDX-License-Identifier: Apache-2.0
"""Sweeps: many settings against one reference."""

import os
from pathlib import Path

from gazetrace_report.results import Results

from . import _core
from ._errors import warn
from ._options import texts_of
from .job import _OPTIONS


def sweep(plan, output=None, *, frames=None, threads=None, restart=False, tell=None):
    """Measures what a plan asks for, as `gazetrace sweep` does, and returns its `Results`; `gazetrace.report()` makes
    the page.

    `plan` is a TOML file (docs/sweep-and-report.md). `output` is the folder of results and pictures, by default the
    plan's name with .sweep; what it holds of the same plan is kept, so that a sweep goes on where it was ended, unless
    `restart`. `frames` and `threads` replace those of the plan. `tell(line)` is called with what is being done, such as
    `print`. Ctrl-C ends it, within about a second.
    """
    plan = Path(plan)
    output = Path(output) if output is not None else Path(plan.stem + ".sweep")
    frames = None if frames is None else texts_of(_OPTIONS["frames"], frames)[0]
    warn(_core.sweep(os.fspath(plan), os.fspath(output), frames, threads, restart, tell))
    return Results(output)
