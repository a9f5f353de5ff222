# SPDX-License-Identifier: Apache-2.0
import csv
import importlib.util
import unittest

import numpy as np

import gazetrace
from gazetrace import metrics
from support import COURTYARD, TestCase, needs_program, run_program, small_job


def noise(seed, shape=(32, 48, 3)):
    return np.random.default_rng(seed).random(shape, dtype=np.float32)


class MetricsTest(TestCase):
    def test_definitions(self):
        reference, test = noise(1), noise(2)
        squared = (test.astype(float) - reference) ** 2
        self.assertAlmostEqual(metrics.mse(reference, test), squared.mean(), places=6)
        self.assertEqual(metrics.flip(reference, reference), 0)
        self.assertGreater(metrics.flip(reference, test), 0.1)
        self.assertAlmostEqual(metrics.ssim(reference, reference), 1, places=6)

    def test_there_is_a_function_for_each_metric(self):
        self.assertLessEqual({"mse", "relmse", "psnr", "ssim", "flip", "fovvideovdp"}, set(metrics.INFO))
        for name in metrics.INFO:
            self.assertTrue(callable(getattr(metrics, name)), name)
            self.assertIn("is better", getattr(metrics, name).__doc__)

    def test_maps(self):
        value, maps = metrics.flip(noise(1), noise(2), maps=True)
        self.assertEqual(maps[0].shape, (32, 48))
        self.assertAlmostEqual(float(maps[0].mean()), value, places=5)

    def test_whole_numbers_are_code_values(self):
        code = (noise(1) * 255).astype(np.uint8)
        floats = code.astype(np.float32) / np.float32(255)
        other = noise(2)
        self.assertEqual(metrics.ssim(code, (other * 255).astype(np.uint8)),
                         metrics.ssim(floats, (other * 255).astype(np.uint8).astype(np.float32) / np.float32(255),
                                      linear=False))

    def test_fovvideovdp_counts_from_the_gaze(self):
        reference = np.full((108, 192, 3), 0.5, dtype=np.float32)
        test = reference.copy()
        test[40:60, 10:30] += 0.2
        options = {"screen_px": (192, 108), "screen_cm": (48, 27), "screen_distance_cm": 40}
        near = metrics.fovvideovdp(reference, test, gaze=(20 / 192, 50 / 108), **options)
        far = metrics.fovvideovdp(reference, test, gaze=(180 / 192, 50 / 108), **options)
        self.assertLess(near, far)

    def test_errors(self):
        self.assertSays("unknown metric 'flop'", "usage", metrics.measure, "flop", noise(1), noise(2))
        self.assertSays("one size", "input", metrics.mse, noise(1), noise(2, (32, 32, 3)))
        self.assertSays("(height, width, 3)", "usage", metrics.mse, [noise(1)[..., 0]], [noise(1)[..., 0]])
        self.assertSays("did you mean 'relmse_epsilon'", "usage", metrics.relmse, noise(1), noise(2), relmse_epsilom=1)
        self.assertSays("two of a kind", "input", metrics.mse, noise(1), (noise(2) * 255).astype(np.uint8))


