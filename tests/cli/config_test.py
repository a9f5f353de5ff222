# SPDX-License-Identifier: Apache-2.0
"""Settings files: whatever was set on the command line comes back the same from the file it was written to."""

import json

import harness


class RoundTrip(harness.CliTest):
    def print_config(self, *arguments):
        return self.run_ok("render", *arguments, "--print-config").stdout

    def check(self, *arguments):
        text = self.print_config(*arguments)
        self.write("job.toml", text)
        self.assertEqual(self.print_config("--config", "job.toml"), text)
        return text

    def test_defaults(self):
        text = self.check()
        self.assertIn("# gaze = (not set)", text)
        self.assertIn('fps = 24', text)

    def test_hard_text(self):
        for name in ["a#b.gltf", "a b.gltf", 'say "hi".gltf', "it's.gltf", "back\\slash.gltf", "[x]", "a,b", "a=b", "# x",
                     "tab\there", "007", "1e5", "true", "ümläut.gltf", "-", "''", '"""', "%s{}", "{}", " lead", "trail "]:
            with self.subTest(name=name):
                text = self.check("--gaze", name, "-o", name + "####.exr", "-o", "b.####.png", "--camera", name)
                self.assertEqual(text.count("\ncamera = "), 1)

    def test_every_kind_of_value(self):
        text = self.check(
            "scene.gltf", "--env", "constant:1,2,3", "--env-ev", "-1.25", "--eye", "-9,2,0", "--target", "1e-7,3.5,0",
            "--gaze-at", "-0.1,1.5", "--gaze-max-age", "1500us", "--gaze-offset", "-3ns", "--gaze-start", "12345678901234567ns",
            "--screen-px", "3840,2160", "--screen-cm", "70.848,39.852", "--size", "640x360", "--fps", "24000/1001",
            "--frames", "1-100x2,301", "--region-samples", "4,2,1", "--region-eccentricities", "2.6,8.5", "--exposure", "auto-0.5", "--seed", "18446744073709551615", "--overwrite", "--aov", "albedo,depth",
            "--frame-rect", "0,0,64,36", "--only-pixel", "3,4", "--russian-roulette",
            "--clamp-indirect", "2.5")
        for line in ['eye = [-9, 2, 0]', 'gaze-max-age = "1500us"', 'gaze-start = "12345678901234567ns"',
                     'seed = "18446744073709551615"', 'aov = ["albedo", "depth"]', 'overwrite = true', 'exposure = "auto-0.5"',
                     'size = "640x360"', 'clamp-indirect = 2.5', 'scene = "scene.gltf"', 'env-ev = -1.25']:
            self.assertIn("\n" + line + "\n", text)

    def test_equal_values_have_equal_text(self):
        self.assertEqual(self.print_config("--gaze-max-age", "0.25s", "--exposure", "1.0"),
                         self.print_config("--gaze-max-age", "250ms", "--exposure", "1"))

    def test_command_line_wins(self):
        self.write("job.toml", 'spp = 7\nframes = "1-9"\noverwrite = true\n')
        text = self.print_config("--config", "job.toml", "--spp", "3")
        self.assertIn("\nspp = 3\n", text)
        self.assertIn('\nframes = "1-9"\n', text)
        self.assertIn("\noverwrite = true\n", text)
        self.assertIn("\noverwrite = false\n", self.print_config("--config", "job.toml", "--overwrite=false"))

    def test_a_preset_on_the_command_line_stands_above_the_file_and_below_other_options(self):
        self.write("job.toml", 'bounces = 5\nfilter = "none"\n')
        text = self.print_config("--config", "job.toml", "--preset", "paper", "--filter", "guided")
        self.assertIn("\nbounces = 3\n", text)
        self.assertIn('\nfilter = "guided"\n', text)
        self.write("job.toml", 'bounces = 5\npreset = "paper"\n')
        text = self.print_config("--config", "job.toml")
        self.assertIn("\nbounces = 5\n", text)
        self.assertIn('\nsampling = "regions:shape=disc"\n', text)

    def test_what_was_replaced_is_told_and_recorded(self):
        self.write("job.toml", 'scene = "box.gltf"\n\nbounces = 5\n')
        said = self.run_ok("render", "--config", "job.toml", "--preset", "paper", "--size", "16x9", "--spp", "1", "--frames", "1",
                           "-o", "out/f.exr").stderr
        words = "preset paper from the command line replaces bounces = 5 of job.toml:3"
        self.assertIn(words, said)
        self.assertIn(words, (self.folder / "out" / "f.run.json").read_text())

    def test_only_frame_is_frames(self):
        self.assertIn("\nframes = 7\n", self.print_config("--only-frame", "7"))

    def test_job_from_a_file_renders(self):
        self.write("job.toml", self.print_config("box.gltf", "-o", "out/f.####.exr", "--size", "32x18", "--spp", "2",
                                                 "--frames", "1-2", "--quiet"))
        self.run_ok("--config", "job.toml", "render")
        self.assertEqual(self.files("out"), ["f.0001.exr", "f.0002.exr", "f.run.json", "f.timing.csv"])
        self.run_ok("plan", "--config", "job.toml")


