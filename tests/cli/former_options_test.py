# SPDX-License-Identifier: Apache-2.0
"""Options of the version before: what they are now, what stands beside them, and which commands tell of them."""

import json

import harness


class FormerOptions(harness.CliTest):
    def settings(self, *arguments):
        """What `render` makes of these, as lines of a settings file, and its words."""
        result = self.run_ok("render", *arguments, "--print-config")
        return dict(line.split(" = ", 1) for line in result.stdout.splitlines() if " = " in line), result.stderr

    def test_one_option_that_is_many_words_now(self):
        for before, now in {
            "--region-shape disc": {"sampling": '"regions:shape=disc"'},
            "--sample-unit pixel --region-shape disc": {"sampling": '"regions:shape=disc,unit=pixel"'},
            "--sample-unit pixel --falloff regions": {"sampling": '"regions:unit=pixel"'},
            "--sample-unit pixel --falloff mar": {"sampling": '"density"', "density": '"mar"'},
            "--region-shape disc --angle-reading eccentricity": {"sampling": '"regions:shape=disc-by-radius"', "region-eccentricities": "[5.2, 17]"},
            "--region-angles 4,10": {"region-eccentricities": "[2, 5]"},
            "--region-angles 4,10 --angle-reading full-angle": {"region-eccentricities": "[2, 5]"},
            "--region-angles 4,10 --angle-reading eccentricity": {"region-eccentricities": "[4, 10]"},
            "--falloff mar --falloff-mar-slope 0.03 --falloff-normalisation relative": {"density": '"mar:slope=0.03,relative-to=fovea"'},
            "--falloff-mar-foveal 0.02 --falloff-mar-slope 0.03 --falloff mar": {"density": '"mar:slope=0.03,foveal=0.02"'},
            "--falloff linear --falloff-ramp 4,20,0.2": {"density": '"linear:inner=4,outer=20,least=0.2"'},
            "--falloff csf --falloff-contrast 0.5 --falloff-luminance 40 --falloff-eye left": {"density": '"csf:contrast=0.5,luminance=40,eye=left"'},
            "--falloff log-polar --falloff-log-polar-sigma 2 --falloff-log-polar-alpha 3": {"density": '"log-polar:sigma=2,alpha=3"'},
            "--falloff csf --falloff-mar-slope 0.03": {"density": '"csf"'},
            "--falloff map --density-map d.exr": {"density": '"d.exr"'},
        }.items():
            with self.subTest(before=before):
                words = before.split()
                settings, said = self.settings(*words)
                self.assertEqual({name: settings[name] for name in now}, now)
                for flag in words[::2]:
                    self.assertIn(f"warning: {flag} ", said)
                self.write("old.toml", "".join(f'{words[i][2:]} = "{words[i + 1]}"\n' for i in range(0, len(words), 2)))
                settings, said = self.settings("--config", "old.toml")
                self.assertEqual({name: settings[name] for name in now}, now)

    def test_a_parameter_without_its_model_is_refused(self):
        self.assert_refused(["render", "box.gltf", "--falloff-mar-slope", "0.03"], ["--falloff-mar-slope: ", "mar:slope=0.0275"])

    def test_a_former_option_beside_the_one_that_took_its_place_is_refused(self):
        words = ["--budget-spp", "which makes --spp 2", "--spp 32", "which of them holds?"]
        self.assert_refused(["render", "box.gltf", "--budget-spp", "2", "--spp", "32"], words)
        self.assert_refused(["render", "box.gltf", "--spp", "32", "--budget-spp", "2"], words)
        self.write("job.toml", "spp = 32\nbudget-spp = 2\n")
        self.assert_refused(["render", "box.gltf", "--config", "job.toml"], ["job.toml", *words])
        self.assertEqual(self.settings("--budget-spp", "2", "--spp", "2")[0]["spp"], "2")
        self.write("job.toml", "sampling = 'regions'\nspp = 32\n")
        self.assertEqual(self.settings("--config", "job.toml", "--budget-spp", "2")[0]["spp"], "2")
        self.assert_refused(["render", "box.gltf", "--density", "mar", "--falloff", "csf"], ["--falloff, which makes --density csf", "--density mar"])

    def test_a_sampling_and_a_density_that_contradict_each_other_are_refused(self):
        words = ["--density, which makes --sampling density", "--sampling uniform", "which of them holds?"]
        self.assert_refused(["render", "box.gltf", "--sampling", "uniform", "--density", "mar"], words)
        self.write("job.toml", 'sampling = "uniform"\ndensity = "mar"\n')
        self.assert_refused(["render", "box.gltf", "--config", "job.toml"], ["job.toml:", *words])
        settings, _ = self.settings("--sampling", "density", "--density", "mar")
        self.assertEqual(settings["density"], '"mar"')
        self.write("job.toml", 'sampling = "uniform"\n')
        self.assertEqual(self.settings("--config", "job.toml", "--density", "mar")[0]["sampling"], '"density"')

    def test_the_mean_is_told_of_only_where_its_meaning_changed(self):
        job = ["plan", "--counts", "--gaze-at", "0.5,0.5", "--size", "64x36", "--screen", "paper"]
        said = self.run_ok(*job, "--density", "mar", "--spp", "2").stderr
        self.assertRegex(said, r"sampling: --density mar: 2 samples a pixel in frame 1, [0-9.]+ where the eye looks")
        self.write("job.toml", "sampling = 'regions'\nspp = 32\n")
        self.assertIn("--spp 32 of job.toml:2 is the mean of a frame", self.run_ok(*job, "--config", "job.toml").stderr)
        self.assertNotIn("mean of a frame", self.run_ok(*job, "--spp", "32").stderr)

    def test_commands_that_have_no_such_option(self):
        for words, told in ((["farm", "job.toml", "--sample-ranges", "4"], "merge --mean"),
                            (["farm", "job.toml", "--chunk-frames", "4"], "--chunk-frames: this option is gone"),
                            (["farm", "--rate-from", "t.csv", "job.toml"], "plan --chunks N --rate-from"),
                            (["farm", "status", "out", "--check-files"], "gazetrace merge"),
                            (["farm", "retry", "out", "--trust-files"], "'--trust-files' is an option of 'gazetrace render'"),
                            (["sweep", "plan.toml", "--budget-samples", "4"], "--budget-samples: this option is gone")):
            with self.subTest(words=words):
                said = self.assert_refused(words, [told])

    def test_compare_takes_them_too(self):
        pictures = ["compare", "a.png", "b.png"]
        self.assert_refused([*pictures, "--region-angles", "4,10", "--region-eccentricities", "2,5"], ["--region-angles: it is now --region-eccentricities"])
        for words, now in ((["--region-angles", "4,10"], "2,5"), (["--region-angles", "4,10", "--angle-reading", "eccentricity"], "4,10")):
            said = self.run_program(*pictures, *words).stderr
            self.assertIn(f"--region-angles is now --region-eccentricities {now}", said)

    def test_a_sweep_takes_them_too(self):
        plan = """[common]
size = "64x36"
frames = "1"
screen = "paper"
eye = [0, 0, 3]
target = [0, 0, 0]
[[scene]]
name = "box"
path = "box.gltf"
[[gaze]]
name = "middle"
at = [0.5, 0.5]
[measure]
metrics = ["mse"]
[[setting]]
"""
        self.write("plan.toml", plan + 'falloff-mar-slope = 0.03\nfalloff = "mar"\n')
        rows = json.loads(self.run_ok("sweep", "plan.toml", "--dry-run", "--json").stdout)["rows"]
        self.assertIn("density mar:slope=0.03", [row["setting"].removeprefix("box/middle ") for row in rows])
        self.write("plan.toml", plan + 'sampling = "uniform"\ndensity = "mar"\n')
        self.assert_refused(["sweep", "plan.toml", "--dry-run"], ["plan.toml:", "--sampling uniform", "which of them holds?"])

    def test_a_preset_s_discs_are_not_lost_in_silence(self):
        settings, said = self.settings("--preset", "paper", "--sampling", "regions")
        self.assertEqual(settings["sampling"], '"regions"')
        self.assertIn("--sampling regions of the command line takes the place of regions:shape=disc of preset paper", said)


if __name__ == "__main__":
    harness.main()
