# SPDX-License-Identifier: Apache-2.0
"""Files as laboratories have them, each with the right reading: a table of case, expected, got. Nothing may be read wrong
in silence, and no advice may be wrong. `python3 gaze_field_cases_test.py --table` prints the table alone."""

import sys
import unittest

import harness
from gaze_reading import PLACES, ANGLES, ReadingTest, close

CASES = harness.SHARED / "field-cases/gaze"
BIDS = "b01_start_time_array/sub-01/beh/sub-01_task-view_recording-eye1_physio.tsv.gz"

class FieldCases(ReadingTest):
    letters = "ebghptx"

    def log_path(self, name):
        return CASES / name

    @unittest.skipUnless(CASES.exists(), "the cases of laboratories are not here")
    def test_each_is_read_right_or_doubted(self):
        self.check_all()

    def e01_pygaze_gaze_coords(self):
        "display 1280x1024; u = x / 1280"
        log = self.import_log("e01_pygaze_gaze_coords.asc")
        return "# display_px 1280 1024" in log.head and log.near(PLACES, 0.01) > 0.8, log.head[1:3]

    def e08_samples_only(self):
        "EyeLink samples without their header: asks for --screen-px; then 1520 rows"
        asks, got = self.refused("e08_samples_only.asc", ["edf2asc", "--screen-px"], ["--x-column"])
        reads, then = self.read("e08_samples_only.asc", PLACES, 0.01, ["--screen-px", "1920,1080"], 1520)
        return asks and reads, f"{got} | {then}"

    def e09_events_only(self):
        "no samples, because edf2asc ran with -e"
        return self.refused("e09_events_only.asc", ["edf2asc", "-e"])

    def e10_below_the_screen(self):
        "the eye rests below the screen; x and y are not exchanged"
        return self.doubted("e10_below_the_screen.asc", ["below"], ["--swap-xy"])

    def e11_resolution_changes(self):
        "each block by its own GAZE_COORDS, or refused"
        good, got = self.refused("e11_resolution_changes.asc", ["1920x1080", "1024x768", "--gaze-recording"])
        first = self.import_log("e11_resolution_changes.asc", "--gaze-recording", "1")
        second = self.import_log("e11_resolution_changes.asc", "--gaze-recording", "2")
        blocks = first.rows and second.rows and close([first.place()[0]], [0.2008], 1e-3) and "# display_px 1024 768" in second.head
        return good and bool(blocks) and second.near(PLACES, 0.01) > 0.8, got

    def b01_start_time_array(self):
        "ScreenResolution in texts is read: 1920x1080"
        return self.says(self.inspect(BIDS), ["1920x1080"], ["not stated;"])

    def g01_prolab_glasses_export(self):
        "the scene camera's, or directions from HUCS; never the screen"
        return self.says(self.inspect("g01_prolab_glasses_export.tsv"), ["scene camera"], ["on a screen"])

    def g01b_prolab_mapped_gaze(self):
        "the scene camera's; never the screen"
        return self.says(self.inspect("g01b_prolab_mapped_gaze.tsv"), ["scene camera"], ["on a screen"])

    def g03_webgazer_tobii(self):
        "lines of JSON: named"
        return self.says(self.inspect("g03_webgazer_tobii.json"), ["JSON"])

    def h03_varjo_unity_logger(self):
        "vectors in a cell, +z ahead"
        return self.read("h03_varjo_unity_logger.csv", ANGLES, 0.5)

    def h04_one_decimal_in_a_cell(self):
        "the log is too coarse: steps of 5.7 degrees"
        return self.doubted("h04_one_decimal_in_a_cell.csv", ["coarse", "5.7"])

    def h04b_one_decimal(self):
        "unit vectors of one decimal; zeros are straight ahead"
        return self.doubted("h04b_one_decimal.csv", ["coarse", "unit-vector"], ["--missing-value 0", "--unit deg"])

    def h06_radians(self):
        "radians are a unit of angles"
        return self.read("h06_radians.csv", ANGLES, 0.5)

    def h08_openxr_world_quaternions(self):
        "gaze stands in the space of the head's poses"
        good, got = self.says(self.inspect("h08_openxr_world_quaternions.csv"), ["world"], ["--flip-x"])
        reads, then = self.read("h08_openxr_world_quaternions.csv", ANGLES, 0.5)
        return good and reads, f"{then} | {got}"

    def h08b_openxr_world_things_at_rest(self):
        "at 0.125 s it looks along (-0.3903, 0.1043, -0.9148)"
        log = self.import_log("h08b_openxr_world_things_at_rest.csv")
        rows = [row for row in log.usable() if int(row["t[ns]"]) <= 125_000_000]
        got = tuple(float(rows[-1][axis]) for axis in ("dx", "dy", "dz")) if rows else ()
        return close(got, (-0.3903, 0.1043, -0.9148), 0.002), got or log.text[-150:]

    def h09_unit_vectors_gaze_xyz(self):
        "unit vectors with +z ahead, no degrees"
        good, got = self.doubted("h09_unit_vectors_gaze_xyz.csv", ["unit-vector", "--axes unity"], ["--unit deg"])
        reads, then = self.read("h09_unit_vectors_gaze_xyz.csv", ANGLES, 0.5, ["--axes", "unity"])
        return good and reads, f"{got} | {then}"

    def h10_unity_dir_xyz(self):
        "all directions point backwards: --axes unity"
        good, got = self.doubted("h10_unity_dir_xyz.csv", ["--axes unity"])
        refused, _ = self.refused("h10_unity_dir_xyz.csv", ["--axes unity"])
        return good and refused, got

    def p03_ego4d_gaze(self):
        "the named time column counts; a scene camera's picture from the bottom left"
        return self.says(self.inspect("p03_ego4d_gaze.csv", "--time-column", "canonical_timestamp_s"),
                         ["scene camera", "bottom-left"], ["there is no column", "--frame head"])

    def t01_clock_starts_anew(self):
        "the clock starts again in line 226; never --gaze-sort"
        columns = ["--x-column", "norm_x", "--y-column", "norm_y", "--unit", "fraction"]
        good, got = self.doubted("t01_clock_starts_anew.csv", ["226"], ["--gaze-sort", "--order sort"], columns)
        plan, said = self.refused("t01_clock_starts_anew.csv", ["226"], ["--gaze-sort", "--order sort"], columns)
        return good and plan, f"{got} | {said}"

    def t01b_clock_starts_anew_pupil_core(self):
        "the same of Pupil Core"
        return self.refused("t01b_clock_starts_anew_pupil_core.csv", ["226"], ["--gaze-sort", "--order sort"],
                            ["--frame", "scene-camera"])

    def t02_2khz_whole_ms(self):
        "1840 samples at 2000 Hz, the second of a pair half a millisecond later"
        good, got = self.doubted("t02_2khz_whole_ms.tsv", ["--order pairs"], ["--gaze-sort", "--order sort"])
        log = self.import_log("t02_2khz_whole_ms.tsv", "--order", "pairs", "--unit", "px", "--screen-px", "1920,1080",
                              "--time-unit", "ms")
        times = [int(row["t[ns]"]) for row in log.rows]
        return good and len(times) == 1840 and times[1] - times[0] == 500_000, f"{len(times)} rows | {got}"

    def t06_pygaze_message_in_line(self):
        "line 403 is broken; line 203 is a row of an event"
        return self.refused("t06_pygaze_message_in_line.tsv", [":403:"], [":203:"], ["--unit", "fraction"])

    def t06b_pygaze_event_rows(self):
        "rows of time and text are messages: 912 samples"
        return self.read("t06b_pygaze_event_rows.tsv", PLACES, 0.02, ["--unit", "fraction"], 912)

    def t07_pygaze_sum_of_eyes(self):
        "GazePointX is the sum of both eyes' columns"
        good, got = self.doubted("t07_pygaze_sum_of_eyes.tsv", ["sum", "GazePointXLeft"])
        refused, _ = self.refused("t07_pygaze_sum_of_eyes.tsv", ["GazePointXLeft"])
        return good and refused, got

    def t08b_four_bursts(self):
        "four bursts of stamps of writing are suspicious"
        return self.doubted("t08b_four_bursts.tsv", ["burst"])

    def t09_gazeparser_bottom_left(self):
        "1920x1080 from the bottom left, FAIL is missing; first v = 0.30"
        log = self.import_log("t09_gazeparser_bottom_left.csv")
        return bool(log.rows) and "# display_px 1920 1080" in log.head and close(log.place(), (.1998, .3002), 0.002), log.text[-150:]

    def t12_iohub_pix(self):
        "centre origin, y up: a suspicion with --origin center"
        good, got = self.doubted("t12_iohub_pix.txt", ["--origin center"])
        reads, then = self.read("t12_iohub_pix.txt", PLACES, 0.02, ["--unit", "px", "--origin", "center", "--screen-px", "1920,1080"])
        return good and reads, f"{then} | {got}"

    def t13_height_units(self):
        "PsychoPy height: never degrees by guess; at 0.125 s (0.20, 0.30)"
        asks, got = self.refused("t13_height_units.csv", ["--unit height"])
        reads, then = self.read("t13_height_units.csv", PLACES, 0.01, ["--unit", "height", "--screen-px", "1920,1080"])
        return asks and reads, f"{then} | {got}"

    def t13b_norm_units(self):
        "PsychoPy norm: never degrees by guess; at 0.125 s (0.20, 0.30)"
        asks, got = self.refused("t13b_norm_units.csv", ["--unit norm"])
        reads, then = self.read("t13b_norm_units.csv", PLACES, 0.01, ["--unit", "norm"])
        return asks and reads, f"{then} | {got}"

    def t14_imotions(self):
        "rows of EventSource 2 are another sensor's, -1 is missing"
        log = self.import_log("t14_imotions.csv", "--screen-px", "1920,1080")
        lost = [row for row in log.rows if row["eye"] == "cyclopean" and row["valid"] == "lost"]
        times = {row["t[ns]"] for row in log.rows}
        return len(times) == 266 and 0 < len(lost) < 30 and log.near(PLACES, 0.02) > 0.7, f"{len(times)} times, {len(lost)} lost " + log.text[-150:]

    def t18_centred_pixels(self):
        "83 % beside the display: --origin center"
        good, got = self.doubted("t18_centred_pixels.csv", ["--origin center"])
        refused, _ = self.refused("t18_centred_pixels.csv", ["--origin center"], (), ["--screen-px", "1280,1024"])
        reads, then = self.read("t18_centred_pixels.csv", PLACES, 0.01, ["--screen-px", "1280,1024", "--origin", "center"])
        return good and refused and reads, f"{then} | {got}"

    def t26_validity_zero_is_good(self):
        "0 is good: --valid-values 0"
        options = ["--screen-px", "1920,1080"]
        good, got = self.doubted("t26_validity_zero_is_good.tsv", ["--valid-values 0"], ["--missing-value 0"], options)
        refused, _ = self.refused("t26_validity_zero_is_good.tsv", ["--valid-values 0"], (), options)
        return good and refused, got

    def x01_pupil_capture_lsl_relay(self):
        "norm_pos on the scene camera, or the gaze point's directions; never mixed"
        return self.says(self.inspect("x01_pupil_capture_lsl_relay.xdf"), ["scene camera", "bottom-left"], ["unit-vector"])

    def x02_same_stream_twice(self):
        "two streams of 266 samples: both are named"
        return self.refused("x02_same_stream_twice.xdf", ["266", "--gaze-recording"])


