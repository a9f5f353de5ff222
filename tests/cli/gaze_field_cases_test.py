# SPDX-License-Identifier: Apache-2.0
"""Files as laboratories have them, each with the right reading: a table of case, expected, got. Nothing may be read wrong
in silence, and no advice may be wrong. `python3 gaze_field_cases_test.py --table` prints the table alone."""

import csv
import math
import sys
import unittest

import harness

CASES = harness.SHARED / "field-cases/gaze"
BIDS = "b01_start_time_array/sub-01/beh/sub-01_task-view_recording-eye1_physio.tsv.gz"
# Where the eye rests in the files of screens, as fractions, and in those of headsets, degrees to the right and up.
PLACES = [(.20, .30), (.75, .25), (.60, .80), (.15, .70), (.50, .50), (.85, .55), (.35, .15)]
ANGLES = [(-12, 6), (15, 8), (5, -14), (-18, -9), (0, 0), (20, -3), (-8, 12)]


class Log:
    """What an import wrote, or why it wrote nothing."""

    def __init__(self, text, path):
        self.text = text
        self.rows = []
        self.head = []
        if path.exists():
            lines = path.read_text().splitlines()
            self.head = [line for line in lines if line.startswith("#")]
            self.rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def usable(self):
        return [row for row in self.rows if row["valid"] in ("ok", "off_screen")]

    def place(self, i=0):
        row = self.usable()[i]
        return float(row["u[1]"]), float(row["v[1]"])

    def direction(self, i=0):
        row = self.usable()[i]
        return tuple(float(row[axis]) for axis in ("dx", "dy", "dz"))

    def near(self, true, tolerance):
        """The share of the samples that lie at one of the true places."""
        near = 0
        for row in self.usable():
            if "u[1]" in row:
                at = float(row["u[1]"]), float(row["v[1]"])
            else:
                x, y, z = (float(row[axis]) for axis in ("dx", "dy", "dz"))
                at = math.degrees(math.atan2(x, -z)), math.degrees(math.asin(y))
            near += any(math.dist(at, place) < tolerance for place in true)
        return near / max(1, len(self.rows))


def close(a, b, tolerance=0.002):
    return len(a) == len(b) and all(abs(x - y) < tolerance for x, y in zip(a, b))


class FieldCases(harness.CliTest):
    def import_log(self, name, *options):
        out = self.folder / "out.csv"
        out.unlink(missing_ok=True)
        result = self.run_program("gaze", "import", CASES / name, "-o", out, *options)
        return Log(result.stdout + result.stderr, out)

    def inspect(self, name, *options):
        result = self.run_program("gaze", "inspect", CASES / name, *options)
        return result.stdout + result.stderr

    def plan(self, name, *options):
        result = self.run_program("plan", "box.gltf", "--gaze", CASES / name, *harness.SCREEN, "--fps", "10", "--frames", "1-2",
                                  "--size", "64x36", *options)
        return result.stdout + result.stderr

    def says(self, text, words, never=()):
        """Whether a text has all words and none of the others; the last line of it."""
        missing = [word for word in words if word not in text]
        wrong = [word for word in never if word in text]
        line = text.strip().splitlines()[-1] if text.strip() else "nothing"
        return not missing and not wrong, (f"lacks {missing}; " if missing else "") + (f"says {wrong}; " if wrong else "") + line[:150]

    def doubted(self, name, words, never=(), options=()):
        return self.says(self.inspect(name, *options), words, [*never, "nothing suspicious"])

    def refused(self, name, words, never=(), options=()):
        log = self.import_log(name, *options)
        good, got = self.says(log.text, words, never)
        return good and not log.rows, got if not log.rows else f"read {len(log.rows)} rows: " + got

    def read(self, name, true, tolerance, options=(), rows=None, share=0.75):
        log = self.import_log(name, *options)
        if not log.rows:
            return False, log.text.strip().splitlines()[-1][:200]
        near = log.near(true, tolerance)
        return near >= share and (rows is None or len(log.rows) == rows), f"{len(log.rows)} rows, {100 * near:.0f} % at true places"

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
                         ["scene camera", "bottom-left"], ["there is no column"])

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

    def cases(self):
        return [name for name in vars(FieldCases) if name[0] in "ebghptx" and name[1].isdigit()]

    def result_of(self, name):
        try:
            return getattr(self, name)()
        except Exception as error:  # a file that is not read shows itself in many ways
            return False, f"{type(error).__name__}: {error}"

    @unittest.skipUnless(CASES.exists(), "needs GAZETRACE_SHARED_DIR")
    def test_each_is_read_right_or_doubted(self):
        wrong = []
        for name in self.cases():
            good, got = self.result_of(name)
            print(f"{'right' if good else 'WRONG'}  {name:34} {getattr(self, name).__doc__}\n{'':41} got: {got}")
            wrong += [] if good else [name]
        print(f"{len(self.cases()) - len(wrong)} of {len(self.cases())} right")
        self.assertEqual(wrong, [])


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
