# SPDX-License-Identifier: Apache-2.0
"""`gazetrace gaze iohub`: recordings of ioHub as its manual describes its tables."""

import csv
import json
import unittest

import harness

try:
    import h5py
    import numpy
except ModuleNotFoundError:
    h5py = None

COMMON = [("experiment_id", "u4"), ("session_id", "u4"), ("time", "f8")]
PLACES = [(-0.4, 0.2), (0.3, 0.1), (0.0, -0.3)]  # in heights from the centre, y up


def eye(prefix):
    return [(f"{prefix}gaze_x", "f4"), (f"{prefix}gaze_y", "f4"), (f"{prefix}pupil_measure1", "f4")]


@unittest.skipUnless(h5py, "needs h5py")
class IoHub(harness.CliTest):
    def recording(self, samples, binocular=True, sessions=(1,), messages=()):
        kind = COMMON + (eye("left_") + eye("right_") if binocular else eye("")) + [("status", "u1")]
        rows = []
        for session in sessions:
            for i in range(samples):
                x, y = PLACES[i * len(PLACES) // samples]
                place = (x + 0.001 * (i % 5), y, 3.0 + 0.1 * session)
                rows.append((1, session, 10 + 0.004 * i, *place, *(place if binocular else ()), (0, 2, 20, 22)[i % 4] if binocular else 2 * (i % 4 == 1)))
        with h5py.File(self.folder / "data.hdf5", "w") as file:
            group = file.create_group("data_collection/events")
            group["eyetracker/" + ("BinocularEyeSampleEvent" if binocular else "MonocularEyeSampleEvent")] = numpy.array(rows, kind)
            group["experiment/MessageEvent"] = numpy.array([(1, 1, t, text) for t, text in messages], [*COMMON, ("text", "S32")])

    def imported(self, *more):
        self.run_ok("gaze", "iohub", "data.hdf5", "-o", "out.csv", "--unit", "height", "--screen-px", "1600,900", *more)
        lines = (self.folder / "out.csv").read_text().splitlines()
        return list(csv.DictReader(line for line in lines if not line.startswith("#"))), [line for line in lines if line.startswith("#")]

    def test_both_eyes_their_validity_and_messages(self):
        self.recording(600, messages=[(10.0, b"TRIAL 1"), (11.2, b"TRIAL 2")])
        self.assert_refused(["gaze", "inspect", "data.hdf5"], ["gazetrace gaze iohub FILE.hdf5 -o gaze.csv --unit UNIT"])
        rows, head = self.imported("--keep-ids", "--trial-start", "TRIAL *")
        of = {name: [row for row in rows if row["eye"] == name] for name in ("left", "right")}
        self.assertEqual([row["valid"] for row in of["left"][:4]], ["ok", "ok", "lost", "lost"])
        self.assertEqual([row["valid"] for row in of["right"][:4]], ["ok", "lost", "ok", "lost"])
        self.assertEqual([row["t[ns]"] for row in of["left"][:2]], ["10000000000", "10004000000"])
        self.assertAlmostEqual(float(of["left"][0]["u[1]"]), 0.5 - 0.4 * 900 / 1600, places=6)
        self.assertAlmostEqual(float(of["left"][0]["v[1]"]), 0.3, places=6)
        self.assertAlmostEqual(float(of["left"][0]["pupil"]), 3.1, places=5)
        self.assertIn("# event message cyclopean 11200000000 11200000000 TRIAL 2", head)
        trials = json.loads(self.run_ok("gaze", "trials", "out.csv", "--json").stdout)["trials"]
        self.assertEqual([trial["begin_ns"] for trial in trials], [10_000_000_000, 11_200_000_000])
        self.assert_refused(["gaze", "iohub", "data.hdf5", "-o", "out.csv", "--unit", "height"], ["out.csv", "exists already"])
        rows, head = self.imported("--overwrite")
        self.assertFalse([line for line in head if "TRIAL" in line])

    def test_one_eye_and_one_of_several_sessions(self):
        self.recording(600, binocular=False, sessions=(1, 2))
        self.assert_refused(["gaze", "iohub", "data.hdf5", "-o", "out.csv", "--unit", "height", "--screen-px", "1600,900"], ["--gaze-recording"])
        rows, _ = self.imported("--gaze-recording", "2")
        self.assertEqual([row["valid"] for row in rows[:4]], ["ok", "lost", "ok", "ok"])
        self.assertAlmostEqual(float(rows[0]["pupil"]), 3.2, places=5)

    def test_other_files(self):
        self.write("none.hdf5", "no HDF5")
        self.assert_refused(["gaze", "iohub", "none.hdf5", "-o", "out.csv"], ["cannot be read as HDF5"])
        with h5py.File(self.folder / "other.hdf5", "w") as file:
            file["x"] = [1]
        self.assert_refused(["gaze", "iohub", "other.hdf5", "-o", "out.csv"], ["has no samples"])


if __name__ == "__main__":
    harness.main()