class OwnLaboratory(harness.CliTest):
    """An EyeLink log states pixels alone; its size and distance are given as the manual says."""

    def log(self):
        rows = "".join(f"{5000 + 2 * i}\t{480 + (i % 7) * 0.1:.1f}\t270.0\t900.0\t...\n" for i in range(400))
        self.write("log.asc", "** CONVERTED FROM x.edf\n** EYELINK II\nMSG\t1 GAZE_COORDS 0 0 1919 1079\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
                              "SAMPLES\tGAZE\tLEFT\tRATE\t500.00\tTRACKING\tCR\n" + rows + "END\t5800 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        return "log.asc"

    def test_pixels_come_from_the_log_and_the_geometry_is_the_recordings(self):
        job = ["box.gltf", "--gaze", self.log(), "--fps", "10", "--frames", "1-2", "--size", "64x36", "--screen-cm", "53,30",
               "--screen-distance-cm", "65"]
        for more in ([], ["--screen-px", "1920,1080"]):
            self.assertIn("0.250", self.run_ok("plan", *job, *more).stdout)
        self.run_ok("gaze", "events", "log.asc", *job[-4:], "-o", "events.tsv")
        # Another display is another display.
        self.assert_refused(["plan", *job, "--screen-px", "1280,720"], ["--gaze-transfer", "--recording-screen"])

    def test_the_former_name_of_the_command(self):
        result = self.run_ok("gaze", "convert", self.log(), "-o", "out.csv")
        self.assertIn("now 'gaze import'", result.stderr)
        self.assertIn("(stated in the file", result.stdout)


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--table"])