class Refused(harness.CliTest):
    def refuse(self, text, words):
        self.write("job.toml", text)
        self.assert_refused(["render", "box.gltf", "--config", "job.toml", "-o", "f.exr"], words)

    def test_paths_begin_in_the_folder_of_the_settings(self):
        (self.folder / "jobs" / "scenes").mkdir(parents=True)
        (self.folder / "box.gltf").rename(self.folder / "jobs" / "scenes" / "room.gltf")
        self.write("jobs/log.csv", harness.moving_gaze())
        self.write("jobs/job.toml", 'scene = "scenes/room.gltf"\ngaze = "log.csv"\nsize = "16x9"\nspp = 1\nframes = "1"\n'
                                    'env = "none"\noutput = "out/f.####.exr"\n')
        for config in ("jobs/job.toml", self.folder / "jobs" / "job.toml"):
            said = self.run_ok("render", "--config", config, "--overwrite").stderr
            self.assertNotIn("warning: jobs/job.toml", said)
        self.assertIn("out/f.0001.exr", self.files())  # what is written lies where the program was started
        record = json.loads((self.folder / "out/f.run.json").read_text())
        self.assertIn('scene = "jobs/scenes/room.gltf"', record["config_toml"])
        self.assertNotIn(str(self.folder), record["config_toml"])
        # A record has the paths of its run, wherever it lies.
        self.run_ok("compare", "out/f.####.exr", "out/f.####.exr", "--metrics", "mse")

    def test_a_path_that_begins_where_the_program_was_started_is_taken_with_a_warning(self):
        self.write("jobs/job.toml", 'scene = "box.gltf"\nsize = "16x9"\nspp = 1\noutput = "out/f.exr"\n')
        said = self.run_ok("render", "--config", "jobs/job.toml").stderr
        self.assertIn("warning: jobs/job.toml:1: scene: 'jobs/box.gltf' is not there, and 'box.gltf'", said)
        self.write("jobs/job.toml", 'scene = "gone.gltf"\noutput = "out/g.exr"\n')
        self.assert_refused(["render", "--config", "jobs/job.toml"], ["jobs/gone.gltf"])

    def test_mistakes_have_file_and_line(self):
        self.refuse("\nspp = 3\nregion-sampels = [1, 2, 3]\n", ["job.toml:3", "region-sampels", "region-samples"])
        self.refuse("spp = 3\nspp = 4\n", ["job.toml:2"])
        self.refuse("spp = \n", ["job.toml:1"])
        self.refuse("\n\nspp = \"many\"\n", ["job.toml:3", "spp", "many"])
        self.refuse("spp = [1, 2]\n", ["job.toml:1", "spp"])
        self.refuse("size = 1979-05-27\n", ["job.toml:1"])
        self.refuse("[render]\nspp = 3\n", ["job.toml:1", "render"])
        self.refuse("config = \"x\"\n", ["job.toml:1", "config"])
        self.refuse("overwrite = 3\n", ["job.toml:1", "overwrite"])

    def test_missing_file(self):
        self.assert_refused(["render", "--config", "gone.toml"], ["gone.toml"])
        self.assert_refused(["render", "--config", "."], ["."])

    def test_commands_without_settings(self):
        self.write("job.toml", "spp = 3\n")
        self.assert_refused(["scene", "box.gltf", "--config", "job.toml"], ["--config"])


if __name__ == "__main__":
    harness.main()
