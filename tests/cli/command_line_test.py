# SPDX-License-Identifier: Apache-2.0
"""What the command line makes of names that are unknown or old, of options given twice, and of help."""

import json
import re

import harness


class UnknownNames(harness.CliTest):
    def test_help_for_a_command_that_does_not_exist_names_the_nearest(self):
        self.assert_refused(["studdy", "--help"], ["unknown command 'studdy'"])
        self.assert_refused(["rendr", "--help"], ["unknown command 'rendr'", "did you mean 'render'?"])
        self.assert_refused(["gaze", "inspekt", "--help"], ["unknown command 'inspekt'", "did you mean 'inspect'"])
        for words in (["--help"], ["render", "--help"], ["gaze", "--help"], ["gaze", "inspect", "--help"], ["--version"]):
            self.run_ok(*words)

    def test_an_option_before_the_command_is_told_to_stand_after_it(self):
        self.assert_refused(["--size", "96x54", "render", "box.gltf"],
                            ["'--size' stands before the command", "'gazetrace render --size ...'"])

    def test_names_of_other_programs_are_known(self):
        for name, hint in (("--samples", "--spp"), ("--denoise", "--filter"), ("--width", "--size"), ("--resolution", "--size")):
            with self.subTest(name=name):
                self.assert_refused(["render", "box.gltf", name, "8"], [f"{name}: there is no such option", hint])
                self.assert_refused(["plan", name, "8", "box.gltf"], [f"{name}: there is no such option", hint])
        self.assert_refused(["version", "--samples", "8"], ["unknown option '--samples'"])

    def test_former_options_are_a_page(self):
        page = self.run_ok("help", "former-options").stdout
        self.assertRegex(page, r"(?m)^--samples +there is no such option; the number of samples a pixel is --spp$")


class Help(harness.CliTest):
    def options(self, text):
        """The option or positional of each line that begins one."""
        found = re.findall(r"(?m)^  (?:-\w,)?(?:--)?([a-z][a-z-]+)(?=[ ,\n])", text)
        return [name for name in found if name != "gazetrace"]

    def test_render_has_twenty_options_and_one_example_that_runs(self):
        text = self.run_ok("render", "-h").stdout
        self.assertEqual(len(self.options(text)), 20, self.options(text))
        example = re.search(r"(?m)^Example:\n  gazetrace (.+)$", text).group(1).split()
        scene = example.index("scenes/courtyard/courtyard.gltf")
        example[scene] = str(harness.SOURCE / example[scene])
        self.run_ok(*example, "--size", "32x18", "--quiet")
        self.assertTrue((self.folder / "out" / "frame.png").exists())

    def test_all_options_are_on_one_of_two_pages(self):
        listed = [option["name"] for option in json.loads(self.run_ok("list", "options", "--json").stdout)]
        everything = self.options(self.run_ok("render", "--help-all").stdout)
        farm = re.findall(r"(?m)^  --([a-z-]+)", self.run_ok("help", "farm-options").stdout)
        self.assertIn("chunk", farm)
        self.assertNotIn("spp", farm)
        self.assertEqual(set(listed), set(everything + farm) - {"help", "help-all", "print-config", "json"})
        self.assertEqual(set(everything) & set(farm), set())
        told = int(re.search(r"--help-all prints (\d+) options", self.run_ok("render", "--help").stdout).group(1))
        self.assertEqual(told, len(set(listed) - set(farm)))
        shown = self.options(self.run_ok("render", "--help").stdout)
        self.assertLess(set(shown), set(everything))
        for command in (["plan"], ["gaze", "objects"], ["gaze", "aois"]):
            self.assertLess(len(self.run_ok(*command, "--help").stdout), len(self.run_ok(*command, "--help-all").stdout) / 3)
        self.assertEqual(self.run_ok("help", "render").stdout, self.run_ok("render", "--help").stdout)
        for page in ("farm-options", "former-options"):
            self.assert_refused(["help", page, "extra"], [page])


class GivenTwice(harness.CliTest):
    def test_the_last_one_wins(self):
        text = self.run_ok("render", "--spp", "3", "--size", "8x8", "--spp=5", "--size", "64x36", "--region-samples", "4,2,1",
                           "--region-samples", "8,4,2", "--guiding", "--no-guiding", "--overwrite", "--overwrite",
                           "--print-config").stdout
        for line in ("spp = 5", 'size = "64x36"', "region-samples = [8, 4, 2]", "guiding = false", "overwrite = true"):
            self.assertIn(f"\n{line}\n", text)
        self.assertIn("\nguiding = true\n", self.run_ok("render", "--no-guiding", "--guiding", "--print-config").stdout)

    def test_what_may_be_repeated_keeps_all_values(self):
        text = self.run_ok("render", "-o", "a.####.exr", "-o", "b.####.png", "--print-config").stdout
        self.assertIn('\noutput = ["a.####.exr", "b.####.png"]\n', text)

    def test_other_commands_as_well(self):
        self.run_ok("scene", "box.gltf", "--json", "--json=scene.json")
        self.assertTrue((self.folder / "scene.json").exists())


if __name__ == "__main__":
    harness.main()
