# SPDX-License-Identifier: Apache-2.0
"""The log doctor on real recordings, whole and broken: it names the fault and the flag, and with the flag the log reads
as the whole one does. Whole recordings are accused of nothing."""

import csv
import gzip
import json
import math
import shutil
import unittest

import gaze_breaking as breaking
import harness

SAMPLES = harness.SHARED / "gaze-samples"
BIDS = "bids/derived-tx300"
BIDS_LOG = "sub-01_task-view_recording-eye1_physio.tsv.gz"

# file: format, time unit, position unit, origin (or axes), where unit and origin come from
WHOLE = {
    "arff/gaze.arff": ("arff", "us", "px", "top-left", "format"),
    f"{BIDS}/{BIDS_LOG}": ("bids", "us", "px", "top-left", "sidecar"),
    "eyelink-asc/bino1000.asc": ("eyelink-asc", "ms", "px", "top-left", "header"),
    "eyelink-asc/bino1000_blinks.asc": ("eyelink-asc", "ms", "px", "top-left", "header"),
    "eyelink-asc/mono500.asc": ("eyelink-asc", "ms", "px", "top-left", "header"),
    "gazebase-vr/gazebase_vr_example.csv": ("gazebase", "ms", "deg", "center", "format"),
    "pico-neo3-pro/boxing_VR.csv": ("pico", "s", "unit-vector", "unity", "header"),
    "plain-csv/gaze-toy-example.csv": ("generic", "ms", "px", "top-left", "statistics"),
    "pupil-core/gaze_positions.csv": ("pupil-core", "s", "fraction", "bottom-left", "format"),
    "pupil-core/gaze_positions_with_monocular.csv": ("pupil-core", "s", "fraction", "bottom-left", "format"),
    "pupil-invisible-cloud/gaze.csv": ("pupil-cloud", "ns", "px", "top-left", "header"),
    "pupil-invisible-cloud/trampoline_02_gaze.csv": ("pupil-cloud", "ns", "px", "top-left", "header"),
    "pupil-neon-native/gaze ps1.raw": ("neon-native", "ns", "px", "top-left", "format"),
    "smi-iview-txt/recording1_Samples.txt": ("smi", "us", "px", "top-left", "header"),
    "tobii-glasses2/livedata.json.gz": ("tobii-glasses-2", "us", "fraction", "top-left", "format"),
    "tobii-glasses3/gazedata.gz": ("tobii-glasses-3", "s", "fraction", "top-left", "format"),
    "tobii-studio-tsv/data.tsv": ("tobii-studio", "ms", "px", "top-left", "header"),
    "vive-pro-eye/TESTNA01_2D_Fist3.csv": ("vive-sranipal", "100 ns", "unit-vector", "sranipal", "header"),
    "vive-pro-eye/TESTNA01_360VR_Fist3.csv": ("vive-sranipal", "100 ns", "unit-vector", "sranipal", "header"),
}


class Words(harness.CliTest):
    def test_each_line_says_what_it_means_and_what_to_do(self):
        rows = "".join(f"{5000 + 4 * i}\t{960 + 7 * math.sin(i):.1f}\t540.0\t900.0\t...\n" for i in range(2000))
        self.write("log.asc", "** CONVERTED FROM x.edf\nMSG\t1 DISPLAY_COORDS 0 0 1919 1079\nSTART\t5000 \tLEFT\tSAMPLES\tEVENTS\n"
                              "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR\n" + rows + "END\t13000 \tSAMPLES\tEVENTS\tRES\t35.00\t35.00\n")
        text = self.run_ok("gaze", "inspect", "log.asc").stdout
        lines = {line.split("  ")[0]: line for line in text.splitlines() if line[:1] not in ("", " ")}
        # Seconds beside nanoseconds, and durations in units that people use.
        self.assertIn("8.00 s, from 5.000 s to 12.996 s of the clock", lines["time"])
        self.assertIn("(5000000000 ns to 12996000000 ns)", lines["time"])
        # What a share is of, and what to do where it is not believed.
        self.assertRegex(lines["format"], r"\(known by the content of the file, with \d+ % certainty; --format names another\)")
        self.assertNotIn("sure", text)
        self.assertIn("(RMS-S2S)", lines["precision"])
        self.assertIn("standard deviation", lines["precision"])
        # What is undecided says what would decide it.
        for axis in ("axis x", "axis y"):
            self.assertIn("undecided: ", lines[axis])
            self.assertIn("To check it, ", lines[axis])
        self.assertIn("the lines above say how to check it", lines["verdict"])
        for jargon in ("jitter 0", "middle half", "like blinks", "runs of one position"):
            self.assertNotIn(jargon, text)


