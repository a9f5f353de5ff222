# SPDX-License-Identifier: Apache-2.0
"""Help, version, lists, summaries, where the words go, closed pipes and full disks."""

import csv
import json
import math
import os
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import harness

COMMANDS = ["render", "plan", "scene", "gaze", "merge", "list", "help", "version", "completion", "man"]


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

    def test_no_library_comes_from_the_working_folder(self):
        """A scene that was downloaded may lie beside files of any name."""
        for library in ("libembree3.so.3", "libembree4.so.4", "libtbb.so.12", "libgazetrace_pictures.so", "libOpenImageDenoise.so.2"):
            self.write(library, "no library")
        done = subprocess.run([harness.PROGRAM, "version"], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    RENDER = ["render", "box.gltf", "--size", "64x36", "--spp", "1", "-o", "f.png", "--quiet"]

    def test_a_picture_ends_a_run_in_order(self):
        """With the module of pictures loaded, whose libraries have threads; most tests' runs are forks, which end at once."""
        self.run_ok(*self.RENDER, alone=True)

    def test_a_module_of_another_build_is_passed_over(self):
        module = Path(harness.PROGRAM).parent / "../lib/libgazetrace_pictures.so"
        other, count = re.subn(rb"-[0-9a-f]{64}-[0-9a-f]{64}", b"-" + b"0" * 129, module.read_bytes())
        self.assertEqual(count, 1)
        self.write("other/libgazetrace_pictures.so", other)
        self.run_ok(*self.RENDER, alone=True, environment={"LD_LIBRARY_PATH": str(self.folder / "other")})

    def test_a_module_that_is_missing_is_told_of_before_a_frame(self):
        (self.folder / "bin").mkdir()
        alone = shutil.copy(harness.PROGRAM, self.folder / "bin/gazetrace")
        before = self.files()
        done = subprocess.run([alone, *self.RENDER], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertEqual(self.files(), before)
        self.assertGreaterEqual(done.stderr.count("cannot open shared object file"), 3, "every place is told")

    def test_the_demo_makes_and_names_its_files(self):
        arguments = ["demo", "show", "--data", harness.SOURCE, "--size", "64x36", "--frames", "1-2", "--no-sweep"]
        result = self.run_ok(*arguments)
        for name in ("show/foveated/frame.0002.png", "show/uniform/frame.0002.exr"):
            self.assertIn(name, self.files())
        self.assertIn("show/foveated/frame.####.png", result.stdout)
        self.assertIn("gazetrace render --config", result.stderr)
        self.assertEqual("show/side-by-side.mp4" in self.files(), shutil.which("ffmpeg") is not None)
        self.assert_refused(arguments, ["show", "--overwrite"])
        self.assert_refused(["demo", "other", "--data", "nowhere"], ["nowhere", "example.toml"])

    def test_help_and_version_are_commands(self):
        self.assertEqual(self.run_ok("version").stdout.splitlines(True)[0], self.run_ok("--version").stdout)
        self.assertEqual(self.run_ok("help").stdout, self.run_ok("--help").stdout)
        self.assertEqual(self.run_ok("help", "gaze", "inspect").stdout, self.run_ok("gaze", "inspect", "--help").stdout)
        self.assertIn("render", self.run_program("help", "rendre").stderr)

    def complete(self, script, *words):
        """What bash offers for the last of the words."""
        line = " ".join(words)
        shell = (f"source {script}\nCOMP_WORDS=({' '.join(word or chr(39) * 2 for word in words)})\nCOMP_CWORD={len(words) - 1}\n"
                 f"COMP_LINE='{line}'\n_gazetrace\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"")
        return subprocess.run(["bash", "--norc", "-c", shell], cwd=self.folder, capture_output=True, text=True, check=True).stdout.split()

    def test_completion_in_bash(self):
        self.write("completion.bash", self.run_ok("completion", "bash").stdout)
        complete = lambda *words: self.complete("completion.bash", "gazetrace", *words)
        self.assertEqual(complete("ren"), ["render"])
        self.assertIn("inspect", complete("gaze", ""))
        offered = complete("render", "--region")
        self.assertTrue({"--region-samples", "--region-blocks", "--region-eccentricities"} <= set(offered), offered)
        self.assertTrue(all(word.startswith("--region") for word in offered), offered)
        self.assertEqual(complete("render", "box.gltf", "--density", "geis"), ["geisler-perry"])
        self.assertIn("h264", complete("video", "--codec", ""))
        self.assertEqual(complete("render", "bo"), ["box.gltf"])
        self.assertEqual(complete("gaze", "measure", "--tab"), ["--tables"])
        self.assertIn("report", complete("gaze", ""))
        self.assertIn("--config", complete("plan", "--conf"))
        # What stands by itself, of a family that another command names, and after a comma.
        self.assertEqual(complete("completion", ""), ["bash", "zsh", "fish"])
        self.assertEqual(complete("list", "scr"), ["screens"])
        self.assertIn("ivt-hmd", complete("gaze", "events", "--method", ""))
        self.assertEqual(sorted(complete("compare", "--metrics", "mse,fli")), ["mse,flicker", "mse,flip"])
        self.assertEqual(complete("render", "--aov", "depth,albedo,nor"), ["depth,albedo,normal"])

    def test_completion_offers_each_name_once(self):
        names = re.search(r"'gazetrace render --sampling'\) names='([^']*)'", self.run_ok("completion", "bash").stdout).group(1).split()
        self.assertIn("adaptive", names)
        self.assertEqual(sorted(names), sorted(set(names)))

    def test_completion_names_every_option_in_every_shell(self):
        options = [option["name"] for option in json.loads(self.run_ok("list", "options", "--json").stdout)]
        for shell, form in (("bash", "--{} "), ("zsh", "'--{}:"), ("fish", " -l {} ")):
            script = self.run_ok("completion", shell).stdout
            for option in options:
                if option != "scene":  # which has no dashes
                    self.assertIn(form.format(option), script.replace("'", " '") if shell == "bash" else script)
        self.assertIn("bash, zsh, fish", self.run_program("completion", "tcsh").stderr)

    def test_manual_pages(self):
        self.run_ok("man", "--folder", "man")
        pages = self.files("man")
        for name in ("gazetrace.1", "gazetrace-render.1", "gazetrace-gaze-inspect.1", "gazetrace-farm-status.1"):
            self.assertIn(name, pages)
        for name in pages:  # what was a command once has no page, and all others say what they are for
            self.assertRegex((self.folder / "man" / name).read_text(), r"\n\.SH NAME\n\S+ \\- \S")
        page = self.run_ok("man", "render").stdout
        self.assertEqual(page, (self.folder / "man/gazetrace-render.1").read_text())
        for option in json.loads(self.run_ok("list", "options", "--json").stdout):
            self.assertIn(option["name"].replace("-", "\\-"), page)
        if shutil.which("groff"):
            for name in pages:
                shown = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-P-cbou", name], cwd=self.folder / "man",
                                       capture_output=True, text=True, check=True)
                self.assertEqual(shown.stderr, "", name)
                self.assertIn("NAME", shown.stdout)

    def test_every_option_has_help(self):
        for command in (["render", "--help-all"], ["plan", "--help-all"], ["render", "--help"], ["gaze", "inspect", "--help"],
                        ["gaze", "import", "--help"]):
            lines = self.run_ok(*command).stdout.splitlines()
            options = [i for i, line in enumerate(lines) if re.match(r"  -", line)]
            self.assertGreater(len(options), 10)
            for i in options:
                text = lines[i] + lines[i + 1]
                self.assertRegex(text, r"\s{2,}\S*[A-Za-z0-9].*[a-z]{2,}", text)

    def test_programs_of_their_own_come_first(self):
        for words in (["report"], ["gaze", "report"]):
            self.assert_refused(["--config", "a.toml", *words], ["is a program of its own"])

    def test_lists(self):
        families = json.loads(self.run_ok("list", "--json").stdout)
        self.assertEqual({member["name"] for member in families["samplings"]} >= {"regions", "uniform"}, True)
        self.assertEqual({member["name"] for member in families["filters"]} >= {"none", "linear"}, True)
        self.assertEqual({member["name"] for member in families["screens"]} >= {"paper"}, True)
        self.assertIn("ACES SDR", self.run_ok("list", "views").stdout)
        for name, members in families.items():
            self.assertTrue(members, name)
            self.assertIn(members[0]["name"], self.run_ok("list", name).stdout)

    def test_screens_are_listed_with_their_numbers(self):
        screens = {screen["name"]: screen for screen in json.loads(self.run_ok("list", "screens", "--json").stdout)["screens"]}
        for name, screen in screens.items():
            self.assertIn(f"{screen['width_px']}x{screen['height_px']}", screen["description"], name)
            wide, half_cm = screen["width_px"], screen["width_cm"] / 2
            self.assertAlmostEqual(screen["width_deg"], 2 * math.degrees(math.atan(half_cm / screen["distance_cm"])))
            self.assertAlmostEqual(screen["pixels_per_degree"], wide / 2 / math.degrees(half_cm / screen["distance_cm"]))
        # By the sources that the list names: pixels of one eye, pixels a degree, field, rate.
        for name, numbers in {"quest-3": (2064, 2208, 25, [110, 96], 120), "quest-pro": (1800, 1920, 22, [106, 96], 90),
                              "varjo-xr-4": (3840, 3744, 51, [120, 105], 90), "vision-pro": (3660, 3200, 44.4, [100], 100),
                              "index": (1440, 1600, 15, [130], 144)}.items():
            screen = screens[name]
            self.assertEqual((screen["width_px"], screen["height_px"]), numbers[:2])
            self.assertAlmostEqual(screen["pixels_per_degree"], numbers[2])
            self.assertEqual((screen["headset"]["field_deg"], screen["headset"]["rate_hz"]), numbers[3:])
            self.assertTrue(screen["headset"]["source"])
        # HTC's page of specifications has pixels and rate; FovVideoVDP's htc_vive_pro is a flat screen of 133.3 cd/m2 with 110
        # degrees over its diagonal: sqrt(1440^2 + 1600^2) / (2 tan 55 deg) = 753.63 pixels a radian, 13.153 a degree.
        vive = screens["vive-pro-eye"]
        self.assertEqual((vive["width_px"], vive["height_px"], vive["luminance_cd_m2"]), (1440, 1600, 133.3))
        self.assertEqual((vive["headset"]["field_deg"], vive["headset"]["rate_hz"]), ([110], 90))
        self.assertAlmostEqual(vive["pixels_per_degree"], 13.153, places=3)
        diagonal_cm = math.hypot(vive["width_cm"], vive["height_cm"])
        self.assertAlmostEqual(2 * math.degrees(math.atan(diagonal_cm / 2 / vive["distance_cm"])), 110)
        self.run_ok("plan", "box.gltf", "--size", "64x68", "--screen", "quest-3", "--gaze-at", "0.5,0.5")

    def test_every_listed_name_is_accepted(self):
        families = json.loads(self.run_ok("list", "--json").stdout)
        base = ["render", "box.gltf", "--size", "16x9", "--spp", "1", "--quiet", "--overwrite", "-o", "f.exr", "-o", "f.png",
                "--gaze-at", "0.5,0.5", *harness.SCREEN]
        needs = {"adaptive": ["--spp", "4"]}
        for family, option in (("samplings", "--sampling"), ("densities", "--density"), ("filters", "--filter"), ("views", "--view"), ("aovs", "--aov")):
            for member in families[family]:
                if member["name"] == "oidn" and not json.loads(self.run_ok("version", "--json").stdout)["denoiser"]["path"]:
                    continue  # denoiser_test.py has what is said then
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

    def test_stills_share_a_folder(self):
        job = ["--size", "16x9", "--spp", "1", "--quiet"]
        self.run_ok("render", "box.gltf", "-o", "out/first.exr", "-o", "out/first.png", "--seed", "1", *job)
        self.run_ok("render", "box.gltf", "-o", "out/second.png", "--seed", "2", *job)
        self.assertEqual(self.files("out"), ["first.exr", "first.png", "first.run.json", "first.timing.csv", "second.png",
                                             "second.run.json", "second.timing.csv"])
        for name, seed in (("first", 1), ("second", 2)):
            self.assertIn(f"\nseed = {seed}\n", json.loads((self.folder / f"out/{name}.run.json").read_text())["config_toml"])
        refused = self.run_program("render", "box.gltf", "-o", "out/second.png", *job)
        self.assertIn("out/second.", refused.stderr)
        self.run_ok("render", "box.gltf", "-o", "out/second.png", "--seed", "2", "--resume", *job)

    def test_commands_make_the_folders_of_their_outputs(self):
        self.write("log.csv", harness.moving_gaze())
        self.run_ok("render", "box.gltf", "-o", "a/b/f.exr", "--size", "16x9", "--spp", "1", "--quiet")
        self.run_ok("compare", "a/b/f.exr", "a/b/f.exr", "--metrics", "mse", "--csv", "c/d/scores.csv", "--json", "e/scores.json",
                    "--maps", "f/maps")
        self.run_ok("gaze", "synth", "-o", "g/h/gaze.csv", "--truth", "i/truth.tsv", "--duration", "1s")
        self.run_ok("gaze", "import", "log.csv", "-o", "j/k/copy.csv")
        self.run_ok("gaze", "import", "log.csv", "-o", "l/m/sub-01_task-view_physio.tsv.gz")
        self.run_ok("gaze", "events", "log.csv", "-o", "n/events.tsv")
        self.run_ok("gaze", "inspect", "log.csv", "--save-columns", "p/map.json")
        self.run_ok("gaze", "measure", "log.csv", "--tables", "o/tables")
        self.run_ok("gaze", "report", "log.csv", "-o", "q/page.html")
        self.run_ok("plan", "box.gltf", "--frames", "1-2", "--save-camera", "r/s/path.tum")
        names = self.files()
        for name in ("c/d/scores.csv", "e/scores.json", "g/h/gaze.csv", "i/truth.tsv", "j/k/copy.csv", "n/events.tsv",
                     "o/tables/samples.tsv", "p/map.json", "q/page.html", "r/s/path.tum"):
            self.assertIn(name, names)

    def test_json_has_one_rule(self):
        """--json alone and with - prints on stdout in place of the text; --json FILE.json writes it beside the text."""
        self.write("log.csv", harness.moving_gaze())
        still = ["--size", "16x9", "--spp", "1", "--quiet", "--overwrite"]
        self.run_ok("render", "box.gltf", "-o", "f.exr", *still)
        commands = [["scene", "box.gltf"], ["scene", "box.gltf", "--estimate"], ["list", "filters"], ["list", "options"],
                    ["render", "box.gltf", "-o", "g.exr", *still], ["plan", "box.gltf", "--frames", "1"],
                    ["plan", "--counts", "--gaze-at", "0.5,0.5", "--size", "64x36", *harness.SCREEN],
                    ["compare", "f.exr", "f.exr", "--metrics", "mse"], ["gaze", "inspect", "log.csv"],
                    ["gaze", "events", "log.csv"],
                    ["gaze", "measure", "log.csv"],
                    ["gaze", "import", "log.csv", "-o", "c.csv", "--overwrite"],
                    ["gaze", "synth", "-o", "s.csv", "--duration", "1s", "--overwrite"]]
        for command in commands:
            with self.subTest(command=command):
                json.loads(self.run_ok(*command, "--json").stdout)
                beside = self.run_ok(*command, "--json", "new/result.json").stdout
                self.assertFalse(beside.startswith(("{", "[")), beside)
                json.loads((self.folder / "new/result.json").read_text())
                (self.folder / "new/result.json").unlink()
        command = ["compare", "f.exr", "f.exr", "--metrics", "mse", "--json"]
        json.loads(self.run_ok(*command, "-").stdout)
        self.assertNotIn("-", self.files())
        self.run_ok(*command, "new/result.json")
        refused = self.run_program(*command, "new/result.json")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("new/result.json", refused.stderr)
        self.run_ok(*command, "new/result.json", "--overwrite")
        # What follows is its file only where it looks like one.
        json.loads(self.run_ok("scene", "--json", "box.gltf").stdout)
        for command in (["merge"], ["sweep"], ["report"], ["video"], ["farm", "status"], ["gaze", "trials"], ["gaze", "aois"],
                        ["gaze", "objects"]):
            self.assertRegex(self.run_ok(*command, "--help").stdout, r"--json \[FILE\]", command)

    def test_progress_as_json(self):
        job = ["render", "box.gltf", "-o", "f.####.exr", "--frames", "1-3", "--size", "16x9", "--spp", "1", "--overwrite",
               "--gaze-max-age", "1s"]
        result = self.run_ok(*job, "--progress", "json")
        events = [json.loads(line) for line in result.stderr.splitlines()]
        self.assertEqual([event["event"] for event in events], ["begin", "warning", "frame", "frame", "frame", "end"])
        self.assertEqual((events[0]["frames"], events[0]["count"]), ("1-3", 3))
        self.assertEqual([event["frame"] for event in events[2:5]], [1, 2, 3])
        self.assertIn("--gaze-max-age", events[1]["text"])
        self.assertEqual((events[-1]["exit_code"], events[-1]["rendered"]), (0, 3))
        failed = self.run_program("render", "gone.gltf", "-o", "g.exr", "--progress", "json")
        self.assertEqual(failed.returncode, 2)
        (end,) = [json.loads(line) for line in failed.stderr.splitlines()]
        self.assertEqual((end["event"], end["exit_code"]), ("end", 2))
        self.assertIn("gone.gltf", end["error"])
        read, write = os.pipe()
        process = subprocess.run([harness.PROGRAM, *job, "--progress", f"json:{write}"], cwd=self.folder, pass_fds=[write],
                                 capture_output=True, text=True, check=True)
        os.close(write)
        with os.fdopen(read) as stream:
            self.assertEqual([json.loads(line)["event"] for line in stream][-1], "end")
        self.assertIn("3 frames", process.stderr)
        self.assert_refused([*job, "--progress", "json:77"], ["--progress", "77"])

    def test_a_name_of_both_families(self):
        """linear is a density and a filter; help and errors say which option takes what."""
        self.assert_refused(["render", "box.gltf", "-o", "f.exr", "--filter", "quadric"], ["filter", "give --density"])
        self.assert_refused(["render", "box.gltf", "-o", "f.exr", "--density", "guided"], ["density", "give one of these"])
        text = " ".join(self.run_ok("render", "--help-all").stdout.split())
        self.assertIn("--density decides where samples go; its 'linear' is another one", text)

    def test_each_aov_is_described(self):
        members = json.loads(self.run_ok("list", "aovs", "--json").stdout)["aovs"]
        for member in members:
            self.assertGreater(len(member["description"]), 20, member["name"])
        words = {member["name"]: member["description"] for member in members}
        for name, word in (("normal", "world"), ("depth", "metres"), ("variance", "mean"), ("eccentricity", "degrees")):
            self.assertIn(word, words[name])

    def test_configs_within_opencolorio(self):
        result = self.run_program("render", "box.gltf", "-o", "f.png", "--size", "16x9", "--spp", "1", "--ocio", "ocio://default")
        if result.returncode != 0:  # before OpenColorIO 2.2
            self.assertIn("2.2", result.stderr)
            self.assertIn("as a file", result.stderr)

    def test_the_summary_says_what_the_timing_says(self):
        done = self.run_ok("render", "--config", str(harness.SOURCE / "examples" / "example.toml"), "--size", "160x90", "--frames", "1-2", "-o", "f.####.exr")
        with open(self.folder / "f.timing.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        seconds = sum(float(row["trace_ms"]) for row in rows) / 1000
        samples = sum(int(row["samples"]) for row in rows)
        rays = sum(int(row[kind]) for row in rows for kind in ("rays_primary", "rays_bounce", "rays_shadow"))
        told = re.search(r"([0-9.]+) M samples/s and ([0-9.]+) M rays/s", done.stdout + done.stderr)
        self.assertAlmostEqual(float(told.group(1)), samples / seconds / 1e6, delta=0.006)
        self.assertAlmostEqual(float(told.group(2)), rays / seconds / 1e6, delta=0.006)
        stages = re.search(r"mean ms a frame: (.*)", done.stdout + done.stderr).group(1)
        told_ms = {name: float(ms) for name, ms in (part.split() for part in stages.split(", "))}
        self.assertAlmostEqual(told_ms["trace"], 500 * seconds, delta=0.06)
        columns = list(rows[0])
        self.assertEqual(list(told_ms), [column[:-3] for column in columns[1 : columns.index("total_ms") + 1]])

    def test_nothing_to_save_is_told(self):
        gaze = ["--gaze-at", "0.5,0.5", "--screen-px", "1920,1080", "--screen-cm", "60,34", "--screen-distance-cm", "60", "--density",
                "geisler-perry"]
        small = self.run_ok("plan", "box.gltf", *gaze, "--size", "160x90", "--frames", "1").stderr
        self.assertIn("--density geisler-perry saves only 1.0", small)
        self.assertIn("relative-to=fovea", small)
        self.assertIn("saves only", self.run_ok("render", "box.gltf", *gaze, "--size", "160x90", "-o", "f.exr").stderr)
        self.assertNotIn("saves only", self.run_ok("plan", "box.gltf", *gaze, "--size", "1920x1080", "--frames", "1").stderr)

    def test_replaying_a_pixel(self):
        self.run_ok("render", "box.gltf", "-o", "f.exr", "--exr-pixels", "float", "--size", "32x18", "--spp", "8", "--quiet")
        text = self.run_ok("render", "box.gltf", "--size", "32x18", "--spp", "8", "--quiet", "--only-frame", "1",
                           "--only-pixel", "16,9").stdout
        self.assertRegex(text, r"^frame 1 pixel 16,9: radiance \S+ \S+ \S+, samples 8,")
        self.assertNotIn("radiance 0 0 0", text)
        self.assertEqual(self.files(), ["box.gltf", "f.exr", "f.run.json", "f.timing.csv"])

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
        self.run_ok("gaze", "import", "log.csv", "-o", "copy.csv")
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
        self.assertIn("sky", json.loads((self.folder / "f.run.json").read_text())["facts"]["environment"])
        self.assertIn("environment: none", self.run_ok("render", "box.gltf", *job).stderr)

    def test_run_record_repeats_the_run(self):
        self.write("log.csv", harness.moving_gaze())
        self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--frames", "2-3", "--size", "64x36", "--seed", "9", "-o",
                    "a/f.####.exr", "--quiet")
        record = json.loads((self.folder / "a/f.run.json").read_text())
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
            result = subprocess.run([harness.PROGRAM, "list", "densities"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        self.assertEqual(result.returncode, 3)
        self.assertEqual(len(result.stderr.splitlines()), 1)


if __name__ == "__main__":
    harness.main()
