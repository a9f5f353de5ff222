# SPDX-License-Identifier: Apache-2.0
"""Tables of one's own, and tables that are no gaze: what their columns are, and what may be done with them."""

import csv
import json

import harness

SCREEN = ["--screen-px", "1920,1080", "--screen-cm", "50.9,28.6", "--screen-distance-cm", "65"]

CLOUD_FIXATIONS = "section id,recording id,fixation id,start timestamp [ns],end timestamp [ns],duration [ms],fixation x [px],fixation y [px],azimuth [deg],elevation [deg]\n" + "".join(
    f"s,r,{i + 1},{400_000_000 * i},{400_000_000 * i + 300_000_000},300,{800 + i},{600},1.0,1.0\n" for i in range(20))
CORE_FIXATIONS = "id,start_timestamp,duration,start_frame_index,end_frame_index,norm_pos_x,norm_pos_y,dispersion,confidence,method\n" + "".join(
    f"{i},{0.4 * i:.3f},300.0,{i},{i + 1},0.4,0.5,0.9,0.95,gaze\n" for i in range(20))
GAZEPOINT_FIXATIONS = "MEDIA_ID,MEDIA_NAME,CNT,TIME(2024/03/05 10:11:12.000),FPOGX,FPOGY,FPOGS,FPOGD,FPOGID,FPOGV,BPOGX,BPOGY,BPOGV,\n" + "".join(
    f"0,Film,{i},{0.4 * i:.5f},0.4,0.5,{0.4 * i:.5f},0.30000,{i + 1},1,0.4,0.5,1,\n" for i in range(20))
CORNERS = "section id,recording id,timestamp [ns],detected markers IDs,top left x [px],top left y [px],top right x [px],top right y [px],bottom right x [px],bottom right y [px],bottom left x [px],bottom left y [px]\n" + "".join(
    f"s,r,{33_333_333 * i},1;2,100.0,100.0,900.0,100.0,900.0,700.0,100.0,700.0\n" for i in range(50))


