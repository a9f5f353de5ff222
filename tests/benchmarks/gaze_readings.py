#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No guess reaches a picture: real recordings are written as tables of one's own under each unit, origin, axes and
validity, once without a word about them and once with a false statement. Without a word a table must be refused or read
right; a false statement must be refused or named, or stands among those that no data tell apart (docs/gaze.md). Ends with 1
otherwise. Prints the suspicions about the recordings as they are, too: those that are wrong are false alarms.

  tests/benchmarks/gaze_readings.py build/dev/bin/gazetrace ../shared/gaze-samples
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SCREENS = ["arff/gaze.arff", "eyelink-asc/mono500.asc", "eyelink-asc/bino1000_blinks.asc", "tobii-studio-tsv/data.tsv",
           "smi-iview-txt/recording1_Samples.txt", "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz"]
HEADS = ["pico-neo3-pro/boxing_VR.csv", "vive-pro-eye/TESTNA01_2D_Fist3.csv", "vive-pro-eye/TESTNA01_360VR_Fist3.csv"]
WIDTH, HEIGHT = 1920, 1080
ROWS = 3000
# What a place in fractions is in each unit and origin, and the options that state it.
PLACES = {
    "fraction": (lambda u, v: (u, v), ["--unit", "fraction"]),
    "fraction from the bottom left": (lambda u, v: (u, 1 - v), ["--unit", "fraction", "--origin", "bottom-left"]),
    "px": (lambda u, v: (u * WIDTH, v * HEIGHT), ["--unit", "px"]),
    "px from the bottom left": (lambda u, v: (u * WIDTH, (1 - v) * HEIGHT), ["--unit", "px", "--origin", "bottom-left"]),
    "px from the center": (lambda u, v: ((u - .5) * WIDTH, (.5 - v) * HEIGHT), ["--unit", "px", "--origin", "center"]),
    "norm": (lambda u, v: (2 * u - 1, 1 - 2 * v), ["--unit", "norm"]),
    "height": (lambda u, v: ((u - .5) * WIDTH / HEIGHT, .5 - v), ["--unit", "height"]),
    "cm from the center": (lambda u, v: ((u - .5) * 51, (.5 - v) * 29), ["--unit", "cm", "--origin", "center"]),
    "deg": (lambda u, v: ((u - .5) * 45, (.5 - v) * 25), ["--unit", "deg"]),
    "rad": (lambda u, v: ((u - .5) * .785, (.5 - v) * .436), ["--unit", "rad"]),
}
AXES = {"gl": lambda x, y, z: (x, y, z), "unity": lambda x, y, z: (x, y, -z), "sranipal": lambda x, y, z: (-x, y, -z),
        "cv": lambda x, y, z: (x, -y, -z), "unreal": lambda x, y, z: (-z, x, y)}
SCREEN = ["--screen-px", f"{WIDTH},{HEIGHT}", "--screen-cm", "51,29", "--screen-distance-cm", "60"]
# Pairs of a truth and a statement that no data tell apart: mirrored pictures, origins under which gaze stays on the display,
# and scales near each other.
SMALL = {"fraction", "fraction from the bottom left", "norm", "height", "rad"}
ALIKE = [SMALL, {"px", "px from the bottom left"}, {"px from the bottom left", "px from the center"},
         {"cm from the center", "deg"}, {"unity", "sranipal", "cv"}]
# Of these, saccades are too few or too coarsely sampled to be measured, and nothing tells how large the movements were.
UNMEASURED = {"eyelink-asc/mono500.asc", "tobii-studio-tsv/data.tsv", "smi-iview-txt/recording1_Samples.txt",
              "bids/derived-tx300/sub-01_task-view_recording-eye1_physio.tsv.gz"}


# The recordings as they are, with what they do not state.
AS_THEY_ARE = {**{name: [] for name in SCREENS + HEADS}, "eyelink-asc/bino1000.asc": [], "pupil-core/gaze_positions.csv": [],
               "pupil-core/gaze_positions_with_monocular.csv": [], "pupil-invisible-cloud/gaze.csv": [],
               "pupil-invisible-cloud/trampoline_02_gaze.csv": [], "pupil-neon-native/gaze ps1.raw": [],
               "tobii-glasses2/livedata.json.gz": [], "tobii-glasses3/gazedata.gz": [],
               "gazebase-vr/gazebase_vr_example.csv": [], "plain-csv/gaze-toy-example.csv": ["--screen-px", "1280,1024"]}


def are_alike(name, true, said):
    is_scale = true in SMALL and said in {"cm from the center", "deg"}
    return any(true in pair and said in pair for pair in ALIKE) or (is_scale and name in UNMEASURED)