@unittest.skipUnless(SAMPLES.exists(), f"{SAMPLES} is not here")
class Doctor(harness.CliTest):
    def inspect(self, *arguments):
        return json.loads(self.run_ok("gaze", "inspect", *arguments, "--json").stdout)

    def accused(self, report):
        # In SMI's recording the eye is indeed not found for the first 104 seconds, in one of Vive's it is lost for the last 2.
        return [finding for finding in report["findings"] if finding["kind"] != "note" and not finding["code"].startswith("lost-")]

    def sample(self, name):
        return (SAMPLES / name).read_bytes().decode("utf-8-sig")

    def rows(self, *arguments):
        """Converted: (time, eye) to validity and coordinates."""
        self.run_ok("gaze", "import", *arguments, "-o", "converted.csv", "--overwrite")
        lines = [line for line in (self.folder / "converted.csv").read_text().splitlines() if line[:1] != "#"]
        rows = {}
        for row in csv.DictReader(lines):
            place = [row.get(name) or "nan" for name in ("u[1]", "v[1]")] if "u[1]" in row else [row[d] or "nan" for d in ("dx", "dy", "dz")]
            rows[int(row["t[ns]"]), row["eye"]] = (row["valid"], [float(value) for value in place])
        return rows

    def assert_same_log(self, broken, whole, within=1e-9):
        self.assertEqual(broken.keys(), whole.keys())
        for key, (validity, place) in whole.items():
            self.assertEqual(broken[key][0], validity, key)
            for a, b in zip(broken[key][1], place):
                self.assertTrue(a != a and b != b or abs(a - b) <= within, (key, broken[key], place))

    def assert_mended(self, name, broken_text, code, flag, whole_text=None, common=(), within=1e-9, kinds=("fault", "suspicion")):
        """Of the broken copy `code` and `flag` are the only accusation; with the flag it reads as the whole log."""
        suffix = name[name.rfind("/") + 1:]
        self.write("broken-" + suffix, broken_text)
        self.write("whole-" + suffix, self.sample(name) if whole_text is None else whole_text)
        report = self.inspect("broken-" + suffix, *common)
        self.assertEqual([(f["code"], f["flag"]) for f in self.accused(report)], [(code, flag)], (name, report["findings"]))
        self.assertIn(self.accused(report)[0]["kind"], kinds)
        self.assertEqual(report["flags"], [flag])
        flags = flag.split()
        self.assertEqual(self.accused(self.inspect("broken-" + suffix, *common, *flags)), [])
        self.assert_same_log(self.rows("broken-" + suffix, *common, *flags), self.rows("whole-" + suffix, *common), within)

    def test_whole_recordings(self):
        for name, (log_format, time_unit, unit, origin, evidence) in WHOLE.items():
            report = self.inspect(SAMPLES / name)
            facts = {fact["what"]: fact for fact in report["facts"]}
            self.assertEqual(report["format"], log_format, name)
            self.assertEqual(facts["time unit"]["value"], time_unit, name)
            self.assertEqual(facts["position unit"]["value"], unit, name)
            self.assertEqual(facts["position unit"]["evidence"], evidence, name)
            self.assertEqual(facts["position unit"]["guess"], evidence == "statistics", name)
            self.assertEqual(facts["axes" if unit == "unit-vector" else "origin"]["value"], origin, name)
            self.assertEqual(self.accused(report), [], name)
            self.assertEqual(report["flags"], [], name)
            self.assertNotIn("flipped", [axis["verdict"] for axis in report["axes"]], name)

    def test_what_no_option_mends_is_refused(self):
        for name, words in (
            ("tobii-pro-lab-tsv/mobile_mapped_excerpt.tsv", ["no gaze points"]),
            ("vive-pro-eye/TESTVA03_2D_Spread9_header_only.csv", ["holds no sample"]),
            ("bids/rest_eye/sub-01_ses-01_task-rest_run-01_recording-eye1_physio.tsv.gz", ["is empty"]),
        ):
            self.assert_refused(["gaze", "inspect", SAMPLES / name], words)

    # -- y flipped: found where the file holds a second account of the gaze

    def test_y_flipped_eyelink(self):
        name = "eyelink-asc/bino1000_blinks.asc"

        def flip(cells):
            for at in (2, 5):
                if cells[at].strip() != ".":
                    cells[at] = f"{1050 - float(cells[at]):.1f}"

        broken = breaking.cells_changed(self.sample(name), breaking.begins_with_digit, "\t", flip)
        self.assert_mended(name, broken, "y-flip", "--flip-y", kinds=["fault"])

    def test_y_flipped_tobii_studio(self):
        name = "tobii-studio-tsv/data.tsv"
        header = self.sample(name).split("\n")[0].split("\t")
        columns = [i for i, title in enumerate(header) if title.startswith("GazePoint") and title.endswith("Y (ADCSpx)")]
        self.assertEqual(len(columns), 3)

        def flip(cells):
            for at in columns:
                if cells[at]:
                    cells[at] = str(1080 - float(cells[at]))

        broken = breaking.cells_changed(self.sample(name), lambda line: "RecordingTimestamp" not in line and "\t" in line, "\t", flip)
        self.assert_mended(name, broken, "y-flip", "--flip-y", kinds=["fault"])

    def test_y_flipped_pupil_cloud(self):
        name = "pupil-invisible-cloud/gaze.csv"

        def flip(cells):
            cells[4] = repr(1080 - float(cells[4]))

        broken = breaking.cells_changed(self.sample(name), lambda line: line.count(",") > 5 and "section" not in line, ",", flip)
        self.assert_mended(name, broken, "y-flip", "--flip-y", common=["--frame", "scene-camera"], kinds=["fault"])

    def test_y_flipped_without_a_second_account_is_undecided(self):
        text = self.sample("plain-csv/gaze-toy-example.csv")

        def flip(cells):
            cells[2] = str(1024 - float(cells[2]))

        self.write("flipped.csv", breaking.cells_changed(text, breaking.begins_with_digit, ",", flip))
        report = self.inspect("flipped.csv", "--screen-px", "1280,1024")
        self.assertEqual([axis["verdict"] for axis in report["axes"]], ["undecided", "undecided"])
        self.assertIn("nothing to test it against", report["axes"][1]["evidence"])
        self.assertEqual(self.accused(report), [])

    def test_one_eye_flipped(self):
        folder = self.folder / "bids"
        shutil.copytree(SAMPLES / BIDS, folder)
        path = folder / BIDS_LOG
        text = gzip.decompress(path.read_bytes()).decode()

        def flip(cells):
            if cells[2] != "n/a":
                cells[2] = f"{1080 - float(cells[2]):.4f}"

        path.chmod(0o644)
        path.write_bytes(gzip.compress(breaking.cells_changed(text, lambda line: "\t" in line, "\t", flip).encode()))
        found = [(f["code"], f["flag"]) for f in self.accused(self.inspect(path))]
        self.assertEqual(found, [("one-eye-flipped", None)])  # nothing in the file says which eye it is
        self.assertEqual(self.accused(self.inspect(path, "--gaze-eye", "right")), [])

    def test_axes_exchanged(self):
        name = "tobii-studio-tsv/data.tsv"
        header = self.sample(name).split("\n")[0].split("\t")
        pairs = [(header.index(f"GazePoint{eye}X (ADCSpx)"), header.index(f"GazePoint{eye}Y (ADCSpx)")) for eye in ("", "Left", "Right")]

        def swap(cells):
            for x, y in pairs:
                cells[x], cells[y] = cells[y], cells[x]

        broken = breaking.cells_changed(self.sample(name), lambda line: "RecordingTimestamp" not in line and "\t" in line, "\t", swap)
        self.assert_mended(name, broken, "swapped-axes", "--swap-xy", kinds=["fault"])

    # -- wrong units

    def test_milliseconds_read_as_microseconds(self):
        for name, row in (
            ("arff/gaze.arff", breaking.begins_with_digit),
            ("smi-iview-txt/recording1_Samples.txt", breaking.begins_with_digit),
        ):
            separator = "\t" if "smi" in name else ","

            def to_ms(cells):
                cells[0] = f"{int(cells[0]) // 1000}.{int(cells[0]) % 1000:03}"

            broken = breaking.cells_changed(self.sample(name), row, separator, to_ms)
            self.assert_mended(name, broken, "time-unit", "--time-unit ms")

    def test_microseconds_read_as_milliseconds(self):
        name = "eyelink-asc/mono500.asc"
        text = "\n".join(
            line[:n] + "000" + line[n:] if (n := len(line) - len(line.lstrip("0123456789"))) else line
            for line in self.sample(name).split("\n"))
        self.write("broken.asc", text)
        report = self.inspect("broken.asc")
        self.assertEqual([(f["code"], f["flag"]) for f in self.accused(report)], [("time-unit", "--time-unit us")])

    def test_a_header_with_the_wrong_unit_of_time(self):
        text = self.sample("plain-csv/gaze-toy-example.csv")
        self.assert_mended("toy.csv", text.replace("time,", "time[us],", 1), "time-unit", "--time-unit ms",
                           text.replace("time,", "time[ms],", 1), ["--screen-px", "1280,1024", "--unit", "px"])

    def test_degrees_declared_as_pixels(self):
        def arff(cells):
            if cells[3].strip() != "0.0":
                cells[1] = repr(breaking.degrees(float(cells[1]), 1280, 40, 45))
                cells[2] = repr(-breaking.degrees(float(cells[2]), 720, 22.5, 45))

        broken = breaking.cells_changed(self.sample("arff/gaze.arff"), breaking.begins_with_digit, ",", arff)
        self.assert_mended("arff/gaze.arff", broken, "position-unit", "--unit deg", within=1e-12)

        name = "smi-iview-txt/recording1_Samples.txt"
        text = self.sample(name)
        header = next(line for line in text.split("\n") if line.startswith("Time\t")).split("\t")
        x, y = header.index("L POR X [px]"), header.index("L POR Y [px]")

        def smi(cells):
            if len(cells) > y and cells[1] == "SMP" and (float(cells[x]), float(cells[y])) != (0, 0):
                # Straight ahead, 0 and 0, would be SMI's own mark of a missing place.
                cells[x] = repr(breaking.degrees(float(cells[x]), 1024, 30, 80) or 1e-12)
                cells[y] = repr(-breaking.degrees(float(cells[y]), 768, 20, 80))

        self.assert_mended(name, breaking.cells_changed(text, breaking.begins_with_digit, "\t", smi), "position-unit",
                           "--unit deg", within=1e-9)

    # -- missing values as zeros

    def test_zeros_for_missing(self):
        name = "eyelink-asc/bino1000_blinks.asc"

        def zeros(cells):
            for at in (1, 2, 4, 5):
                cells[at] = cells[at].replace(".", "0.0") if cells[at].strip() == "." else cells[at]

        # Without the tracker's events: within a blink that it saw itself zeros do no harm and are no fault.
        whole = "\n".join(line for line in self.sample(name).split("\n")
                          if line.split(" ")[0].split("\t")[0] not in ("SBLINK", "EBLINK", "SSACC", "ESACC", "SFIX", "EFIX"))
        broken = breaking.cells_changed(whole, breaking.begins_with_digit, "\t", zeros)
        # The pupil is 0 there, too, so that the reader itself knows that nothing was seen.
        self.write("whole.asc", whole)
        self.write("broken.asc", broken)
        self.assertEqual(self.accused(self.inspect("broken.asc")), [])
        self.assert_same_log(self.rows("broken.asc"), self.rows("whole.asc"))

        lines = self.sample("plain-csv/gaze-toy-example.csv").split("\n")
        lost = [i for i in range(1, len(lines) - 1) if i % 400 < 30]
        broken = [line.split(",")[0] + ",0.0,0.0" if i in lost else line for i, line in enumerate(lines)]
        whole = [line.split(",")[0] + ",," if i in lost else line for i, line in enumerate(lines)]
        self.assert_mended("toy.csv", "\n".join(broken), "zero-missing", "--missing-value 0", "\n".join(whole),
                           ["--screen-px", "1280,1024"])

    def test_other_numbers_for_missing(self):
        lines = self.sample("plain-csv/gaze-toy-example.csv").split("\n")
        lost = [i for i in range(1, len(lines) - 1) if i % 400 < 30]
        whole = "\n".join(line.split(",")[0] + ",," if i in lost else line for i, line in enumerate(lines))
        common = ["--screen-px", "1280,1024"]

        def broken(mark):
            return "\n".join(f"{line.split(',')[0]},{mark},{mark}" if i in lost else line for i, line in enumerate(lines))

        self.assert_mended("toy.csv", broken(-1), "missing-value", "--missing-value -1", whole, common)
        for mark in ("-32768", "1e8"):
            self.write("marks.csv", broken(mark))
            self.write("whole.csv", whole)
            self.assertEqual(self.accused(self.inspect("marks.csv", *common)), [])
            self.assert_same_log(self.rows("marks.csv", *common), self.rows("whole.csv", *common))

    # -- order

    def test_shuffled_rows(self):
        for name, row, common in (
            ("eyelink-asc/mono500.asc", lambda line: line[:1].isdigit() and "\t" in line and int(line.split("\t")[0]) > 7196000, []),
            ("arff/gaze.arff", breaking.begins_with_digit, []),
            ("plain-csv/gaze-toy-example.csv", breaking.begins_with_digit, ["--screen-px", "1280,1024"]),
            ("pico-neo3-pro/boxing_VR.csv", lambda line: line.startswith("SE"), []),
        ):
            self.assert_mended(name, breaking.shuffled(self.sample(name), row), "unordered", "--order sort", common=common, kinds=["fault"])

    def test_repeated_block(self):
        for name, row, common in (
            ("eyelink-asc/bino1000_blinks.asc", breaking.begins_with_digit, []),
            ("arff/gaze.arff", breaking.begins_with_digit, []),
            ("plain-csv/gaze-toy-example.csv", breaking.begins_with_digit, ["--screen-px", "1280,1024"]),
            ("smi-iview-txt/recording1_Samples.txt", breaking.begins_with_digit, []),
            ("pico-neo3-pro/boxing_VR.csv", lambda line: line.startswith("SE"), []),
        ):
            broken = breaking.repeated(self.sample(name), row)
            self.assert_mended(name, broken, "repeated-rows", "--order sort", common=common, kinds=["fault"])

    def test_a_clock_that_starts_again_is_not_to_be_sorted(self):
        rows = "".join(f"{t},{0.2 + 0.0001 * t + 0.1 * part},0.5\n" for part in (0, 1) for t in range(part, 4000, 2))
        self.write("log.csv", "t[ms],u[1],v[1]\n" + rows)
        finding = self.accused(self.inspect("log.csv"))[0]
        self.assertEqual((finding["code"], finding["flag"]), ("several-recordings", "--gaze-recording 1"))
        self.assertIn("starts again in line 2002", finding["what"])

    # -- decimal commas

    def test_decimal_commas_between_commas_are_refused(self):
        for name, common in (("plain-csv/gaze-toy-example.csv", ["--screen-px", "1280,1024"]), ("arff/gaze.arff", [])):
            self.write("broken-" + name[name.rfind("/") + 1:], breaking.decimal_commas(self.sample(name), breaking.begins_with_digit))
            for command in (["inspect"], ["import", "-o", "no.csv"]):
                self.assert_refused(["gaze", command[0], "broken-" + name[name.rfind("/") + 1:], *command[1:], *common],
                                    ["more cells than the", "as decimal marks", "export again with decimal points"])

    def test_decimal_commas_between_other_separators_need_no_option(self):
        for name in ("vive-pro-eye/TESTNA01_360VR_Fist3.csv", "eyelink-asc/mono500.asc", "smi-iview-txt/recording1_Samples.txt"):
            suffix = name[name.rfind("/") + 1:]
            whole = self.sample(name)
            self.write("broken-" + suffix, breaking.decimal_commas(whole, breaking.begins_with_digit))
            report = self.inspect("broken-" + suffix)
            facts = {fact["what"]: fact["value"] for fact in report["facts"]}
            self.assertEqual(facts.get("decimal mark"), "comma", name)
            self.assertEqual(self.accused(report), [], name)
            self.assert_same_log(self.rows("broken-" + suffix), self.rows(SAMPLES / name))


if __name__ == "__main__":
    harness.main()
