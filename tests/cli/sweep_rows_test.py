# SPDX-License-Identifier: Apache-2.0
"""`gazetrace sweep`: whose row is whose, what is kept and what is measured anew, what the results say of themselves."""

import csv
import json
import re

import gaze_test
import harness

PLAN = """
[common]
size = "64x36"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
frames = "1"
[[scene]]
name = "box"
path = "box.gltf"
[[gaze]]
name = "left"
at = [0.2, 0.5]
SETTINGS
[reference]
go-on = true
spp = 4
[measure]
repeats = 2
controls = false
efficiency-spp = 0
pictures = "none"
MEASURE
"""
GRID = "[grid]\nregion-samples = [[8, 2, 1]]\n"


class SweepRows(harness.CliTest):
    def plan(self, settings=GRID, measure='metrics = ["mse"]\nbaselines = ["none"]\n'):
        self.write("plan.toml", PLAN.replace("SETTINGS", settings).replace("MEASURE", measure))

    def sweep(self, *more, folder="out"):
        return self.run_ok("sweep", "plan.toml", "-o", folder, *more)

    def results(self, folder="out"):
        return json.loads((self.folder / folder / "results.json").read_text())

    def test_columns_of_the_csv_are_those_of_the_json(self):
        self.plan('[[setting]]\nregion-samples = [8, 2, 1]\nfilter = "none"\n'
                  '[[setting]]\ndensity = "mar:slope=0.025"\nfilter = "linear"\nblock-samples = 2\nmax-block = 4\n',
                  'metrics = ["mse"]\nreference-rate = 8\n')
        self.sweep("--quiet")
        results = self.results()
        rows = {row["id"]: row for row in results["rows"]}
        self.assertIn("box-left-1-uniform", rows)
        with open(self.folder / "out/results.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        self.assertEqual({line["id"] for line in lines}, set(rows))
        for line in lines:
            row = rows[line["id"]]
            self.assertNotIn(None, line, "more values than columns")
            for option in results["varied"]:
                self.assertEqual(line[option], row["settings"].get(option, ""), (row["id"], option))
        for line in lines:
            row = rows[line["id"]]
            self.assertEqual(int(line["repeats"]), len(row["time_s"]["values"]))
            for name in ("samples", "spp_mean", "rays", "peak_mib", "resolution_scale"):
                self.assertGreater(row[name], 0)
                self.assertAlmostEqual(float(line[name]) / row[name], 1, places=7, msg=name)
            self.assertAlmostEqual(float(line["time_s"]) / row["time_s"]["mean"], 1, places=7)
            self.assertEqual((line["end_to_end"], row["end_to_end"], row["output_s"]), ("", None, None))  # no pictures
            score = row["scores"][line["metric"]][line["part"]]["mean"]
            self.assertAlmostEqual(float(line["score"]), score, delta=1e-7 * score)
            # Of the rows that see no gaze there is nothing to tell but rate and filter.
            if row["role"] != "test":
                self.assertLessEqual(set(row["settings"]), {"filter", "sampling", "spp"})
                self.assertEqual(row["settings"]["sampling"], "uniform")

    def test_end_to_end_ratios_are_of_times_with_output(self):
        self.plan(measure='metrics = ["mse"]\nreference-rate = 8\nbaselines = ["uniform-reference-rate"]\n')
        plan = (self.folder / "plan.toml").read_text()
        for pictures, suffixes in (("none", set()), ("png", {".png"}), ("both", {".png", ".exr"})):
            self.write("plan.toml", plan.replace('"none"\nmetrics', f'"{pictures}"\nmetrics'))
            table = self.sweep("--quiet", folder=pictures).stdout
            rows = {row["id"]: row for row in self.results(pictures)["rows"]}
            self.assertEqual(len(rows), 2)
            found = {path.suffix for path in (self.folder / pictures / "frames").rglob("frame.*")}
            self.assertEqual(found, suffixes)
            self.assertIn("end-to-end: " + ("the same with" if suffixes else "not known"), table)
            methods = (self.folder / pictures / "methods.txt").read_text()
            self.assertEqual("End-to-end ratios are of these times and" in methods, bool(suffixes))
            with open(self.folder / pictures / "results.csv", newline="") as file:
                lines = {line["id"]: line for line in csv.DictReader(file)}
            for row in rows.values():
                if not suffixes:
                    self.assertEqual((lines[row["id"]]["end_to_end"], row["end_to_end"], row["output_s"]), ("", None, None))
                    continue
                self.assertGreater(row["output_s"], 0)
                uniform = rows["box-left-1-uniform"]
                ratios = [(a + uniform["output_s"]) / (b + row["output_s"])
                          for a, b in zip(uniform["time_s"]["values"], row["time_s"]["values"])]
                self.assertAlmostEqual(row["end_to_end"], (ratios[0] * ratios[1]) ** 0.5, places=9)
                self.assertAlmostEqual(float(lines[row["id"]]["end_to_end"]) / row["end_to_end"], 1, places=7)
            # Taken up again, the same.
            self.sweep("--quiet", folder=pictures)
            self.assertEqual({row["id"]: row for row in self.results(pictures)["rows"]}, rows)

    def test_every_test_has_a_row_of_equal_time(self):
        # Uniform rendering stops at four times the reference rate, long before it takes as long as either of these: the
        # rate found is the same, unless the machine was busy with something else.
        self.plan('[grid]\nregion-blocks = [[1, 1]]\nregion-samples = [[16, 16, 16], [12, 12, 12]]\n'
                  'size = ["256x144"]\nfilter = ["none"]\n',
                  'metrics = ["mse"]\nreference-rate = 1\nbaselines = ["equal-time"]\n')
        self.sweep("--quiet")
        rows = {row["id"]: row for row in self.results()["rows"]}
        for name in ("box-left-1", "box-left-2"):
            beside = rows[rows[name]["baselines"]["equal-time"]]
            self.assertEqual((beside["id"], beside["of"]), (name + "-time", name))
            ratios = [a / b for a, b in zip(beside["time_s"]["values"], rows[name]["time_s"]["values"])]
            self.assertAlmostEqual(beside["reached"]["mean"], (ratios[0] * ratios[1]) ** 0.5, places=9)

    def test_times_of_other_threads_are_not_taken(self):
        self.plan()
        self.sweep("--threads", "1")
        self.assertEqual(self.results()["machine"]["threads"], 1)
        self.assertIn("round", self.sweep("--threads", "2").stderr)
        self.assertEqual(self.results()["machine"]["threads"], 2)
        self.assertNotIn("round", self.sweep("--threads", "1").stderr)

    def test_pictures_of_two_sizes_have_two_fronts(self):
        self.plan('[grid]\nsize = ["64x36", "32x18"]\nregion-samples = [[8, 2, 1]]\n')
        self.sweep("--quiet")
        results = self.results()
        rows = {row["id"]: row for row in results["rows"]}
        fronts = results["pareto"]["mse"]
        self.assertEqual(set(fronts), {"box/left/" + row["reference"] for row in rows.values()})
        self.assertEqual(len(fronts), 2)
        for place, ids in fronts.items():
            self.assertEqual({"box/left/" + rows[name]["reference"] for name in ids}, {place})
        shares = [scene["reference"]["band_pixel_share_by_gaze"]["left"] for scene in results["scenes"]]
        self.assertNotEqual(shares[0], shares[1])
        self.assertNotIn("left", results["band_pixel_share"])  # neither of the two
        self.assertEqual(results["shares"]["left"], {"fixation": 1})  # both

    def test_a_camera_on_the_head_has_a_reference_for_each_clock(self):
        self.write("log.csv", gaze_test.HEAD_LOG)
        self.write("map.json", json.dumps(gaze_test.HEAD_MAP))
        self.run_ok("gaze", "import", "log.csv", "--columns", "map.json", "-o", "gaze.csv")
        head = 'log = "gaze.csv"\n'
        plan = ('[common]\ncamera-from-gaze = true\nsize = "64x36"\nfps = 2\nframes = "1"\n[[scene]]\nname = "box"\n'
                f'path = "box.gltf"\n[[gaze]]\nname = "a"\n{head}[[gaze]]\nname = "b"\n{head}SHIFT\n{GRID}'
                '[measure]\nmetrics = ["mse"]\n')
        for shift, references in (('gaze-offset = "100ms"', 2), ('gaze-latency = "50ms"', 1)):
            self.write("plan.toml", plan.replace("SHIFT", shift))
            lines = self.run_ok("sweep", "plan.toml", "--dry-run").stdout.splitlines()
            self.assertEqual(len([line for line in lines if line.startswith("reference")]), references, lines)

    def test_methods_tell_every_setting(self):
        self.plan(GRID.replace("[grid]", '[grid]\nresolution-scale = [1, 0.5]'),
                  'metrics = ["mse", "relmse", "hdr_flip", "fovvideovdp"]\nbaselines = ["none"]\nreflectivity = 0.007\n'
                  'response = "gamma2.2"\nrelmse-epsilon = 0.03\nflip-count = 5\nflip-start = -9.5\n')
        self.sweep("--quiet")
        text = (self.folder / "out/methods.txt").read_text()
        for words in ("the view built-in", "0.007", "gamma 2.2", "epsilon of 0.03", "5 exposures from -9.5 stops to", "bilinear",
                      "begin at 0, 2.6, 5.2, 8.5, 17, 30, 60 degrees", "ends at 2.6", "8.5 degrees",
                      "16 bounces, indirect light not clamped"):
            self.assertIn(words, text)
        self.assertEqual(self.results()["regions_deg"], [2.6, 8.5])

    def test_flicker_beyond_the_frame_rate_is_told(self):
        # Half of 4 frames a second are 2 Hz; of 5, two whole periods in a second.
        self.plan('[grid]\nfps = [4, 5]\nframes = ["1-6"]\nregion-samples = [[8, 2, 1]]\n',
                  'metrics = ["flicker"]\nbaselines = ["none"]\n')
        table = self.sweep("--quiet").stdout
        results = self.results()
        notes = [note for note in results["notes"] if note.startswith("flicker at ")]
        self.assertEqual(len(notes), 2)
        methods = (self.folder / "out/methods.txt").read_text()
        self.run_ok("report", "out", "-o", "report.html")
        page = (self.folder / "report.html").read_text()
        for fps, note in zip((4, 5), notes):
            words = (f"flicker at {fps} frames a second: from 1 to 2 Hz",
                     "flicker above 2 Hz cannot be measured at this frame rate")
            for word in words:
                self.assertIn(word, note)
                self.assertIn(word, methods)
                self.assertIn(word, page)
                self.assertIn(word, results["methods"])
                self.assertIn(word, table)
            seen = float(re.search(r"up to (\d+) Hz would be visible", note)[1])
            self.assertGreater(seen, 20)  # nobody takes 20 Hz on a bright display for steady
        self.plan()
        self.sweep("--quiet", folder="without")
        self.assertEqual([note for note in self.results("without")["notes"] if "flicker" in note], [])

    def test_restart_throws_away_what_is_damaged(self):
        self.plan()
        self.sweep("--quiet")
        for damage in ('{"format": "gaz', "[]"):
            self.write("out/state.json", damage)
            self.assert_refused(["sweep", "plan.toml", "-o", "out"], ["state.json", "damaged", "--restart"])
            self.assertIn("round 1", self.sweep("--restart").stderr)
        self.assertNotIn("round", self.sweep().stderr)

    def test_a_lost_reference_is_rendered_again(self):
        self.plan()
        self.sweep("--quiet")
        first = self.results()["rows"][0]["scores"]
        reference = self.folder / "out" / self.results()["scenes"][0]["reference"]["directory"]
        for name in ("reference.0001.exr", "half-2.0001.exr"):
            (reference / name).unlink()
            for run in (self.folder / "out/runs").iterdir():
                run.unlink()
            self.assertIn("scrambling 1 of 4", self.sweep().stderr)
            self.assertTrue((reference / name).is_file())
            self.assertEqual(self.results()["rows"][0]["scores"], first)


if __name__ == "__main__":
    harness.main()
