# SPDX-License-Identifier: Apache-2.0
"""Scenes, pictures and other files as people have them, each with the right result: a table of case, right, got.

`python3 field_cases_test.py --table [KIND...]` prints the table, of some kinds alone. Each module of field_cases/ is a kind.
Each of its functions without a leading underscore is a case: its docstring tells the right result, and it takes the bench
below and returns whether that is what it got, and what it got.
"""

import importlib
import math
import sys
import unittest
from pathlib import Path

import harness
from exr_reader import Exr

INPUTS = harness.SHARED / "field-cases"
KINDS = sorted(path.stem for path in (Path(__file__).parent / "field_cases").glob("*.py"))


class Picture:
    """The frame that was rendered: `pixel(x, y)` and `mean()` give R, G and B."""

    def __init__(self, path):
        exr = Exr(path)
        self.width, self.height = exr.width, exr.height
        self.rows = [exr.channel(name) for name in "RGB"]

    def pixel(self, x, y):
        return tuple(rows[y][x] for rows in self.rows)

    def mean(self):
        return tuple(sum(map(sum, rows)) / (self.width * self.height) for rows in self.rows)

    def difference(self, other):
        """The largest difference of any value to another picture's; infinite where the sizes differ."""
        if (self.width, self.height) != (other.width, other.height):
            return math.inf
        return max(abs(a - b) for mine, theirs in zip(self.rows, other.rows) for row, other_row in zip(mine, theirs)
                   for a, b in zip(row, other_row))


class FieldCases(harness.CliTest):
    """The bench of the cases: a folder of their own, and what runs the program in it. Inputs are read-only."""

    def scene(self, name):
        return INPUTS / "scenes" / name

    def fault(self, name):
        return INPUTS / "faults" / name

    def render(self, scene, *options):
        """One frame of 96 x 54, without a filter; the result of the program, and the picture or None."""
        path = self.folder / "frame.exr"
        path.unlink(missing_ok=True)
        result = self.run_program("render", scene, "--size", "96x54", "--sampling", "uniform", "--filter", "none", "--threads", "1",
                                  "--quiet", "--exr-pixels", "float", "--exr-compression", "none", "--overwrite", "-o", path, *options)
        return result, Picture(path) if result.returncode == 0 and path.exists() else None

    def picture(self, scene, *options):
        """As render(), the picture alone; AssertionError with what the program printed where there is none."""
        result, picture = self.render(scene, *options)
        if picture is None:
            raise AssertionError(self.last_line(result))
        return picture

    @staticmethod
    def last_line(result):
        lines = (result.stdout + result.stderr).strip().splitlines()
        return f"code {result.returncode}: " + (lines[-1] if lines else "nothing")

    def refused(self, result, *words):
        """Whether it ended with code 2 and one line that has all these words; the line."""
        lines = result.stderr.strip().splitlines()
        missing = [word for word in words if word.lower() not in result.stderr.lower()]
        return result.returncode == 2 and len(lines) == 1 and not missing, (f"lacks {missing}; " if missing else "") + self.last_line(result)

    @staticmethod
    def near(got, right, tolerance=0.002):
        """Whether these numbers lie this near to those; the numbers."""
        return (len(got) == len(right) and all(abs(a - b) <= tolerance for a, b in zip(got, right)),
                " ".join(f"{value:.4f}" for value in got))

    def result_of(self, case):
        try:
            return case(self)
        except Exception as error:  # a file that is not read shows itself in many ways
            return False, f"{type(error).__name__}: {error}"

    def check(self, kind):
        module = importlib.import_module("field_cases." + kind)
        cases = [case for name, case in vars(module).items()
                 if callable(case) and not name.startswith("_") and getattr(case, "__module__", "") == module.__name__]
        wrong = []
        for case in cases:
            good, got = self.result_of(case)
            right = " ".join((case.__doc__ or "").split())
            print(f"{'right' if good else 'WRONG'}  {kind}: {case.__name__}\n       expected: {right}\n       got:      {got}")
            wrong += [] if good else [case.__name__]
        print(f"{kind}: {len(cases) - len(wrong)} of {len(cases)} right")
        self.assertEqual(wrong, [])


def test_of(kind):
    return unittest.skipUnless(INPUTS.exists(), f"{INPUTS} is not here (GAZETRACE_SHARED_DIR)")(lambda self: self.check(kind))


for each in KINDS:
    setattr(FieldCases, "test_" + each, test_of(each))

if __name__ == "__main__":
    if "--table" in sys.argv:
        asked = sys.argv[sys.argv.index("--table") + 1:] or KINDS
        sys.argv[1:] = ["FieldCases.test_" + kind for kind in asked]
    harness.main()
