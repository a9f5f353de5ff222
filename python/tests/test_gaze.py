# SPDX-License-Identifier: Apache-2.0
import csv
import importlib.util
import unittest

import numpy as np

import gazetrace
from support import GAZE_LOG, TestCase


class GazeTest(TestCase):
    def test_arrays_are_the_rows_of_the_file(self):
        log = gazetrace.read_gaze(GAZE_LOG)
        with open(GAZE_LOG, encoding="utf-8") as file:
            rows = list(csv.reader(line for line in file if not line.startswith("#")))
        header, rows = rows[0], rows[1:]
        self.assertEqual(len(log), len(rows))
        time = next(i for i, name in enumerate(header) if "t" in name.split("[")[0].lower())
        np.testing.assert_array_equal(log.t_ns, [int(row[time]) for row in rows])
        self.assertTrue(log.valid.any() and not log.valid.all())
        self.assertFalse(log.t_ns.flags.owndata)
        self.assertEqual(set(log.validity[log.valid]) - {"ok", "off_screen", "off-screen", "interpolated"}, set())

    def test_arrays_keep_the_log_alive(self):
        u = gazetrace.read_gaze(GAZE_LOG).u
        self.assertEqual(u.dtype, np.float64)
        np.testing.assert_array_equal(u, gazetrace.read_gaze(GAZE_LOG).u)

    def test_options_are_those_of_the_schema(self):
        self.assertSays("did you mean 'format'?", "usage", gazetrace.read_gaze, GAZE_LOG, formt="x")
        self.assertSays("none.csv", "input", gazetrace.read_gaze, "none.csv")
        path = self.folder / "pixels.csv"
        path.write_text("time_ms,x_px,y_px\n0,960,540\n10,480,270\n20,0,1080\n")
        log = gazetrace.read_gaze(path, screen_px=(1920, 1080), screen_cm=(50, 28), screen_distance_cm=60)
        np.testing.assert_allclose(log.u, [0.5, 0.25, 0], atol=1e-12)
        np.testing.assert_allclose(log.t_s, [0, 0.01, 0.02], atol=1e-12)

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "pandas is not installed")
    def test_pandas(self):
        table = gazetrace.read_gaze(GAZE_LOG).to_pandas()
        self.assertEqual(list(table.columns[:5]), ["t_ns", "t_s", "u", "v", "valid"])
        self.assertEqual(str(table["t_ns"].dtype), "int64")


if __name__ == "__main__":
    unittest.main()
