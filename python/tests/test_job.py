# SPDX-License-Identifier: Apache-2.0
import keyword
import pickle
import unittest

import gazetrace
from support import SCENE, TestCase, small_job


class JobTest(TestCase):
    def test_names_are_checked_when_they_are_given(self):
        self.assertSays("did you mean 'regions'", "usage", gazetrace.Job, sampling="region")
        self.assertSays("did you mean 'guided'", "usage", gazetrace.Job().replace, filter="guide")
        self.assertSays("give one of these", "usage", gazetrace.Job, density="guided")

    def test_what_is_given_together_does_not_contradict_itself(self):
        self.assertSays("which of them holds?", "usage", gazetrace.Job, sampling="uniform", density="mar")
        self.assertSays("`budget_spp`, which makes `spp` 2,", "usage", gazetrace.Job, spp=32, budget_spp=2)
        self.assertEqual(gazetrace.Job(sampling="uniform").replace(density="mar")["sampling"], "density")

    def test_former_options_are_understood_together(self):
        job = gazetrace.Job(region_angles=(4, 10), angle_reading="eccentricity", falloff_mar_slope=0.03, falloff="mar")
        self.assertEqual(job["region_eccentricities"], "4,10")
        self.assertEqual(job["density"], "mar:slope=0.03")
        self.assertSays("`density_map` is now `density`", "usage", gazetrace.Job, density_map=[[1.0, 2.0], [3.0, 4.0]])

    def test_names_are_those_of_the_schema_with_underscores(self):
        names = [option["name"] for option in gazetrace.options()]
        self.assertIn("gaze_latency", names)
        self.assertGreater(len(names), 100)
        for name in names:
            self.assertTrue(name.isidentifier() and not keyword.iskeyword(name), name)

    def test_every_option_takes_its_own_default(self):
        for option in gazetrace.options():
            if option["defaults"] and option["name"] != "preset":
                values = option["defaults"] if option["shape"] == "repeated" else option["defaults"][0]
                job = gazetrace.Job(**{option["name"]: values})
                self.assertEqual(job[option["name"]], values, option["name"])

    def test_values_of_several_parts_may_be_sequences(self):
        job = gazetrace.Job(size=(640, 360), region_samples=[8, 4, 2], frames=range(3, 6), output=["a.exr", "b.png"],
                            gaze_at=(0.25, 0.5), overwrite=True, gaze_latency="50ms", animation=None)
        self.assertEqual(job["size"], "640x360")
        self.assertEqual(job["region_samples"], "8,4,2")
        self.assertEqual(job["frames"], "3-5")
        self.assertEqual(job["output"], ["a.exr", "b.png"])
        self.assertEqual(job["gaze_at"], "0.25,0.5")
        self.assertEqual(job["overwrite"], "true")
        self.assertEqual(job["gaze_latency"], "50ms")
        self.assertIsNone(job["animation"])

    def test_unknown_options_are_refused_in_the_words_of_the_schema(self):
        self.assertSays("unknown option 'gaze_latensy'; did you mean 'gaze_latency'?", "usage", gazetrace.Job,
                        gaze_latensy="1s")

    def test_wrong_values_are_refused_under_the_keyword(self):
        self.assertSays("`gaze_latency`: ", "usage", gazetrace.Job, gaze_latency="soon")
        self.assertSays("`spp`: ", "usage", lambda: small_job(spp=0).plan())
        with self.assertRaises(TypeError):
            gazetrace.Job(spp=object())

    def test_options_win_over_a_file_and_a_file_over_defaults(self):
        path = self.folder / "job.toml"
        path.write_text('spp = 3\nsize = "32x18"\n')
        job = gazetrace.Job(path, spp=5)
        self.assertEqual(job["spp"], "5")
        self.assertEqual(job["size"], "32x18")
        self.assertEqual(gazetrace.Job.from_toml(job.to_toml()).to_toml(), job.to_toml())

    def test_errors_of_a_file_name_its_line(self):
        path = self.folder / "job.toml"
        path.write_text("spp = 3\nspq = 4\n")
        self.assertSays(f"{path}:2", "input", gazetrace.Job, path)
        self.assertSays("cannot be read", "input", gazetrace.Job, self.folder / "none.toml")

    def test_replace_leaves_the_first_job_alone(self):
        job = gazetrace.Job(spp=3)
        other = job.replace(spp=4, scene=SCENE)
        self.assertEqual((job["spp"], other["spp"], job["scene"]), ("3", "4", None))
        self.assertIn("spp='4'", repr(other))

    def test_errors_survive_pickling(self):
        error = pickle.loads(pickle.dumps(gazetrace.Error("words", "input")))
        self.assertEqual((str(error), error.kind), ("words", "input"))


if __name__ == "__main__":
    unittest.main()
