# SPDX-License-Identifier: Apache-2.0
"""What an import, an inspection and a plan make of a log whose right reading is known. A table of cases says of each what
is expected and what was got."""

import csv
import math

import harness

# Where the eye rests in the files of screens, as fractions, and in those of headsets, degrees to the right and up.
PLACES = [(.20, .30), (.75, .25), (.60, .80), (.15, .70), (.50, .50), (.85, .55), (.35, .15)]
ANGLES = [(-12, 6), (15, 8), (5, -14), (-18, -9), (0, 0), (20, -3), (-8, 12)]


class Log:
    """What an import wrote, or why it wrote nothing."""

    def __init__(self, text, path):
        self.text = text
        self.rows = []
        self.head = []
        if path.exists():
            lines = path.read_text().splitlines()
            self.head = [line for line in lines if line.startswith("#")]
            self.rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def usable(self):
        return [row for row in self.rows if row["valid"] in ("ok", "off_screen")]

    def place(self, i=0):
        row = self.usable()[i]
        return float(row["u[1]"]), float(row["v[1]"])

    def direction(self, i=0):
        row = self.usable()[i]
        return tuple(float(row[axis]) for axis in ("dx", "dy", "dz"))

    def near(self, true, tolerance):
        """The share of the samples that lie at one of the true places."""
        near = 0
        for row in self.usable():
            if "u[1]" in row:
                at = float(row["u[1]"]), float(row["v[1]"])
            else:
                x, y, z = (float(row[axis]) for axis in ("dx", "dy", "dz"))
                at = math.degrees(math.atan2(x, -z)), math.degrees(math.asin(y))
            near += any(math.dist(at, place) < tolerance for place in true)
        return near / max(1, len(self.rows))


def close(a, b, tolerance=0.002):
    return len(a) == len(b) and all(abs(x - y) < tolerance for x, y in zip(a, b))


class ReadingTest(harness.CliTest):
    """Cases are methods named by a letter and a number, with the right reading as their words; each returns whether it
    is right, and what was got."""

    letters = ""

    def log_path(self, name):
        return name

    def import_log(self, name, *options):
        out = self.folder / "out.csv"
        out.unlink(missing_ok=True)
        result = self.run_program("gaze", "import", self.log_path(name), "-o", out, *options)
        return Log(result.stdout + result.stderr, out)

    def inspect(self, name, *options):
        result = self.run_program("gaze", "inspect", self.log_path(name), *options)
        return result.stdout + result.stderr

    def plan(self, name, *options):
        result = self.run_program("plan", "box.gltf", "--gaze", self.log_path(name), *harness.SCREEN, "--fps", "10", "--frames", "1-2",
                                  "--size", "64x36", *options)
        return result.stdout + result.stderr

    def says(self, text, words, never=()):
        """Whether a text has all words and none of the others; the last line of it."""
        missing = [word for word in words if word not in text]
        wrong = [word for word in never if word in text]
        line = text.strip().splitlines()[-1] if text.strip() else "nothing"
        return not missing and not wrong, (f"lacks {missing}; " if missing else "") + (f"says {wrong}; " if wrong else "") + line[:150]

    def doubted(self, name, words, never=(), options=()):
        return self.says(self.inspect(name, *options), words, [*never, "nothing suspicious"])

    def refused(self, name, words, never=(), options=()):
        log = self.import_log(name, *options)
        good, got = self.says(log.text, words, never)
        return good and not log.rows, got if not log.rows else f"read {len(log.rows)} rows: " + got

    def read(self, name, true, tolerance, options=(), rows=None, share=0.75):
        log = self.import_log(name, *options)
        if not log.rows:
            return False, log.text.strip().splitlines()[-1][:200]
        near = log.near(true, tolerance)
        return near >= share and (rows is None or len(log.rows) == rows), f"{len(log.rows)} rows, {100 * near:.0f} % at true places"

    def cases(self):
        return [name for name in vars(type(self)) if name[0] in self.letters and name[1].isdigit()]

    def result_of(self, name):
        try:
            return getattr(self, name)()
        except Exception as error:  # a file that is not read shows itself in many ways
            return False, f"{type(error).__name__}: {error}"

    def check_all(self):
        wrong = []
        for name in self.cases():
            good, got = self.result_of(name)
            print(f"{'right' if good else 'WRONG'}  {name:34} {getattr(self, name).__doc__}\n{'':41} got: {got}")
            wrong += [] if good else [name]
        print(f"{len(self.cases()) - len(wrong)} of {len(self.cases())} right")
        self.assertEqual(wrong, [])
