# SPDX-License-Identifier: Apache-2.0
"""Open Image Denoise: where it is looked for, what records say of it, and what happens without it."""

import json
import os

import harness

VARIABLE = "GAZETRACE_OIDN_LIBRARY"
STILL = ["--sampling", "uniform", "--spp", "1", "--size", "32x18", "--frames", "1"]


class Denoiser(harness.CliTest):
    def record(self, name):
        return json.loads((self.folder / name).read_text())

    def test_what_cannot_be_used_is_named(self):
        self.write("libOpenImageDenoise.so.2", "no library")
        for wrong in ("/nowhere/lib.so", str(self.folder)):
            given = {"environment": {VARIABLE: wrong}}
            for chosen in ("oidn", "auto"):
                self.assert_refused(["render", "box.gltf", *STILL, "--filter", chosen, "-o", "a.exr"],
                                    [f"{VARIABLE}={wrong}", "cannot be used"], **given)
            self.assertIn(f"{VARIABLE}={wrong}", self.run_ok("version", **given).stdout)
        self.run_ok("render", "box.gltf", *STILL, "--filter", "guided", "-o", "guided.exr", **given)

    def test_without_it_guided_takes_its_place_and_says_so(self):
        none = {"environment": {VARIABLE: ""}}
        done = self.run_ok("render", "box.gltf", *STILL, "-o", "a.exr", **none)
        lines = [line for line in done.stderr.splitlines() if "Open Image Denoise" in line]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertIn("guided", lines[0])
        self.assertIn("JOD", lines[0])
        self.assertEqual(self.record("a.run.json")["denoiser"], "")
        self.assert_refused(["render", "box.gltf", *STILL, "--filter", "oidn", "-o", "b.exr"],
                            ["Open Image Denoise was not found"], **none)
        self.assertIn("denoiser: none", self.run_ok("version", **none).stdout)

    def test_no_sequence_is_made_by_two_denoisers(self):
        sequence = ["render", "box.gltf", "--sampling", "uniform", "--spp", "1", "--size", "32x18", "--filter", "guided", "-o", "f.####.exr"]
        self.run_ok(*sequence, "--frames", "1-2")
        record = self.record("f.run.json")
        record["denoiser"] = "Open Image Denoise 2.3.3, quality high, built-in weights, avx2"
        self.write("f.run.json", json.dumps(record))
        (self.folder / "f.0002.exr").unlink()
        self.assert_refused([*sequence, "--frames", "1-2", "--resume"], ["f.run.json", "Open Image Denoise 2.3.3", "'none'"])
        self.assertFalse((self.folder / "f.0002.exr").exists())
        self.run_ok(*sequence, "--frames", "1-2", "--overwrite")

    def test_pictures_are_compared_and_looked_at_without_it(self):
        if not json.loads(self.run_ok("version", "--json").stdout)["denoiser"]["path"]:
            self.skipTest("Open Image Denoise was not found")
        self.run_ok("render", "box.gltf", *STILL, "--filter", "oidn", "-o", "a.exr")
        none = {"environment": {VARIABLE: ""}}
        self.run_ok("compare", "a.exr", "a.exr", **none)
        self.assert_refused(["render", "box.gltf", *STILL, "--filter", "guided", "-o", "a.exr", "--resume"],
                            ["--filter was oidn and is guided"], **none)

    def test_where_it_is_found_it_is_the_choice_and_in_the_record(self):
        found = json.loads(self.run_ok("version", "--json").stdout)["denoiser"]
        if not found["path"]:
            self.skipTest("Open Image Denoise was not found")
        self.run_ok("render", "box.gltf", *STILL, "-o", "a.exr")
        record = self.record("a.run.json")
        self.assertIn(f"Open Image Denoise {found['version']}", record["denoiser"])
        self.assertIn('filter = "oidn"', record["config_toml"])
        folder = {"environment": {VARIABLE: os.path.dirname(found["path"])}}
        self.assertEqual(json.loads(self.run_ok("version", "--json", **folder).stdout)["denoiser"], found)


if __name__ == "__main__":
    harness.main()
