# SPDX-License-Identifier: Apache-2.0
"""Gazepoint Analysis: the fixations that the log states, its pupils and its areas of interest."""

import csv
import json

import harness

SCREEN = ["--screen-px", "1920,1080", "--screen-cm", "50.9,28.6", "--screen-distance-cm", "65"]


def log(fixations, rate=60, until=4.0, pupils="LPMM,LPMMV,RPMM,RPMMV", extra=""):
    """As the API's manual describes it: FPOGV is 1 only from the row on in which a fixation was recognized, three rows
    after its begin, and FPOGD is the duration up to the row. `fixations`: (begin in s, duration in s, x, is it valid
    throughout)."""
    header = ("MEDIA_ID,MEDIA_NAME,CNT,TIME(2024/03/05 10:11:12.000),TIMETICK(f=10000000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,"
              f"BPOGX,BPOGY,BPOGV,LPOGX,LPOGY,LPOGV,RPOGX,RPOGY,RPOGV,{pupils},LPD,LPV,RPD,RPV,BKID,AOI,")
    lines = [header]
    for i in range(int(until * rate)):
        t = i / rate
        shown = (0, 0, 0, 0, 0)  # begin, duration, id, valid, x
        for number, (begin, duration, x, whole) in enumerate(fixations, 1):
            if t >= begin + 2.5 / rate:
                inside = t <= begin + duration
                broken = not whole and int((t - begin) * rate) in (6, 7)
                shown = (begin, min(t - begin, duration), number, int(inside and not broken and whole is not None), x)
        begin, duration, number, valid, x = shown
        here = next((f[2] for f in fixations if f[0] <= t <= f[0] + f[1]), 0.5)
        millimetres = "3.5,1,3.7,1" if i % 10 else "0,0,3.7,1"
        lines.append(f"0,Film,{i},{t:.5f},{int(1e7 * (t + 100))},{x},0.5,{begin:.5f},{duration:.5f},{number},{valid},{here},0.5,1,"
                     f"{here},0.5,1,{here},0.5,1,{millimetres if 'MM' in pupils else '-,-,-,-'},15.5,1,16.5,1,0,{'AOI 1' if here < 0.4 else ''},")
    return "\n".join(lines) + "\n"


# The second is recognized in pieces, and of the fourth no row is marked as valid.
FIXATIONS = [(0.10, 0.60, 0.3, True), (0.80, 0.40, 0.6, False), (1.30, 0.279, 0.35, True), (1.70, 0.50, 0.7, None)]


class Gazepoint(harness.CliTest):
    def events(self, *arguments):
        rows = csv.DictReader(self.run_ok("gaze", "events", *arguments, "--method", "log", *SCREEN).stdout.splitlines(), delimiter="\t")
        return [row for row in rows if row["movement"] == "fixation"]

    def test_fixations_are_those_that_the_log_states(self):
        self.write("all.csv", log(FIXATIONS))
        found = self.events("all.csv")
        self.assertEqual([(int(row["onset_ns"]), float(row["duration_ms"])) for row in found],
                         [(round(begin * 1e9), duration * 1e3) for begin, duration, _, _ in FIXATIONS])
        # Counted by the computer's ticks, a hundred seconds later.
        self.run_ok("gaze", "import", "all.csv", "--time-column", "TIMETICK", "-o", "ticks.csv")
        ticks = self.events("ticks.csv")
        for row, (begin, duration, _, _) in zip(ticks, FIXATIONS, strict=True):
            self.assertAlmostEqual(int(row["onset_ns"]) * 1e-9, 100 + begin, delta=1e-4)
            self.assertEqual(float(row["duration_ms"]), duration * 1e3)

    def test_pupils_are_kept_with_their_unit(self):
        self.write("mm.csv", log(FIXATIONS))
        self.write("px.csv", log(FIXATIONS, pupils="A,B,C,D"))
        for name, unit, both, left in (("mm.csv", "mm", 3.6, 3.5), ("px.csv", "px", 16.0, 15.5)):
            self.run_ok("gaze", "import", name, "-o", "out.csv", "--overwrite")
            lines = [line for line in (self.folder / "out.csv").read_text().splitlines() if line[:1] != "#"]
            self.assertIn(f"pupil[{unit}]", lines[0])
            rows = list(csv.DictReader(lines))
            of = {row["eye"]: float(row[f"pupil[{unit}]"]) for row in rows[3:6]}
            self.assertEqual(of, {"cyclopean": both, "left": left, "right": 2 * both - left})
        self.run_ok("gaze", "import", "mm.csv", "-o", "out.csv", "--overwrite")
        lines = [line for line in (self.folder / "out.csv").read_text().splitlines() if line[:1] != "#"]
        first = {row["eye"]: row["pupil[mm]"] for row in list(csv.DictReader(lines))[:3]}
        self.assertEqual(first, {"cyclopean": "3.7", "left": "", "right": "3.7"})  # the left one was not measured
        report = json.loads(self.run_ok("gaze", "inspect", "mm.csv", "--json").stdout)
        self.assertIn("LPD and RPD", " ".join(fact["detail"] for fact in report["facts"]))

    def test_areas_of_interest_are_events(self):
        self.write("all.csv", log(FIXATIONS))
        report = json.loads(self.run_ok("gaze", "inspect", "all.csv", "--json").stdout)
        self.assertEqual(report["events"]["aoi"], 2)
        self.run_ok("gaze", "import", "all.csv", "-o", "out.csv")
        self.assertEqual((self.folder / "out.csv").read_text().count(" AOI 1\n"), 2)


if __name__ == "__main__":
    harness.main()