class CompareTest(TestCase):
    def test_sequences_that_are_rendered_as_they_are_compared(self):
        job = small_job(frames="1-3", fps=24)
        result = gazetrace.compare(job.replace(sampling="uniform", spp=16).render(), job.render())
        self.assertEqual([one["frame"] for one in result.frames], [1, 2, 3])
        self.assertIn("fovvideovdp", result.metrics)
        self.assertEqual(result.headline["gaze_class"], "fixation")
        self.assertEqual(result.columns["mse"].shape, (3,))
        self.assertIsNotNone(result.scores("mse")["bands"]["0-2.6"])

    def test_lengths_differ(self):
        self.assertSays("different numbers of frames", "input", gazetrace.compare, [noise(1)], [noise(1), noise(2)])

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_pandas(self):
        table = gazetrace.compare([noise(1), noise(2)], [noise(3), noise(4)], metrics=["mse"]).to_pandas()
        self.assertEqual(list(table.columns), ["frame", "gaze_class", "mse"])

    def test_what_a_notebook_shows(self):
        result = gazetrace.compare([noise(1), noise(2)], [noise(3), noise(4)], metrics=["mse", "flip"])
        self.assertRegex(repr(result), r"^<ComparisonResult of 2 frames: mse=0\.\d{1,5}, flip=0\.\d{1,5}>$")
        self.assertIn("<th>frame</th><th>gaze_class</th><th>mse</th>", result._repr_html_())
        with self.assertRaises(KeyError) as raised:
            result["flp"]
        self.assertIn("did you mean 'flip'?", str(raised.exception))

    @needs_program
    def test_files_score_as_with_the_program(self):
        job = gazetrace.Job(scene=COURTYARD, gaze_at=(0.4, 0.5), screen="paper", size=(96, 54), frames="1-2", fps=10)
        one, other = self.folder / "one/frame.####.exr", self.folder / "other/frame.####.exr"
        job.replace(output=[one], sampling="uniform", spp=8).run()
        job.replace(output=[other]).run()
        run_program("compare", one, other, "--csv", self.folder / "scores.csv")
        result = gazetrace.compare(one, other)
        rendered = gazetrace.compare(job.replace(sampling="uniform", spp=8, exr_pixels="float").render(),
                                     job.replace(exr_pixels="float").render())
        with open(self.folder / "scores.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["metric"] for row in rows}, set(result.metrics))
        for row in rows:
            frame = next(one for one in result.frames if one["frame"] == int(row["frame"]))
            scores = next(scores for scores in frame["scores"] if scores["metric"] == row["metric"])
            self.assertEqual(f"{scores['value']:.6g}", f"{float(row['value']):.6g}", row["metric"])
        self.assertEqual(result.conditions["gaze"], "of the reference's pictures")
        self.assertFalse(gazetrace.compare(one, other, metrics=["flip"], fail_above="flip=1").over_limits)
        limits = gazetrace.compare(one, other, metrics=["flip"], fail_above="flip=0", maps=True)
        self.assertIn("above 0", limits.over_limits[0])
        self.assertEqual(limits.maps("flip")[1].shape, (54, 96))
        self.assertAlmostEqual(rendered["flip"], result["flip"], delta=1e-3)  # the files hold half floats

    def test_files_are_refused_as_by_the_program(self):
        """Two that were looked at in different places, or from which frames are missing, unless it is asked for."""
        job = small_job(frames="1-2", fps=10, sampling="regions")
        job.replace(output=[self.folder / "one/f.####.exr"]).run()
        job.replace(output=[self.folder / "other/f.####.exr"], gaze_at=(0.1, 0.5)).run()
        one, other = self.folder / "one/f.####.exr", self.folder / "other/f.####.exr"
        self.assertSays("was looked at in 0.1000,0.5000", "input", gazetrace.compare, one, other)
        self.assertGreater(gazetrace.compare(one, other, metrics=["mse"], anyway=True)["mse"], 0)
        given = gazetrace.compare(one, other, metrics=["mse"], gaze=[(0.5, 0.5), (np.nan, np.nan)])
        self.assertEqual([frame["gaze_class"] for frame in given.frames], ["fixation", "no-gaze"])
        self.assertSays("3 places of gaze for 2 frames", "usage", gazetrace.compare, one, other, gaze=[(0.5, 0.5)] * 3)
        (self.folder / "other/f.0002.exr").unlink()
        self.assertSays("the reference has frames 1-2, the test 1", "input", gazetrace.compare, one, other, gaze=(0.5, 0.5))
        self.assertSays("did you mean 'gaze_at'", "usage", gazetrace.compare, one, other, gaze_att=(0.5, 0.5))


if __name__ == "__main__":
    unittest.main()
