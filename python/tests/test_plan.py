# SPDX-License-Identifier: Apache-2.0
import json
import unittest

import numpy as np

import gazetrace
from support import COURTYARD, GAZE_LOG, TestCase, needs_program, run_program, small_job


class PlanTest(TestCase):
    def test_columns_of_a_resting_eye(self):
        plan = small_job(frames=range(1, 4), fps=10, gaze_at=(0.25, 0.75)).plan()
        np.testing.assert_array_equal(plan.frame, [1, 2, 3])
        np.testing.assert_array_equal(plan.t_ns, [50_000_000, 150_000_000, 250_000_000])
        np.testing.assert_array_equal(plan.u, [0.25] * 3)
        np.testing.assert_array_equal(plan.v, [0.75] * 3)
        np.testing.assert_array_equal(plan.valid, [True] * 3)

    def test_frames_without_gaze_are_not_valid(self):
        plan = small_job(gaze_at=None, frames="1-2").plan()
        self.assertFalse(plan.valid.any())
        self.assertTrue(np.isnan(plan.u).all())

    def test_samples_are_those_of_the_sampling_map(self):
        plan = small_job(sampling="uniform", spp=4).plan()
        np.testing.assert_array_equal(plan.samples, [64 * 36 * 4])
        sampling = plan.sampling_map(0)
        self.assertEqual(sampling.region.shape, (36, 64))
        self.assertTrue((sampling.samples_per_pixel == 4).all())
        self.assertEqual(int(sampling.sites["samples"].sum()), sampling.samples)

    def test_a_wrong_file_is_refused(self):
        self.assertSays("none.csv", "input", small_job(gaze_at=None, gaze="none.csv").plan)

    @needs_program
    def test_equals_what_the_program_prints(self):
        options = {"gaze": GAZE_LOG, "frames": "1-40", "fps": "30", "size": "64x36", "gaze_latency": "20ms"}
        plan = gazetrace.Job(scene=COURTYARD, camera="walk", **options).plan()
        flags = [text for name, value in options.items() for text in (f"--{name.replace('_', '-')}", value)]
        printed = json.loads(run_program("plan", COURTYARD, "--camera", "walk", *flags, "--json").stdout)
        frames = printed["frames"] if isinstance(printed, dict) else printed
        self.assertEqual(len(plan), len(frames))
        u = [np.nan if f["gaze_render"].get("u") is None else f["gaze_render"]["u"] for f in frames]
        np.testing.assert_array_equal(plan.u, u)
        np.testing.assert_array_equal(plan["camera_position_m"], [f["camera"]["position_m"] for f in frames])
        self.assertTrue(plan.valid.any() and not plan.valid.all())


if __name__ == "__main__":
    unittest.main()
