# SPDX-License-Identifier: Apache-2.0
"""Recordings as other trackers and programs write them than those of gaze_field_cases_test.py, of the same kinds: other
vendors, columns, restarts and units, each with the reading that its maker documents. `python3 gaze_siblings_test.py
--table` prints the table alone."""

import json
import sys
import unittest

import gaze_viewers as viewers
from gaze_reading import ANGLES, PLACES, ReadingTest, close

PX = ["--screen-px", "1920,1080"]


def px(x, size=1920):
    return f"{x * size:.1f}"


class Siblings(ReadingTest):
    letters = "surnoc"

    # Units.

    def u01_inquisit(self):
        "Inquisit: leftpixelx is px of the display; leftgazex, y, z are mm in space, no directions"
        rows = [(f"{1e6 * t:.0f}", *((px(x), px(y, 1080), f"{(x - 0.5) * 520:.2f}", f"{(0.5 - y) * 290 + 150:.2f}", f"{20 * y:.2f}")
                                     if x is not None else ("", "", "", "", ""))) for t, x, y in viewers.on_screen()]
        self.write("u01.csv", viewers.table("timestamp,leftpixelx,leftpixely,leftgazex,leftgazey,leftgazez", rows))
        found = self.inspect("u01.csv")
        named, then = self.read("u01.csv", PLACES, 0.01, ["--x-column", "leftpixelx", "--y-column", "leftpixely", "--unit", "px", *PX])
        wrong = "leftgazex, leftgazey, leftgazez" in found and "unit-vector" in found and "nothing suspicious" in found
        return named and not wrong, then + " | " + found.strip().splitlines()[-1][:120]

    def u02_eprime_validity_of_four(self):
        "E-Prime's extension 2: fractions from the top left; validity 0 is certain, 4 is missing"
        rows = [(f"{1000 * t:.3f}", *((f"{x:.5f}", f"{y:.5f}", 0) if x is not None else (-1, -1, 4))) for t, x, y in viewers.on_screen()]
        self.write("u02.tsv", viewers.table("TETTime\tXGazePosLeftEye\tYGazePosLeftEye\tValidityLeftEye", rows, "\t"))
        names = ["--time-column", "TETTime", "--x-column", "XGazePosLeftEye", "--y-column", "YGazePosLeftEye", "--time-unit", "ms",
                 "--unit", "fraction", "--validity-column", "ValidityLeftEye"]
        asks, got = self.refused("u02.tsv", ["--valid-values 0"], [], names)
        reads, then = self.read("u02.tsv", PLACES, 0.01, [*names, "--valid-values", "0,1", "--missing-value", "-1"])
        return asks and reads, f"{then} | {got}"

    def u03_centimetres_from_the_center(self):
        "PsychoPy in cm from the centre: never degrees or pixels by guess"
        rows = [(f"{t:.5f}", *((f"{(x - 0.5) * 53:.4f}", f"{(0.5 - y) * 30:.4f}") if x is not None else ("", ""))) for t, x, y in viewers.on_screen()]
        self.write("u03.csv", viewers.table("time,gaze_x,gaze_y", rows))
        asks, got = self.refused("u03.csv", ["cm"])
        reads, then = self.read("u03.csv", PLACES, 0.01, ["--unit", "cm", "--origin", "center", "--screen-px", "1920,1080", "--screen-cm", "53,30"])
        return asks and reads, f"{then} | {got}"

    def u04_height_of_a_portrait_display(self):
        "height units on a display of 1080x1920: u = 0.5 + x 1920 / 1080"
        rows = [(f"{t:.5f}", *((f"{(x - 0.5) * 1080 / 1920:.5f}", f"{0.5 - y:.5f}") if x is not None else ("", ""))) for t, x, y in viewers.on_screen()]
        self.write("u04.csv", viewers.table("time,x,y", rows))
        asks, got = self.refused("u04.csv", ["--unit height"])
        reads, then = self.read("u04.csv", PLACES, 0.01, ["--unit", "height", "--screen-px", "1080,1920"])
        return asks and reads, f"{then} | {got}"

    def u05_percent(self):
        "percent of the display, 0 to 100: undecided, never px, cm or degrees in silence"
        rows = [(f"{t:.5f}", *((f"{100 * x:.3f}", f"{100 * y:.3f}") if x is not None else ("", ""))) for t, x, y in viewers.on_screen()]
        self.write("u05.csv", viewers.table("time,x,y", rows))
        plain, got = self.refused("u05.csv", ["--unit"])
        shown, then = self.refused("u05.csv", ["--unit"], [], PX)
        return plain and shown, f"{got} | {then}"

    def u06_aria_gen2(self):
        "Project Aria of the second generation: yaw and pitch in radians, +x to the wearer's left; microseconds"
        import math
        rows = []
        for t, right, up in viewers.viewer(ANGLES, noise=0.02):
            angles = ("", "") if right is None else (f"{-math.radians(right):.6f}", f"{math.radians(up):.6f}")
            rows.append((f"{1e6 * t:.0f}", *angles, 1.2))
        self.write("u06.csv", viewers.table("tracking_timestamp_us,yaw_rads_cpf,pitch_rads_cpf,depth_m", rows))
        return self.read("u06.csv", ANGLES, 0.6)

    def u07_metres_in_a_header(self):
        "a unit that is not known is told, with those that are"
        rows = [(f"{t:.5f}", f"{x or 0:.5f}", f"{y or 0:.5f}") for t, x, y in viewers.on_screen(blinks=False)]
        self.write("u07.csv", viewers.table("time[s],x[furlong],y[furlong]", rows))
        return self.refused("u07.csv", ["furlong", "--unit"])

    def u08_one_eye_left_on_the_other_monitor(self):
        "a second monitor to the left: x from -1920 to 0"
        rows = [(f"{t:.5f}", *((f"{1920 * (x - 1):.1f}", px(y, 1080)) if x is not None else ("", ""))) for t, x, y in viewers.on_screen()]
        self.write("u08.csv", viewers.table("time[s],x[px],y[px]", rows))
        good, got = self.doubted("u08.csv", ["--corner -1920,0"], [], PX)
        refused, _ = self.refused("u08.csv", ["--corner -1920,0"], [], PX)
        reads, then = self.read("u08.csv", PLACES, 0.01, [*PX, "--corner", "-1920,0"])
        return good and refused and reads, f"{then} | {got}"

    # Scene cameras.

    def s01_neon_by_the_api(self):
        "Neon by its network interface: px of the scene camera, told by `worn`; never a screen in silence"
        rows = [(f"{1.7e9 + t:.6f}", f"{1600 * x:.2f}", f"{1200 * y:.2f}", True) for t, x, y in viewers.on_screen(blinks=False)]
        self.write("s01.csv", viewers.table("timestamp_unix_seconds,x,y,worn", rows))
        names = ["--time-column", "timestamp_unix_seconds"]
        log = self.import_log("s01.csv", *names, "--screen-px", "1600,1200", "--unit", "px")
        return "scene camera" in self.inspect("s01.csv", *names) and not log.rows, log.text.strip().splitlines()[-1][:150]

    def s02_norm_pos_without_pupils_other_columns(self):
        "norm_pos of Pupil Capture saved by one's own program: a scene camera's"
        rows = [(f"{t:.5f}", f"{x:.5f}", f"{1 - y:.5f}", 0.95) for t, x, y in viewers.on_screen(blinks=False)]
        self.write("s02.csv", viewers.table("time,norm_pos_x,norm_pos_y,confidence", rows))
        names = ["--time-unit", "s", "--x-column", "norm_pos_x", "--y-column", "norm_pos_y", "--unit", "fraction"]
        refused, got = self.refused("s02.csv", ["scene camera"], [], names)
        return refused and "scene camera" in self.inspect("s02.csv", *names), got

    def s03_invisible_native(self):
        "Pupil Invisible's own folder: its scene camera has 1088x1080 pixels, not Neon's 1600x1200"
        import struct
        samples = viewers.on_screen(blinks=False)
        (self.folder / "gaze ps1.raw").write_bytes(b"".join(struct.pack("<2f", 1088 * x, 1080 * y) for _, x, y in samples))
        (self.folder / "gaze ps1.time").write_bytes(b"".join(struct.pack("<Q", int(1.6e18 + 1e9 * t)) for t, _, _ in samples))
        (self.folder / "info.json").write_text(json.dumps({"data_format_version": "1.2", "glasses_serial_number": "x1", "scene_camera_serial_number": "y1"}))
        text = self.inspect("gaze ps1.raw")
        (self.folder / "info.json").unlink()
        return "1088x1080" in text, next((line for line in text.splitlines() if "picture size" in line), text[-150:])

    def s04_dikablis(self):
        "Dikablis: places on the field camera's picture"
        rows = [(f"{1000 * t:.0f}", f"{1920 * x:.1f}", f"{1080 * y:.1f}") for t, x, y in viewers.on_screen(blinks=False)]
        self.write("s04.csv", viewers.table("rec_time;Dikablis Glasses 3_Field Data_Scene Cam_Original_Gaze_Gaze X;"
                                            "Dikablis Glasses 3_Field Data_Scene Cam_Original_Gaze_Gaze Y", rows, ";"))
        names = ["--time-column", "1", "--time-unit", "ms", "--x-column", "2", "--y-column", "3", "--unit", "px", *PX]
        return self.refused("s04.csv", ["scene camera"], [], names)

    def s05_invisible_by_lsl(self):
        "Pupil Invisible's relay: px of the scene camera, which it calls the world; never a screen"
        more = "<eye>both</eye><metatype>Screen{}</metatype><unit>pixels</unit><coordinate_system>world</coordinate_system>"
        samples = [(1000 + t, (1088 * x, 1080 * y)) for t, x, y in viewers.on_screen(blinks=False)]
        (self.folder / "s05.xdf").write_bytes(viewers.xdf("pupil_invisible_Gaze", [("x", more.format("X")), ("y", more.format("Y"))], samples))
        refused, got = self.refused("s05.xdf", ["scene camera"], [], ["--screen-px", "1088,1080"])
        text = self.inspect("s05.xdf")
        return refused and "scene camera" in text and "1088x1080" in text, got

    def s06_glasses_2_of_old_firmware(self):
        "Tobii Glasses 2 without gidx: gp lies on the scene video; neither a screen nor advice to make one of it"
        lines = [json.dumps({"ts": int(1e6 * t) + 1000, "s": 0, "l": 78000, "gp": [round(x, 4), round(y, 4)]}) for t, x, y in viewers.on_screen(blinks=False)]
        self.write("s06.json", "\n".join(lines) + "\n")
        return self.refused("s06.json", ["scene camera"], ["write it as CSV"])

    # Directions and what looks like them.

    def r01_unity_rotation(self):
        "a rotation of Unity's gaze looks along its +z: the axes are asked for"
        rows = [(f"{t:.5f}", *(f"{c:.7f}" for c in viewers.quaternion(*d))) for t, d in viewers.in_head(blinks=False)]
        self.write("r01.csv", viewers.table("time[s],gaze_rotation_x,gaze_rotation_y,gaze_rotation_z,gaze_rotation_w", rows))
        asks, got = self.refused("r01.csv", ["--axes"])
        reads, then = self.read("r01.csv", ANGLES, 0.6, ["--axes", "unity"])
        return asks and reads, f"{then} | {got}"

    def r02_openxr_orientation(self):
        "an orientation of OpenXR's gaze looks along its -z"
        rows = [(f"{t:.5f}", *(f"{c:.7f}" for c in viewers.quaternion(*d, forward=-1))) for t, d in viewers.in_head(blinks=False)]
        self.write("r02.csv", viewers.table("time[s],gaze_orientation_x,gaze_orientation_y,gaze_orientation_z,gaze_orientation_w", rows))
        return self.read("r02.csv", ANGLES, 0.6)

    def r03_unreal_vector_in_a_cell(self):
        "Unreal's X=0.9 Y=0.1 Z=0.2: +x is ahead"
        rows = [(f"{t:.5f}", f"X={d[2]:.5f} Y={d[0]:.5f} Z={d[1]:.5f}") for t, d in viewers.in_head(blinks=False)]
        self.write("r03.csv", viewers.table("time[s],gaze_direction", rows))
        asks, got = self.refused("r03.csv", ["--axes unreal"])
        reads, then = self.read("r03.csv", ANGLES, 0.6, ["--axes", "unreal"])
        return asks and reads, f"{then} | {got}"

    def r04_sranipal_of_each_eye(self):
        "SRanipal's directions of each eye, +x to the wearer's left"
        rows = [(f"{1000 * t:.1f}", *(f"{c:.6f}" for c in (-d[0], d[1], d[2])), *(f"{c:.6f}" for c in (-d[0], d[1], d[2]))) for t, d in viewers.in_head(blinks=False)]
        head = ",".join(f"{side}_gaze_direction_{axis}" for side in ("left", "right") for axis in "xyz")
        self.write("r04.csv", viewers.table("time_ms," + head, rows))
        asks, got = self.refused("r04.csv", ["sranipal"])
        reads, then = self.read("r04.csv", ANGLES, 0.6, ["--axes", "sranipal"])
        return asks and reads, f"{then} | {got}"

    def r05_points_in_space(self):
        "a gaze point in metres is no direction"
        rows = [(f"{t:.5f}", f"{1.7 * d[0]:.5f}", f"{1.7 * d[1] + 1.5:.5f}", f"{-1.7 * d[2]:.5f}") for t, d in viewers.in_head(blinks=False)]
        self.write("r05.csv", viewers.table("time[s],gaze_x,gaze_y,gaze_z", rows))
        log = self.import_log("r05.csv")
        named = self.import_log("r05.csv", "--x-column", "gaze_x", "--y-column", "gaze_y", "--z-column", "gaze_z")
        return not log.rows and not named.rows and "no directions" in named.text, named.text.strip().splitlines()[-1][:150]

    def r06_semicolons_in_brackets(self):
        "[x; y; z] between tabs, +z ahead, y down: cv"
        rows = [(f"{t:.5f}", "[" + "; ".join(f"{c:.5f}" for c in (d[0], -d[1], d[2])) + "]") for t, d in viewers.in_head(blinks=False)]
        self.write("r06.tsv", viewers.table("time[s]\tgaze_direction", rows, "\t"))
        asks, got = self.refused("r06.tsv", ["--axes"])
        reads, then = self.read("r06.tsv", ANGLES, 0.6, ["--axes", "cv"])
        return asks and reads, f"{then} | {got}"

    def r07_head_alone(self):
        "forward_x of a headset is its own direction, not the eye's"
        rows = [(f"{t:.5f}", *(f"{c:.5f}" for c in (d[0], d[1], -d[2]))) for t, d in viewers.in_head(blinks=False)]
        self.write("r07.csv", viewers.table("time[s],head_forward_x,head_forward_y,head_forward_z", rows))
        return self.refused("r07.csv", ["head_forward_x"])

    # Rows, neighbours and missing values.

    def n01_webgazer_in_cells(self):
        "jsPsych: a trial's samples in a cell; a row for each is asked for"
        trial = json.dumps([{"x": int(1920 * x), "y": int(1080 * y), "t": int(1000 * t)} for t, x, y in viewers.on_screen(blinks=False)[:60]])
        self.write("n01.csv", viewers.table("rt,trial_index,webgazer_data", [(400, i, '"' + trial.replace('"', '""') + '"') for i in range(4)]))
        return self.refused("n01.csv", ["row for each sample"])

    def n02_combined_is_the_sum(self):
        "gaze_x is left_gaze_x + right_gaze_x"
        rows = [(f"{t:.5f}", px(2 * x), px(2 * y, 1080), px(x), px(y, 1080), px(x), px(y, 1080)) for t, x, y in viewers.on_screen(blinks=False)]
        self.write("n02.csv", viewers.table("time[s],gaze_x[px],gaze_y[px],left_gaze_x[px],left_gaze_y[px],right_gaze_x[px],right_gaze_y[px]", rows))
        return self.refused("n02.csv", ["sum", "left_gaze_x"], [], PX)

    def n03_data_viewer(self):
        "Data Viewer's sample report: ms, px, '.' is missing, the display's size is asked for"
        rows = [("s1", 1, f"{1000 * t + 5e5:.0f}", *((px(x), px(y, 1080)) if x is not None else (".", "."))) for t, x, y in viewers.on_screen(rate_hz=500)]
        self.write("n03.txt", viewers.table("RECORDING_SESSION_LABEL\tTRIAL_INDEX\tTIMESTAMP\tLEFT_GAZE_X\tLEFT_GAZE_Y", rows, "\t"))
        asks, got = self.refused("n03.txt", ["--screen-px"])
        reads, then = self.read("n03.txt", PLACES, 0.01, [*PX, "--time-unit", "ms", "--unit", "px"])
        return asks and reads, f"{then} | {got}"

    def n04_eyetribe(self):
        "EyeTribe's rows of messages are no damage; (0, 0) is missing"
        rows = [("2015-01-01 10:00:00.0", f"{1000 * t:.0f}", False, 7, *((px(x), px(y, 1080)) if x is not None else ("0.0", "0.0")), 20) for t, x, y in viewers.on_screen(rate_hz=60, rounds=4)]
        lines = viewers.table("timestamp\ttime\tfix\tstate\trawx\trawy\tpsize", rows, "\t").splitlines()
        lines.insert(40, "MSG\t2015-01-01 10:00:00.5\t660\tstimulus on")
        self.write("n04.tsv", "\n".join(lines) + "\n")
        names = ["--time-column", "time", "--time-unit", "ms", "--x-column", "rawx", "--y-column", "rawy", "--unit", "px", *PX]
        asks, got = self.refused("n04.tsv", ["--missing-value 0"], [], names)
        reads, then = self.read("n04.tsv", PLACES, 0.01, [*names, "--missing-value", "0"])
        return asks and reads, f"{then} | {got}"

    def n05_eyelink_missing_zero(self):
        "edf2asc -miss 0 writes 0 0 and a pupil of 0 in a blink: lost, or asked for"
        rows = "".join(f"{5000 + int(1000 * t)}\t{(px(x) if x is not None else '0.0')}\t{(px(y, 1080) if x is not None else '0.0')}\t{900.0 if x is not None else 0.0}\t...\n"
                       for t, x, y in viewers.on_screen(rate_hz=500))
        self.write("n05.asc", "** CONVERTED FROM x.edf\n** EYELINK II\nMSG\t1 GAZE_COORDS 0 0 1919 1079\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
                              "SAMPLES\tGAZE\tLEFT\tRATE\t500.00\tTRACKING\tCR\n" + rows + "END\t9800 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        log = self.import_log("n05.asc")
        zeros = [row for row in log.usable() if float(row["u[1]"]) == 0]
        return not zeros, f"{len(log.rows)} rows, {len(zeros)} zeros are usable"

    def n06_bad_is_one(self):
        "a column `lost` of 0 and 1: 0 is good"
        rows = [(f"{t:.5f}", *((f"{x:.5f}", f"{y:.5f}", 0) if x is not None else ("0.0", "0.0", 1))) for t, x, y in viewers.on_screen()]
        self.write("n06.csv", viewers.table("time[s],u,v,lost", rows))
        names = ["--validity-column", "lost"]
        asks, got = self.refused("n06.csv", ["--valid-values 0"], [], names)
        reads, then = self.read("n06.csv", PLACES, 0.01, [*names, "--valid-values", "0"])
        return asks and reads, f"{then} | {got}"

    def n07_another_sensor(self):
        "rows of another sensor by `source`, which have no gaze"
        rows = []
        for i, (t, x, y) in enumerate(viewers.on_screen(blinks=False)):
            rows += [(f"{t:.5f}", "eye", f"{x:.5f}", f"{y:.5f}"), (f"{t + 0.002:.5f}", "gsr", "", "")]
        self.write("n07.csv", viewers.table("time[s],source,u,v", rows))
        return self.read("n07.csv", PLACES, 0.01, [], len(rows) // 2)

    def n08_header_in_the_middle(self):
        "two exports one after another: the second header is no damage, the restart is named"
        parts = [[(f"{t:.5f}", f"{x:.5f}", f"{y:.5f}") for t, x, y in viewers.on_screen(blinks=False, seed=seed)] for seed in (1, 2)]
        self.write("n08.csv", "".join(viewers.table("time[s],u,v", rows) for rows in parts))
        return self.refused("n08.csv", ["2 recordings", "--gaze-recording"], ["--order sort"])

    # EyeLink's displays.

    def o01_second_monitor(self):
        "GAZE_COORDS 1920 0 3839 1079: the right one of two monitors, 1920x1080"
        rows = "".join(f"{5000 + int(1000 * t)}\t{1920 + 1920 * x:.1f}\t{px(y, 1080)}\t900.0\t...\n" for t, x, y in viewers.on_screen(rate_hz=500, blinks=False))
        self.write("o01.asc", "** CONVERTED FROM x.edf\n** EYELINK II\nMSG\t1 GAZE_COORDS 1920.00 0.00 3839.00 1079.00\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
                              "SAMPLES\tGAZE\tLEFT\tRATE\t500.00\tTRACKING\tCR\n" + rows + "END\t9800 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        log = self.import_log("o01.asc")
        return "# display_px 1920 1080" in log.head and log.near(PLACES, 0.01) > 0.8, log.head[1:3] or log.text[-120:]

    def o02_head_referenced(self):
        "HREF data are no places on the screen"
        rows = "".join(f"{5000 + int(1000 * t)}\t{15000 * x:.1f}\t{15000 * y:.1f}\t900.0\t...\n" for t, x, y in viewers.on_screen(rate_hz=500, blinks=False))
        self.write("o02.asc", "** CONVERTED FROM x.edf\n** EYELINK II\nMSG\t1 GAZE_COORDS 0 0 1919 1079\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
                              "SAMPLES\tHREF\tLEFT\tRATE\t500.00\tTRACKING\tCR\n" + rows + "END\t9800 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        return self.refused("o02.asc", ["HREF", "edf2asc"])

    def o03_corners_in_bids(self):
        "ScreenResolution 1281x1025 of BIDS is no display: 1280x1024"
        stem = "sub-01_task-v_"
        rows = [(round(1000 * t), f"{1280 * x:.2f}", f"{1024 * y:.2f}") for t, x, y in viewers.on_screen(rate_hz=500, blinks=False)]
        self.write(stem + "recording-eye1_physio.tsv", "\n".join("\t".join(map(str, row)) for row in rows) + "\n")
        self.write(stem + "recording-eye1_physio.json", json.dumps({
            "PhysioType": "eyetrack", "SamplingFrequency": 500, "StartTime": 0, "RecordedEye": "left", "Columns": ["timestamp", "x_coordinate", "y_coordinate"],
            "SampleCoordinateSystem": "gaze-on-screen", "timestamp": {"Units": "ms"}, "x_coordinate": {"Units": "pixel"}, "y_coordinate": {"Units": "pixel"}}))
        self.write(stem + "events.json", json.dumps({"StimulusPresentation": {"ScreenResolution": [1281, 1025]}}))
        log = self.import_log(stem + "recording-eye1_physio.tsv")
        return "# display_px 1280 1024" in log.head and log.near(PLACES, 0.01) > 0.8, log.head[1:3] or log.text[-150:]

    # Clocks.

    def clock_table(self, name, stamps, header="t[ms],u,v"):
        samples = viewers.on_screen(blinks=False)
        self.write(name, viewers.table(header, [(stamps(i, t), f"{x:.5f}", f"{y:.5f}") for i, (t, x, y) in enumerate(samples)]))
        return len(samples)

    def c01_sixteen_bits_of_ms(self):
        "a counter of milliseconds overflows at 65536: --order unwrap keeps all rows"
        rows = self.clock_table("c01.csv", lambda i, t: (64000 + round(1000 * t)) % 65536)
        asks, got = self.refused("c01.csv", ["overflowed", "--order unwrap"], ["--order sort"])
        reads, then = self.read("c01.csv", PLACES, 0.01, ["--order", "unwrap"], rows)
        return asks and reads, f"{then} | {got}"

    def c02_thirty_two_bits_of_us(self):
        "a counter of microseconds overflows at 2^32"
        rows = self.clock_table("c02.csv", lambda i, t: (4_294_000_000 + round(1e6 * t)) % 2**32, "t[us],u,v")
        asks, got = self.refused("c02.csv", ["overflowed", "--order unwrap"], ["--order sort"])
        reads, then = self.read("c02.csv", PLACES, 0.01, ["--order", "unwrap"], rows)
        return asks and reads, f"{then} | {got}"

    def c03_three_parts(self):
        "the clock starts again twice: three recordings, in the order of the file"
        rows = self.clock_table("c03.csv", lambda i, t: f"{1000 * (t % 1.6):.2f}")
        asks, got = self.refused("c03.csv", ["3 recordings", "--gaze-recording"], ["--order sort"])
        return asks and rows > 0, got

    def c04_rounded_by_a_spreadsheet(self):
        "1.70112E+12: the stamps were rounded, and no option mends that"
        self.clock_table("c04.csv", lambda i, t: f"{1701123456789 + 1000 * t:.5E}")
        return self.refused("c04.csv", ["rounded", "original"], ["--order sort", "--order pairs"])

    def c05_time_of_day(self):
        "12:30:05.250 is a time of day"
        self.clock_table("c05.csv", lambda i, t: f"12:30:{5 + t:06.3f}", "time,u,v")
        return self.refused("c05.csv", ["time of day"])

    def c06_written_in_packets(self):
        "every 6 samples are stamped when their packet arrives: no rate of thousands of Hz in silence"
        self.clock_table("c06.csv", lambda i, t: f"{50 * (i // 6) + 0.05 * (i % 6):.2f}")
        return self.doubted("c06.csv", ["burst"])

    def c07_net_ticks(self):
        ".NET ticks of 100 ns from the year 1"
        rows = self.clock_table("c07.csv", lambda i, t: 638_000_000_000_000_000 + round(1e7 * t), "time(100ns),u,v")
        return self.read("c07.csv", PLACES, 0.01, [], rows)

    @unittest.skipIf("--table" in sys.argv, "the table alone")
    def test_a_plain_file_stays_plain(self):
        self.clock_table("plain.csv", lambda i, t: f"{1000 * t:.2f}")
        log = self.import_log("plain.csv")
        self.assertTrue(close(log.place(), PLACES[0], 0.01))
        self.assertIn("nothing suspicious", self.inspect("plain.csv"))

    def test_each_is_read_right_or_doubted(self):
        self.check_all()


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv if argument != "--table"])