class Tables(harness.CliTest):
    def test_tables_of_events_are_no_gaze(self):
        named = ["--time-column", "start timestamp [ns]", "--x-column", "fixation x [px]", "--y-column", "fixation y [px]"]
        for name, text, more in (("cloud.csv", CLOUD_FIXATIONS, named), ("core.csv", CORE_FIXATIONS, ["--time-column", "start_timestamp",
                                  "--x-column", "norm_pos_x", "--y-column", "norm_pos_y", "--time-unit", "s"]),
                                 ("gazepoint.csv", GAZEPOINT_FIXATIONS, [])):
            self.write(name, text)
            for arguments in ([], more):
                self.assert_refused(["gaze", "inspect", name, *SCREEN, *arguments], ["is a table of fixations", "--events"])

    def test_corners_of_a_surface_are_no_gaze(self):
        self.write("surface.csv", CORNERS)
        self.assert_refused(["gaze", "inspect", "surface.csv"], ["corners of a surface", "gaze_positions_on_surface"])
        self.assert_refused(["gaze", "inspect", "surface.csv", "--time-column", "timestamp [ns]", "--x-column", "top left x [px]",
                             "--y-column", "top left y [px]", *SCREEN], ["corners of a surface"])

    def test_a_table_of_fixations_can_be_the_events_of_a_log(self):
        self.write("log.csv", harness.gaze_csv(f"{4_000_000 * i},{0.4 + 0.01 * (i // 100)},0.5,ok,cyclopean" for i in range(2000)))
        for name, text in (("cloud.csv", CLOUD_FIXATIONS), ("core.csv", CORE_FIXATIONS), ("gazepoint.csv", GAZEPOINT_FIXATIONS)):
            self.write(name, text)
            self.run_ok("gaze", "import", "log.csv", "--events", name, "-o", "out.csv", "--overwrite")
            rows = list(csv.DictReader(self.run_ok("gaze", "events", "out.csv", "--method", "log").stdout.splitlines(), delimiter="\t"))
            fixations = [row for row in rows if row["movement"] == "fixation"]
            self.assertEqual([(int(row["onset_ns"]), float(row["duration_ms"])) for row in fixations],
                             [(400_000_000 * i, 300) for i in range(20)], name)
        own = self.run_ok("gaze", "events", "log.csv", "-o", "own.tsv")
        self.assertIn("fixation", own.stdout)
        count = (self.folder / "own.tsv").read_text().count("fixation\t")
        report = json.loads(self.run_ok("gaze", "inspect", "log.csv", "--events", "own.tsv", "--json").stdout)
        self.assertEqual(report["events"]["fixation"], count)
        self.write("later.csv", CLOUD_FIXATIONS.replace("s,r,", "s,r,").replace(",300,", ",300,").replace("\ns,r,", "\ns,r,9"))
        self.assert_refused(["gaze", "import", "log.csv", "-o", "no.csv", "--events", "log.csv"], ["no columns of begin"])

    def test_a_column_of_one_eye_is_that_eyes(self):
        rows = "".join(f"{4 * i},{0.4 + 0.001 * (i % 9):.3f},0.5\n" for i in range(100))
        for x, y, eye in (("LGazePos2dx", "LGazePos2dy", "left"), ("right_x", "right_y", "right"), ("gaze x", "gaze y", "cyclopean")):
            self.write("own.csv", f"time[ms],{x},{y}\n" + rows)
            self.run_ok("gaze", "import", "own.csv", "-o", "out.csv", "--overwrite", "--x-column", x, "--y-column", y, "--unit", "fraction")
            lines = [line for line in (self.folder / "out.csv").read_text().splitlines() if line[:1] != "#"]
            self.assertEqual({row["eye"] for row in csv.DictReader(lines)}, {eye})

    def test_missing_columns_are_named_together(self):
        self.write("own.csv", "clock,a,b\n" + "".join(f"{i},1,2\n" for i in range(20)))
        line = self.assert_refused(["gaze", "inspect", "own.csv"], ["time", "horizontal position", "vertical position"])
        for option in ("--time-column", "--x-column", "--y-column"):
            self.assertIn(option, line)

    def test_places_of_stated_fixations_need_no_screen(self):
        self.write("gaze.tsv", "Recording timestamp [ms]\tSensor\tParticipant name\tGaze point X [DACS px]\tGaze point Y [DACS px]\tEye movement type\t"
                   "Eye movement type index\tRecording resolution width\tRecording resolution height\n" +
                   "".join(f"{8 * i}\tEye Tracker\tP\t480\t810\tFixation\t1\t1920\t1080\n" for i in range(100)))
        rows = list(csv.DictReader(self.run_ok("gaze", "events", "gaze.tsv", "--method", "log").stdout.splitlines(), delimiter="\t"))
        self.assertEqual([(row["movement"], row["u"], row["v"]) for row in rows], [("fixation", "0.25", "0.75")])

    def test_a_frame_of_another_shape_is_told_a_size(self):
        rows = "".join(f"{4 * i},500,400\n" for i in range(100))
        self.write("old.csv", "# display_px 1024 768\n# display_mm 400 300\n# distance_mm 600\ntime[ms],x[px],y[px]\n" + rows)
        line = self.assert_refused(["plan", "--gaze", "old.csv", "--eye", "0,1,4", "--target", "0,0,0", "--size", "1280x720"], ["--size 960x720"])
        self.assertIn("--frame-rect", line)
        self.run_ok("plan", "--gaze", "old.csv", "--eye", "0,1,4", "--target", "0,0,0", "--size", "960x720")

    def test_a_mark_of_a_missing_place_in_one_axis(self):
        rows = "".join(f"{4 * i},{-1 if 40 <= i < 60 else 900 + i % 30},540\n" for i in range(400))
        self.write("mark.csv", "time[ms],x[px],y[px]\n" + rows)
        more = ["--screen-px", "1920,1080"]
        report = json.loads(self.run_ok("gaze", "inspect", "mark.csv", *more, "--json").stdout)
        self.assertEqual(report["flags"], ["--missing-value -1"])
        mended = json.loads(self.run_ok("gaze", "inspect", "mark.csv", *more, "--missing-value", "-1", "--json").stdout)
        self.assertEqual((mended["usable"], mended["flags"]), (380, []))
        # Scattered, as at the tracker's edge, so that gaze jumps to the place again and again.
        rows = "".join(f"{4 * i},{-1 if i % 7 == 3 else 900 + i % 300},540\n" for i in range(1400))
        self.write("mark.csv", "time[ms],x[px],y[px]\n" + rows)
        report = json.loads(self.run_ok("gaze", "inspect", "mark.csv", *more, "--json").stdout)
        self.assertEqual(report["flags"], ["--missing-value -1"])
        mended = json.loads(self.run_ok("gaze", "inspect", "mark.csv", *more, "--missing-value", "-1", "--json").stdout)
        self.assertEqual((mended["usable"], mended["flags"]), (1200, []))


if __name__ == "__main__":
    harness.main()
