# SPDX-License-Identifier: Apache-2.0
"""Gaze logs from outside: reading without a distance, column maps, head poses as the camera."""

import gzip
import json

import harness

HEAD_LOG = (
    "t[ms],head x,head y,head z,pitch,yaw,roll,gx,gy,gz\n"
    "5000,0,1.6,0,0,350,0,0,0,1\n"
    "5500,0,1.6,1,0,0,0,0,0,1\n"
    "6000,0,1.6,2,0,10,0,0.6,0,0.8\n"
)
HEAD_MAP = {
    "time": "t", "x": "gx", "y": "gy", "z": "gz", "axes": "unity", "head_axes": "unity",
    "head_x": "head x", "head_y": "head y", "head_z": "head z",
    "head_rotation_x": "pitch", "head_rotation_y": "yaw", "head_rotation_z": "roll",
}


class GazeLogs(harness.CliTest):
    def summary(self, *arguments):
        return json.loads(self.run_ok("gaze", "inspect", *arguments, "--json").stdout)

    def test_pixels_need_no_distance_to_be_read(self):
        self.write("log.csv", "t[ms],x[px],y[px]\n0,960,540\n4,480,270\n")
        summary = self.summary("log.csv", "--screen-px", "1920,1080")
        self.assertEqual(summary["usable"], 2)
        self.assertEqual(summary["range"]["first"], [0.25, 0.5])

    def test_gzip(self):
        (self.folder / "log.csv.gz").write_bytes(gzip.compress(b"t[ms],u[1],v[1]\n0,0.5,0.5\n"))
        self.assertEqual(self.summary("log.csv.gz")["samples"], 1)

    def test_a_column_map_is_saved_and_reused(self):
        self.write("log.csv", "clock;right;down\n7;10;20\n")
        flags = ["--time-column", "clock", "--x-column", "right", "--y-column", "down",
                 "--time-unit", "ms", "--unit", "px", "--screen-px", "100,100"]
        first = self.summary("log.csv", *flags, "--save-columns", "map.json")
        second = self.summary("log.csv", "--columns", "map.json", "--screen-px", "100,100")
        self.assertEqual(first["first_ns"], 7_000_000)
        self.assertEqual(first["range"], second["range"])
        self.assertEqual(second["first_ns"], 7_000_000)

    def test_a_column_map_is_saved_only_of_a_log_that_was_read_and_over_nothing(self):
        self.write("log.csv", harness.moving_gaze())
        self.write("precious.json", "precious")
        self.assert_refused(["gaze", "inspect", "none.csv", "--time-column", "a", "--save-columns", "map.json"], ["none.csv"])
        self.assert_refused(["gaze", "inspect", "log.csv", "--x-column", "u[1]", "--y-column", "v[1]", "--save-columns", "precious.json"],
                            ["precious.json", "exists already", "--overwrite"])
        self.assertEqual((self.folder / "precious.json").read_text(), "precious")
        self.run_ok("gaze", "inspect", "log.csv", "--x-column", "u[1]", "--y-column", "v[1]", "--save-columns", "precious.json", "--overwrite")
        self.assertIn("u[1]", (self.folder / "precious.json").read_text())

    def test_gazepoint_of_several_media_goes_on_by_its_ticks(self):
        header = "MEDIA_ID,CNT,TIME(2023/10/30 13:34:49.156),TIMETICK(f=10000000),BPOGX,BPOGY,BPOGV,\n"
        rows = [f"{i // 30},{i},{0.016 * (i % 30):.3f},{160000 * i},{0.5 + 0.001 * (i % 7)},{0.5 + 0.001 * (i % 5)},1,\n" for i in range(60)]
        self.write("media.csv", header + "".join(rows))
        report = self.summary("media.csv")
        accused = [(f["code"], f["flag"]) for f in report["findings"] if f["kind"] != "note"]
        self.assertEqual(accused, [("media", "--time-column TIMETICK")])
        self.assertEqual((report["samples"], report["first_ns"], report["last_ns"]), (60, 0, 59 * 16_000_000))
        self.assert_refused(["gaze", "import", "media.csv", "-o", "out.csv"], ["media.csv:32", "another medium", "--time-column TIMETICK,"])
        self.run_ok("gaze", "import", "media.csv", "-o", "out.csv", "--time-column", "TIMETICK")
        mended = self.summary("media.csv", "--time-column", "TIMETICK")
        self.assertEqual([f for f in mended["findings"] if f["kind"] != "note"], [])
        # Without ticks there is nothing to go on by.
        self.write("bare.csv", header.replace("TIMETICK(f=10000000)", "X") + "".join(rows))
        refusal = self.assert_refused(["gaze", "inspect", "bare.csv"], ["bare.csv:32", "one medium a file"])
        self.assertNotIn("--time-column", refusal)

    def test_what_was_concluded_says_from_what(self):
        self.write("log.csv", "time,u,v\n0,0.5,0.5\n4,0.5,0.5\n8,0.5,0.5\n")
        facts = {fact["what"]: fact for fact in self.summary("log.csv")["facts"]}
        self.assertEqual((facts["time unit"]["value"], facts["time unit"]["evidence"]), ("ms", "statistics"))

    def test_formats_say_what_they_were_tried_on(self):
        text = self.run_ok("list", "gaze-formats").stdout
        lines = {line.split()[0]: line for line in text.splitlines()[1:]}
        self.assertGreater(len(lines), 20)
        for name, line in lines.items():
            says = [text for text in ("(tried on a real recording", "(never tried on a real recording") if text in line]
            self.assertEqual(len(says), 1, name)
        self.assertIn("never tried", lines["varjo"])
        self.assertIn("real recording", lines["eyelink-asc"])

    def test_one_log_gives_gaze_and_camera(self):
        self.write("log.csv", HEAD_LOG)
        self.write("map.json", json.dumps(HEAD_MAP))
        self.run_ok("gaze", "import", "log.csv", "--columns", "map.json", "-o", "gaze.csv")
        arguments = ["--gaze", "gaze.csv", "--camera-from-gaze", "--fps", "2",
                     "--size", "64x36", "--json"]
        frames = json.loads(self.run_ok("plan", *arguments).stdout)
        frames = frames["frames"] if isinstance(frames, dict) else frames
        # Frames at 0.25 and 0.75 s: between the poses at 0, 0.5 and 1 s of the log that begins at 5 s.
        self.assertEqual(len(frames), 2)
        text = json.dumps(frames)
        self.assertIn("-0.5", text)  # half way to Unity's z = 1, which is -1 here
        self.assertIn("-1.5", text)

    def test_a_log_without_head_poses_is_no_camera(self):
        self.write("log.csv", "t[ms],dx,dy,dz\n0,0,0,-1\n")
        self.assert_refused(["plan", "--gaze", "log.csv", "--camera-from-gaze"], ["log.csv", "no head pose"])


if __name__ == "__main__":
    harness.main()
