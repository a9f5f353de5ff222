# SPDX-License-Identifier: Apache-2.0
"""`gazetrace sweep` from outside: rows and baselines, numbers that must hold, interruption, plans that are refused."""

import csv
import fcntl
import json
import math
import os
import re
import signal
import subprocess
import time

import harness

PLAN = """
title = "a box"
[common]
size = "64x36"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
fps = 12
frames = "1-3"
[[scene]]
name = "box"
path = "box.gltf"
[[gaze]]
name = "moving"
log = "gaze.csv"
[[gaze]]
name = "left"
at = [0.2, 0.5]
[grid]
region-samples = [[16, 4, 4], [8, 2, 1]]
[reference]
go-on = true
spp = 16
[measure]
repeats = 2
reference-rate = 16
uniform-rates = [1, 4]
efficiency-spp = 2
metrics = ["mse", "flip", "fovvideovdp"]
quality = ["flip=0.05", "fovvideovdp=9.5"]
"""


class Sweep(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("gaze.csv", harness.moving_gaze())

    def plan(self, text=PLAN, name="plan.toml"):
        self.write(name, text)
        return name

    def results(self, folder):
        return json.loads((self.folder / folder / "results.json").read_text())

    # What does not depend on how fast the machine was.
    @staticmethod
    def timeless(results):
        rows = {}
        for row in results["rows"]:
            if row["role"] != "equal-time":
                rows[row["id"]] = (row["role"], row["samples"], row["spp_mean"], row["scores"],
                                   [frame["scores"] for frame in row["frames"]])
        return rows, [scene["reference"]["floor_by_gaze"] for scene in results["scenes"]]

    def test_rows_baselines_and_tables(self):
        self.plan()
        table = self.run_ok("sweep", "plan.toml", "-o", "out").stdout
        results = self.results("out")
        rows = {row["id"]: row for row in results["rows"]}
        # Every row was measured as often as asked, and none carries what another one measured.
        self.assertEqual({len(row["time_s"]["values"]) for row in rows.values()}, {2})
        for gaze in ("moving", "left"):
            for k in (1, 2):
                test = rows[f"box-{gaze}-{k}"]
                self.assertEqual(test["role"], "test")
                pixels = 64 * 36
                beside = {role: rows[name] for role, name in test["baselines"].items()}
                self.assertEqual(beside["uniform-reference-rate"]["spp_mean"], 16)
                # Equal samples to 0.1 %, of the whole clip.
                self.assertAlmostEqual(beside["equal-samples"]["samples"] / test["samples"], 1, delta=0.001)
                self.assertAlmostEqual(beside["low-resolution"]["samples"] / test["samples"], 1, delta=0.001)
                self.assertAlmostEqual(test["samples"], test["spp_mean"] * pixels * 3, places=6)
                self.assertGreater(beside["equal-time"]["reached"]["mean"], 0)
                self.assertGreater(test["efficiency"], 0)
                # t_uniform / t_foveated, pair by pair.
                uniform, foveated = (row["time_s"]["values"] for row in (beside["uniform-reference-rate"], test))
                ratio = (uniform[0] / foveated[0] * uniform[1] / foveated[1]) ** 0.5
                self.assertAlmostEqual(test["speed_up"]["mean"], ratio, places=9)
                self.assertLess(test["speed_up"]["low"], test["speed_up"]["high"])
                for metric in ("mse", "flip", "fovvideovdp"):
                    self.assertIn("whole", test["scores"][metric])
                self.assertTrue((self.folder / "out" / test["frames"][0]["png"]).is_file())
        # Uniform frames do not see the gaze: one rendering, scored twice.
        uniform = [row for row in rows.values() if row["role"] == "uniform-reference-rate"]
        self.assertEqual(len(uniform), 2)
        self.assertEqual(uniform[0]["time_s"], uniform[1]["time_s"])
        self.assertEqual(uniform[0]["scores"]["flip"]["whole"], uniform[1]["scores"]["flip"]["whole"])
        self.assertNotEqual(uniform[0]["scores"]["fovvideovdp"], uniform[1]["scores"]["fovvideovdp"])
        self.assertEqual({row["spp_mean"] for row in rows.values() if row["role"] == "uniform-rate"}, {1, 4})
        # What a uniform row is listed with is its own: nothing of the test's regions.
        same = next(row for row in rows.values() if row["role"] == "equal-samples")
        self.assertEqual(same["settings"]["sampling"], "uniform")
        self.assertFalse([key for key in same["settings"] if key.startswith("region-")])
        # The fixed gaze is 0.3 of the screen off the middle: mirrored and centred are wrong, shuffled is the same.
        self.assertEqual({row["wrong"] for row in rows.values() if row["gaze"] == "left" and row["wrong"]},
                         {"center", "mirrored"})
        self.assertEqual({control["wrong"] for control in results["controls"] if control["gaze"] == "moving"},
                         {"shuffled", "center", "mirrored"})
        self.assertTrue(results["fixed_quality"])
        for line in results["fixed_quality"]:  # the model's gain is of levels in JOD
            self.assertEqual(line["metric"] == "fovvideovdp", (line["model_gain"] or 0) > 1, line)
        self.assertIn("speed-up at fixed quality", table)
        self.assertIn("equal-time, reached", table)
        self.assertIn("16 samples per pixel", (self.folder / "out/methods.txt").read_text())
        with open(self.folder / "out/results.csv", newline="") as file:
            lines = list(csv.DictReader(file))
        one = next(line for line in lines if line["id"] == "box-left-1" and line["metric"] == "flip" and line["part"] == "whole")
        self.assertAlmostEqual(float(one["score"]), rows["box-left-1"]["scores"]["flip"]["whole"]["mean"], places=6)
        reference = results["scenes"][0]["reference"]
        self.assertEqual(reference["scramblings"], 4)
        self.assertGreater(reference["floor"]["mse"]["whole"], 0)
        # Nothing moves: one picture stands for the three frames.
        self.assertEqual(reference["frames_rendered"], 1)
        picture = "out/" + reference["directory"] + "/reference.000{}.exr"
        for k in (2, 3):
            self.run_ok("compare", picture.format(1), picture.format(k), "--metrics", "mse", "--fail-above", "mse=0",
                        "--anyway")
        self.assertIn("once for all frames", (self.folder / "out/methods.txt").read_text())

    def test_scores_are_those_of_render_and_compare(self):
        text = PLAN.replace('[[16, 4, 4], [8, 2, 1]]', '[[8, 2, 1]]')
        text = text.replace("repeats = 2", 'repeats = 1\nbaselines = ["none"]\ncontrols = false\npictures = "both"')
        self.plan(text.replace("uniform-rates = [1, 4]", "").replace("fps = 12", 'fps = 12\nexposure = "0"'))
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        results = self.results("out")
        row = next(row for row in results["rows"] if row["id"] == "box-left-1")
        folder = "out/" + os.path.dirname(row["frames"][0]["png"])
        reference = "out/" + results["scenes"][0]["reference"]["directory"]
        # The same pictures by `render`, to the code value.
        self.run_ok("render", "box.gltf", "--size", "64x36", *harness.SCREEN, "--gaze-at", "0.2,0.5", "--fps", "12",
                    "--frames", "1-3", "--region-samples", "8,2,1", "--accumulate", "off",
                    "--exposure", "0", "-o", "alone/frame.####.png", "--quiet")
        self.run_ok("compare", "alone/frame.####.png", folder + "/frame.####.png", "--metrics", "mse", "--anyway", "--json",
                    "same.json")
        same = json.loads((self.folder / "same.json").read_text())["sequence"][0]
        self.assertEqual((same["frames"], same["scores"][0]["value"]), (3, 0))
        self.run_ok("compare", reference + "/reference.####.exr", folder + "/frame.####.exr", "--metrics", "flip", "--anyway",
                    *harness.SCREEN, "--gaze-at", "0.2,0.5", "--fps", "12", "--exposure", "0", "--json", "out.json")
        scores = json.loads((self.folder / "out.json").read_text())["sequence"][0]["scores"][0]
        self.assertAlmostEqual(scores["value"], row["scores"]["flip"]["whole"]["mean"], delta=2e-4)

    def test_killed_sweep_goes_on(self):
        self.plan()
        whole = self.folder / "whole"
        self.run_ok("sweep", "plan.toml", "-o", "whole", "--quiet")
        environment = {name: value for name, value in os.environ.items() if name != "OCIO"}
        runs = self.folder / "cut" / "runs"
        for enough in (2, 9):
            process = subprocess.Popen([harness.PROGRAM, "sweep", "plan.toml", "-o", "cut", "--quiet"], cwd=self.folder,
                                       env=environment, stdout=subprocess.DEVNULL)
            limit = time.time() + 120
            while process.poll() is None and time.time() < limit and len(list(runs.glob("run-*.json"))) < enough:
                time.sleep(0.01)
            process.send_signal(signal.SIGKILL)
            process.wait()
        before = {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in runs.glob("*.json")}
        self.assertGreaterEqual(len(before), 9)
        self.assertLess(len(before), len(list((whole / "runs").glob("*.json"))), "was not killed in the middle")
        first = self.run_ok("sweep", "plan.toml", "-o", "cut", "--quiet").stdout
        for name, (content, written) in before.items():
            path = runs / name
            self.assertEqual((path.read_bytes(), path.stat().st_mtime_ns), (content, written), name)
        self.assertEqual(self.timeless(self.results("cut")), self.timeless(self.results("whole")))
        # Once more: nothing is left to do, and the tables are the same to the byte.
        tables = {name: (self.folder / "cut" / name).read_bytes() for name in ("results.json", "results.csv", "methods.txt")}
        again = self.run_ok("sweep", "plan.toml", "-o", "cut")
        self.assertEqual(again.stdout, first)
        self.assertNotIn("round", again.stderr)
        for name, content in tables.items():
            self.assertEqual((self.folder / "cut" / name).read_bytes(), content, name)

    def test_another_build_does_not_mix(self):
        text = PLAN.replace("repeats = 2", 'repeats = 1\nbaselines = ["none"]\ncontrols = false')
        self.plan(text.replace("uniform-rates = [1, 4]", ""))
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        state = json.loads((self.folder / "out/state.json").read_text())
        self.write("out/state.json", json.dumps({**state, "build": "0" * 32}))
        self.assert_refused(["sweep", "plan.toml", "-o", "out"], ["another build", "--restart"])
        self.run_ok("sweep", "plan.toml", "-o", "out", "--restart", "--quiet")
        self.assertEqual(json.loads((self.folder / "out/state.json").read_text()), state)

    def test_one_sweep_at_a_time(self):
        self.plan()
        (self.folder / "out").mkdir()
        with open(self.folder / "out/lock", "w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            self.assert_refused(["sweep", "plan.toml", "-o", "out"], ["out", "another sweep is at work there"])
            self.assert_refused(["sweep", "plan.toml", "-o", "out", "--restart"], ["another sweep is at work there"])

    def test_dry_run_renders_nothing(self):
        self.plan()
        before = self.files()
        text = self.run_ok("sweep", "plan.toml", "--dry-run").stdout
        self.assertEqual(self.files(), before)
        self.assertIn("box-moving-2", text)
        self.assertEqual(self.estimated(text)["reference"], [64 * 36 * 16])  # one picture stands for the three frames

    def estimated(self, text):
        """Samples of one repeat of a dry run's rows, by role."""
        samples = {}
        for line in text.splitlines()[1:-1]:
            row = re.match(r"\S+ +(\S+) +(\d+) +\d+  ", line)
            samples.setdefault(row[1], []).append(int(row[2]))
        return samples

    def test_dry_run_counts_the_pictures_of_the_reference(self):
        """One where nothing moves, which only the scene tells where the camera stands elsewhere, and all otherwise."""
        moving = harness.box_gltf(camera_seconds=1)
        self.write("camera.gltf", json.dumps(moving))
        moving["animations"][0]["channels"][0]["target"]["node"] = 0
        self.write("moving.gltf", json.dumps(moving))
        eye = "eye = [0, 0.5, 4]\ntarget = [0, 0.5, 0]\n"
        one = PLAN.replace("[[16, 4, 4], [8, 2, 1]]", "[[8, 2, 1]]").replace("uniform-rates = [1, 4]", "")
        one = one.replace("repeats = 2", 'repeats = 1\nbaselines = ["none"]\ncontrols = false')
        one = one.replace('metrics = ["mse", "flip", "fovvideovdp"]\nquality = ["flip=0.05", "fovvideovdp=9.5"]', 'metrics = ["mse"]')
        for scene, more, frames in (("box", eye, 1), ("moving", "", 3), ("moving", eye, 3), ("camera", "", 3), ("camera", eye, 1),
                                    ("box", 'accumulate = "window"\n', 1)):  # references gather nothing over time
            with self.subTest(scene=scene, more=more):
                self.plan(one.replace('path = "box.gltf"\n', f'path = "{scene}.gltf"\n{more}'))
                text = self.run_ok("sweep", "plan.toml", "--dry-run").stdout
                self.assertEqual(self.estimated(text)["reference"], [64 * 36 * 16 * frames])
                estimated = self.estimated(text)
                # Regions are timed apart, once a test, one for either gaze, at the plan's efficiency-spp.
                self.assertEqual(estimated["cost-by-region"], [64 * 36 * 2 * 3] * 2)
                tests = sum(estimated["test"] + estimated["cost-by-region"])
                whole = float(re.search(r"rows, (\S+) samples", text.splitlines()[-1])[1])
                self.assertAlmostEqual(whole / (4 * 64 * 36 * 16 * frames + tests), 1, delta=0.005)  # three digits are told
                self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet", "--restart")
                self.assertEqual(self.results("out")["scenes"][0]["reference"]["frames_rendered"], frames)

    def test_the_paper_again(self):
        """examples/paper.toml, small: its settings, samples and the table beside what was printed."""
        scene = harness.SHARED / "scenes/sponza/Sponza.gltf"
        if not scene.is_file():
            self.skipTest("Sponza is not here")
        text = (harness.SOURCE / "examples/paper.toml").read_text()
        parts = re.split(r"\n(?=\[)", text)
        dropped = ('name = "lost', 'name = "san', 'name = "side', 'name = "corner', 'scene = "lost', 'scene = "san')
        text = "\n".join(part for part in parts if not any(word in part for word in dropped))
        width, height = 256, 144
        for old, new in (('"3840x2160"', f'"{width}x{height}"'), ('"data/kiara', f'"{harness.SHARED}/hdri/kiara'), ('"data/', f'"{harness.SHARED}/scenes/'), ("spp = 256", "go-on = true\nspp = 8"),
                         ("repeats = 3", 'repeats = 1\ncontrols = false\npictures = "none"'),
                         ("uniform-rates = [1, 4, 8]", "")):
            self.assertIn(old, text)
            text = text.replace(old, new)
        self.plan(text)
        table = self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet").stdout
        rows = {row["label"]: row for row in self.results("out")["rows"] if row["role"] == "test"}
        # Equation (1) of the paper, r = 2 d R tan(e / 2) / S, read as diameters; pixels counted by their centres.
        radius = [60 * width * math.tan(math.radians(angle) / 2) / 70.848 for angle in (5.2, 17)]
        counts = [0, 0, 0]
        for y in range(height):
            for x in range(width):
                r = math.hypot(x + 0.5 - width / 2, y + 0.5 - height / 2)
                counts[sum(r > limit for limit in radius)] += 1
        for label, row in rows.items():
            tau = [int(n) for n in label.split("/")]
            nominal = tau[0] * counts[0] + tau[1] * counts[1] / 4 + tau[2] * counts[2] / 16
            # Blocks that straddle a border are sampled once for each part.
            self.assertGreaterEqual(row["samples"], nominal)
            self.assertLess(row["samples"], 1.12 * nominal)
            self.assertTrue(row["published"])
        self.assertEqual(sorted(rows), ["32/16/8", "32/2/1", "32/8/4"])
        self.assertIn("57.1 in Table 2", table)

    def test_bad_plans(self):
        line = {text: number for number, text in enumerate(PLAN.splitlines(), 1)}
        cases = [
            ("[measure]", "[mesure]", "[measure]", ["unknown key 'mesure'", "measure"]),
            ("spp = 16", "sppp = 16", "spp = 16", ["unknown key 'sppp'", "did you mean 'spp'"]),
            ("repeats = 2", "repeat = 2", "repeats = 2", ["did you mean 'repeats'"]),
            ("repeats = 2", "repeats = 0", "repeats = 2", ["outside 1"]),
            ("repeats = 2", 'repeats = "two"', "repeats = 2", ["two"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "region-sample = [[16, 4, 4]]", None, ["did you mean 'region-samples'"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "region-samples = [[16, 4]]", None, ["region-samples"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "region-samples = [[16, 4, 4], [16, 4, 4]]", None, ["same setting"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "clamp-indirect = [0, -2]", None, ["-2"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "bounces = [1, 2]", None, ["reference", "bounces"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", 'filter = ["liner"]', None, ["did you mean 'linear'"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", 'env = ["sky"]', None, ["[[scene]]"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", 'output = ["x.png"]', None, ["no place in a sweep"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "resolution-scale = [2]", None, ["outside 0..1"]),
            ('path = "box.gltf"', 'path = "bax.gltf"', 'path = "box.gltf"', ["bax.gltf"]),
            ('path = "box.gltf"', 'path = "box.gltf"\nenv = "none.hdr"', None, ["none.hdr"]),
            ('path = "box.gltf"', 'path = "box.gltf"\ncamera = "mian"', None, ["did you mean 'main'"]),
            ('log = "gaze.csv"', 'log = "gone.csv"', 'log = "gaze.csv"', ["gone.csv"]),
            ("at = [0.2, 0.5]", "", None, ["looks nowhere"]),
            ("spp = 16", "spp = 16\nscramblings = 3", None, ["scramblings"]),
            ("spp = 16", "spp = 16\nseed = 1", None, ["seeds", "reference"]),
            ("spp = 16", "target-jod = 9", "spp = 16", ["a reference cannot follow 'target-jod'"]),
            ('"flip", "fov', '"flop", "fov', None, ["did you mean 'flip'"]),
            ('quality = ["flip=0.05", "fovvideovdp=9.5"]', 'quality = ["ssim=0.9"]', None, ["ssim"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", 'gaze-offset = ["0s", "100ms"]', None, ["looks elsewhere", "[[gaze]]"]),
            ("region-samples = [[16, 4, 4], [8, 2, 1]]", "gaze-scale = [1, 2]", None, ["looks elsewhere", "[[gaze]]"]),
            ("repeats = 2", 'leave-out = "10s"', "repeats = 2", ["3 frames", "10 s", "none is scored"]),
            ("repeats = 2", "peak-cd-m2 = -5", "repeats = 2", ["peak-cd-m2", "-5"]),
            ("repeats = 2", "peak-cd-m2 = inf", "repeats = 2", ["peak-cd-m2"]),
            ("repeats = 2", "contrast = 1", "repeats = 2", ["contrast", "above 1"]),
            ("repeats = 2", "ambient-lux = -1", "repeats = 2", ["ambient-lux"]),
            ("repeats = 2", "reflectivity = 1.5", "repeats = 2", ["reflectivity", "0..1"]),
            ("repeats = 2", "relmse-epsilon = -1", "repeats = 2", ["relmse-epsilon"]),
            ('frames = "1-3"', 'frames = "1,3"', None, ["consecutive"]),
            ('title = "a box"', "title = ", 'title = "a box"', ["toml"]),
            ("[grid]", "[[grid]]", None, ["[grid]"]),
        ]
        for old, new, at, words in cases:
            with self.subTest(new=new):
                self.assertIn(old, PLAN)
                self.plan(PLAN.replace(old, new, 1), "bad.toml")
                message = self.assert_refused(["sweep", "bad.toml", "-o", "out"], words)
                if at is not None:
                    self.assertIn(f"bad.toml:{line[at]}:", message)
                else:
                    self.assertIn("bad.toml", message)
        metrics = 'metrics = ["mse", "flip", "fovvideovdp"]'
        # What a metric cannot score is told with the line of the metrics, before anything is rendered.
        for wanted, change, words in [
            ('"flicker"', ("fps = 12", "fps = 12"), ["flicker", "whole seconds", "3 frames at 12"]),
            ('"temporal_bias"', ("fps = 12", "fps = 12"), ["temporal_bias", "whole seconds"]),
            ('"flicker"', ('frames = "1-3"', 'frames = "1"'), ["flicker", "whole seconds"]),
            ('"flicker"', ("fps = 12", "fps = 3"), ["flicker", "3 frames a second"]),
            ('"ms_ssim"', ("fps = 12", "fps = 12"), ["ms_ssim", "176x176", "64x36"]),
            ('"fovvideovdp"', ("fps = 12", "fps = 2"), ["fovvideovdp", "2 frames a second"]),
            ('"hdr_flip"]\nflip-start = 2\nflip-stop = 1\nflip-count = 2\n#', ("fps = 12", "fps = 12"), ["hdr_flip", "not a range"]),
        ]:
            with self.subTest(metrics=wanted, change=change[1]):
                text = PLAN.replace(*change).replace(metrics, f'metrics = ["mse", {wanted}]')
                self.plan(text.replace('quality = ["flip=0.05", "fovvideovdp=9.5"]', ""), "bad.toml")
                message = self.assert_refused(["sweep", "bad.toml", "-o", "out"], words)
                self.assertIn(f"bad.toml:{line[metrics]}:", message)
        # Where the sampling looks may vary; that it does not look there is what is measured.
        self.plan(PLAN.replace("region-samples = [[16, 4, 4], [8, 2, 1]]", 'gaze-latency = ["0s", "100ms"]'))
        self.run_ok("sweep", "plan.toml", "--dry-run")
        self.assert_refused(["sweep", "gone.toml"], ["gone.toml", "cannot be opened"])
        self.assert_refused(["sweep"], ["no plan"])


if __name__ == "__main__":
    harness.main()
