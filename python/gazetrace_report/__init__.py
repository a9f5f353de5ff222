# SPDX-License-Identifier: Apache-2.0
"""Pages, diagrams and tables of what gazetrace has measured.

Pure Python over the files that the program writes: `results.json` of a sweep, and what `gazetrace gaze measure` says of
a recording. `gazetrace report` and `gazetrace gaze report` are its commands; `report()` is the first in Python."""

import warnings
from pathlib import Path


def report(results, output=None, *, plots=None, max_mib=5):
    """Makes the page on a sweep, of its `Results`, results.json or folder, and returns where it is; replaces one that is there.

    `plots` is a folder for the diagrams, as SVG and PDF with their numbers."""
    from .sweep_command import make
    from .results import Results
    read = results if isinstance(results, Results) else Results(results)
    path = Path(output) if output else read.folder / "report.html"
    for warning in make(read, path, Path(plots) if plots else None, max_mib)[1]:
        warnings.warn(warning, stacklevel=2)
    return path
