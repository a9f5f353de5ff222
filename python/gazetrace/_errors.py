# SPDX-License-Identifier: Apache-2.0
"""Errors, with the messages of the library."""

import warnings

from gazetrace_report.errors import Error

Error.__module__ = "gazetrace"  # as users see it; the reports have it without this package's compiled module


class GazetraceWarning(UserWarning):
    """A warning, as the program prints it."""


def warn(texts):
    """One warning of all that is to be said, where a method of the package was called."""
    if texts:
        warnings.warn("\n".join(texts), GazetraceWarning, stacklevel=3)