def rows_of(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = [row for row in csv.DictReader(lines) if row["valid"] in ("ok", "off_screen")]
    eye = rows[0]["eye"]
    return [row for row in rows if row["eye"] == eye][:ROWS]


class Readings:
    def __init__(self, program, samples, folder):
        self.program, self.samples, self.folder = program, samples, folder
        self.silent, self.counts = [], {}

    def run(self, *arguments):
        return subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)

    def truth(self, name):
        out = self.folder / "truth.csv"
        result = self.run("gaze", "import", self.samples / name, "-o", out, "--overwrite")
        assert result.returncode == 0, result.stderr
        return rows_of(out)

    def judge(self, name, true, said, options, is_alike):
        """Refused, named, right, or silent and wrong."""
        command = ["import", "-o", self.folder / "read.csv"] if options else ["events", "-o", self.folder / "events.tsv"]
        result = self.run("gaze", *command, self.folder / "table.csv", *SCREEN, *options, "--overwrite")
        lines = result.stderr.splitlines()
        if options and result.returncode == 0:  # what reads the file has doubts of its own
            lines += self.run("gaze", "events", self.folder / "read.csv", "-o", self.folder / "events.tsv", "--overwrite").stderr.splitlines()
        doubts = [line for line in lines if ("table.csv" in line or "read.csv" in line) and "guessed from its steps" not in line]
        what = "refused" if result.returncode else "right" if true == said else "named" if doubts else "alike" if is_alike else "silent"
        self.counts[what] = self.counts.get(what, 0) + 1
        if what == "silent":
            self.silent.append(f"{name}: {true}, read as {said or 'it stands'}")

    def table(self, header, rows):
        (self.folder / "table.csv").write_text(header + "\n" + "".join(",".join(f"{x:.7g}" if i else str(x) for i, x in enumerate(row)) + "\n" for row in rows))

    def screens(self):
        for name in SCREENS:
            rows = [(int(r["t[ns]"]), float(r["u[1]"]), float(r["v[1]"])) for r in self.truth(name)]
            for true, (write, options) in PLACES.items():
                self.table("t[ns],x,y", [(t, *write(u, v)) for t, u, v in rows])
                # Plain pixels of a stated display are certain; from the bottom left nothing tells them apart.
                self.judge(name, true, "px" if true == "px" else "", [], true == "px from the bottom left")
                for said, (_, statement) in PLACES.items():
                    self.judge(name, true, said, statement, are_alike(name, true, said))

    def heads(self):
        for name in HEADS:
            rows = [(int(r["t[ns]"]), *(float(r[d]) for d in ("dx", "dy", "dz"))) for r in self.truth(name)]
            for true, turn in AXES.items():
                self.table("t[ns],dir_x,dir_y,dir_z", [(t, *turn(x, y, z)) for t, x, y, z in rows])
                self.judge(name, true, "gl" if true == "gl" else "", [], False)
                for said in AXES:
                    self.judge(name, true, said, ["--axes", said], are_alike(name, true, said))


    def validities(self):
        """A twentieth of the rows lost, at (0, 0), with 1 or 0 for those that are good."""
        for name in SCREENS:
            rows = [(int(r["t[ns]"]), float(r["u[1]"]) * WIDTH, float(r["v[1]"]) * HEIGHT) for r in self.truth(name)]
            for true in ("1", "0"):
                self.table("t[ns],x[px],y[px],valid", [(t, 0, 0, 1 - int(true)) if i % 40 < 2 else (t, x, y, int(true)) for i, (t, x, y) in enumerate(rows)])
                self.judge(name, true, "1" if true == "1" else "", [], False)
                for said in ("1", "0"):
                    self.judge(name, true, said, ["--valid-values", said], False)

    def suspicions(self):
        """What the doctor says of the recordings as they are, each with its suspicions and faults."""
        for name, options in AS_THEY_ARE.items():
            report = json.loads(self.run("gaze", "inspect", self.samples / name, *options, "--json").stdout)
            yield name, [f["what"] for f in report["findings"] if f["kind"] != "note"]


def main():
    with tempfile.TemporaryDirectory() as folder:
        readings = Readings(Path(sys.argv[1]).resolve(), Path(sys.argv[2]), Path(folder))
        readings.screens()
        readings.heads()
        readings.validities()
        suspicions = list(readings.suspicions())
    for name, found in suspicions:
        print(f"{name}: {'; '.join(found) or 'nothing'}")
    print(f"{sum(bool(found) for _, found in suspicions)} of {len(suspicions)} recordings as they are have suspicions")
    print(f"{sum(readings.counts.values())} readings: " + ", ".join(f"{n} {what}" for what, n in sorted(readings.counts.items())))
    for line in readings.silent:
        print("wrong in silence: " + line)
    return 1 if readings.silent else 0


if __name__ == "__main__":
    sys.exit(main())
