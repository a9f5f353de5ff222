# SPDX-License-Identifier: Apache-2.0
"""Help, version, lists, summaries, where the words go, closed pipes and full disks."""

import json
import os
import re
import subprocess
import unittest

import harness

COMMANDS = ["render", "plan", "scene", "gaze", "merge", "list"]


class Talk(harness.CliTest):
    def test_version_and_help(self):
        self.assertRegex(self.run_ok("--version").stdout, r"^gazetrace \d+\.\d+\.\d+\n$")
        text = self.run_ok("--help").stdout
        for word in [*COMMANDS, "Exit codes", "0 done", "1 compared", "2 usage", "3 failed"]:
            self.assertIn(word, text)
        for command in COMMANDS:
            result = self.run_ok(command, "--help")
            self.assertIn("Exit codes", result.stdout)
            self.assertEqual(result.stderr, "")

    def test_every_option_has_help(self):
        for command in (["render"], ["plan"], ["gaze", "inspect"], ["gaze", "convert"]):
            lines = self.run_ok(*command, "--help").stdout.splitlines()
            options = [i for i, line in enumerate(lines) if re.match(r"  -", line)]
            self.assertGreater(len(options), 10)
            for i in options:
                text = lines[i] + lines[i + 1]
                self.assertRegex(text, r"\s{2,}\S*[A-Za-z0-9].*[a-z]{2,}", text)

    def test_lists(self):
        families = json.loads(self.run_ok("list", "--json").stdout)
        self.assertEqual({member["name"] for member in families["falloffs"]} >= {"regions", "uniform"}, True)
        self.assertEqual({member["name"] for member in families["filters"]} >= {"none", "linear"}, True)
        self.assertEqual({member["name"] for member in families["screens"]} >= {"paper"}, True)
        self.assertIn("ACES SDR", self.run_ok("list", "views").stdout)
        for name, members in families.items():
            self.assertTrue(members, name)
            self.assertIn(members[0]["name"], self.run_ok("list", name).stdout)

    def test_every_listed_name_is_accepted(self):
        families = json.loads(self.run_ok("list", "--json").stdout)
        self.write("table.csv", "ecc_deg,density\n0,1\n30,0.1\n")
        base = ["render", "box.gltf", "--size", "16x9", "--spp", "1", "--quiet", "--overwrite", "-o", "f.exr", "-o", "f.png",
                "--gaze-at", "0.5,0.5", *harness.SCREEN]
        self.run_ok("render", "box.gltf", "--size", "4x4", "--spp", "1", "--quiet", "-o", "rates.exr")
        needs = {"table": ["--falloff-table", "table.csv"], "map": ["--density-map", "rates.exr"], "visible": ["--budget-spp", "4"]}
        for family, option in (("falloffs", "--falloff"), ("filters", "--filter"), ("views", "--view"), ("aovs", "--aov")):
            for member in families[family]:
                with self.subTest(option=option, name=member["name"]):
                    more = needs.get(member["name"], [])
                    self.run_ok(*base, option, member["name"], *more)

    def test_results_on_stdout_and_the_rest_on_stderr(self):
        arguments = ["render", "box.gltf", "-o", "f.####.exr", "--size", "32x18", "--spp", "2", "--frames", "1-3"]
        result = self.run_ok(*arguments)
        self.assertEqual(result.stdout, "")
        self.assertIn("frame 3 done", result.stderr)
        self.assertIn("3 frames", result.stderr)
        self.assertNotIn("\r", result.stderr)
        self.assertIn("\r[", self.run_ok(*arguments, "--overwrite", "--progress", "always").stderr)
        self.assertNotIn("frame 3", self.run_ok(*arguments, "--overwrite", "--progress", "never").stderr)
        quiet = self.run_ok(*arguments, "--overwrite", "--quiet", "--json")
        self.assertEqual(quiet.stderr, "")
        self.assertEqual(json.loads(quiet.stdout)["rendered"], 3)

    def test_replaying_a_pixel(self):
        self.run_ok("render", "box.gltf", "-o", "f.exr", "--exr-pixels", "float", "--size", "32x18", "--spp", "8", "--quiet")
        text = self.run_ok("render", "box.gltf", "--size", "32x18", "--spp", "8", "--quiet", "--only-frame", "1",
                           "--only-pixel", "16,9").stdout
        self.assertRegex(text, r"^frame 1 pixel 16,9: radiance \S+ \S+ \S+, samples 8,")
        self.assertNotIn("radiance 0 0 0", text)
        self.assertEqual(self.files(), ["box.gltf", "f.exr", "run.json", "timing.csv"])

    def test_scene_summary(self):
        summary = json.loads(self.run_ok("scene", "box.gltf", "--bvh", "--json").stdout)
        self.assertEqual((summary["triangles_unique"], summary["triangles_instanced"]), (12, 24))
        self.assertEqual(summary["cameras"][0]["name"], "main")
        self.assertGreater(summary["bvh_bytes"], 0)
        text = self.run_ok("scene", "box.gltf").stdout
        for word in ("12 unique", "24 instanced", "KHR_lights_punctual", "'main'", "still"):
            self.assertIn(word, text)

    def test_gaze_summary_and_conversion(self):
        self.write("log.csv", harness.moving_gaze())
        summary = json.loads(self.run_ok("gaze", "inspect", "log.csv", "--json").stdout)
        self.run_ok("gaze", "convert", "log.csv", "-o", "copy.csv")
        self.assertEqual((summary["samples"], summary["first_ns"], summary["last_ns"]), (100, 0, 990_000_000))
        self.assertEqual(summary["median_rate_hz"], 100.0)
        copy = json.loads(self.run_ok("gaze", "inspect", "copy.csv", "--json").stdout)
        for key in summary:
            if key != "source":
                self.assertEqual(summary[key], copy[key], key)

    def test_plan(self):
        self.write("log.csv", harness.moving_gaze())
        arguments = ["plan", "box.gltf", "--gaze", "log.csv", "--size", "64x36", "--frames", "1-3"]
        plan = json.loads(self.run_ok(*arguments, "--json").stdout)
        self.assertEqual(len(plan["frames"] if isinstance(plan, dict) else plan), 3)
        self.assertIn("hold", self.run_ok(*arguments).stdout)
        self.assertEqual(self.files(), ["box.gltf", "log.csv"])

    def test_eccentricity_survives_a_gap_in_the_gaze(self):
        rows = [f"{i * 10_000_000},0.5,0.5,{'ok' if i < 20 else 'lost'},left" for i in range(100)]
        self.write("log.csv", harness.gaze_csv(rows))
        result = self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--gaze-missing", "uniform", "--gaze-max-age", "50ms",
                             "--frames", "1-12x11", "--fps", "24", "--size", "64x36", "--spp", "1", "--aov", "eccentricity",
                             "-o", "f.####.exr", "--map", "m.####.exr")
        self.assertIn("1 frames without gaze", result.stderr)
        self.assertEqual(len(self.pictures(".")), 4)

    def test_scenes_without_light_get_the_sky(self):
        gltf = harness.box_gltf()
        gltf["nodes"][3].pop("extensions")
        for key in ("extensions", "extensionsUsed"):
            gltf.pop(key)
        self.write("dark.gltf", json.dumps(gltf))
        job = ["-o", "f.exr", "--size", "16x9", "--spp", "1", "--overwrite"]
        self.assertIn("environment: the built-in sky", self.run_ok("render", "dark.gltf", *job).stderr)
        self.assertIn("sky", json.loads((self.folder / "run.json").read_text())["facts"]["environment"])
        self.assertIn("environment: none", self.run_ok("render", "box.gltf", *job).stderr)

    def test_run_record_repeats_the_run(self):
        self.write("log.csv", harness.moving_gaze())
        self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--frames", "2-3", "--size", "64x36", "--seed", "9", "-o",
                    "a/f.####.exr", "--quiet")
        record = json.loads((self.folder / "a/run.json").read_text())
        self.assertEqual((record["frames"], record["facts"]["state"]), ("2-3", "done"))
        self.assertEqual(len(record["input_digests"]), 2)
        self.write("again.toml", record["config_toml"])
        self.run_ok("render", "--config", "again.toml", "-o", "b/f.####.exr")
        self.assertEqual(self.pictures("a"), self.pictures("b"))


class Streams(harness.CliTest):
    def test_a_reader_that_goes_away_is_no_error(self):
        for arguments in (["list"], ["render", "--help"], ["render", "--print-config"]):
            read, write = os.pipe()
            os.close(read)
            result = subprocess.run([harness.PROGRAM, *arguments], stdout=write, stderr=subprocess.PIPE, check=False)
            os.close(write)
            self.assertEqual((result.returncode, result.stderr), (0, b""), arguments)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full")
    def test_a_full_disk_is_a_failure(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([harness.PROGRAM, "list", "falloffs"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(result.returncode, 3)
        self.assertEqual(len(result.stderr.splitlines()), 1)


if __name__ == "__main__":
    harness.main()
