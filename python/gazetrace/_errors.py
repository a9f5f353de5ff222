# SPDX-License-Identifier: Apache-2.0
"""What can go wrong, in the words of the library."""

from gazetrace_report.errors import Error

Error.__module__ = "gazetrace"  # as users see it; the reports have it without this package's compiled module


class GazetraceWarning(UserWarning):
    """What the program prints as a warning."""
