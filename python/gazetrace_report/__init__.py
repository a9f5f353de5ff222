# SPDX-License-Identifier: Apache-2.0
"""Pages, diagrams and tables of what gazetrace has measured.

Pure Python over the files that the program writes: `results.json` of a sweep, and what `gazetrace gaze measure` says of
a recording. `gazetrace report` and `gazetrace gaze report` are its commands."""
