# SPDX-License-Identifier: Apache-2.0
"""The official BIDS validator has nothing to say, at error or warning level, of the data sets that are written. It runs
where it is installed (bids-validator-deno on PyPI)."""

import gzip
import json
import os
import shutil
import subprocess
import unittest

import harness

VALIDATOR = os.environ.get("BIDS_VALIDATOR") or shutil.which("bids-validator-deno")


def eyelink(starts=(10_000, 20_000), pupil=("PUPIL\tAREA",)):
    lines = ["** CONVERTED FROM x.edf using edfapi", "** EYELINK II 1", "MSG\t1 DISPLAY_COORDS 0 0 1919 1079",
             "MSG\t9000 !CAL VALIDATION HV9 LR LEFT GOOD ERROR 0.35 avg. 0.48 max OFFSET 0.18 deg. -6.4,-0.9 pix."]
    for block, start in enumerate(starts):
        lines += [f"MSG\t{start - 2} TRIALID {block + 1}", f"START\t{start} \tLEFT\tSAMPLES\tEVENTS", *pupil,
                  "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR"]
        lines += [f"{start + 4 * i}\t{960 + i % 5:.1f}\t540.0\t900.0\t..." for i in range(250)]
        lines += [f"EFIX L\t{start}\t{start + 996}\t1000\t962.0\t540.0\t900", f"END\t{start + 1000} \tSAMPLES\tEVENTS\tRES\t35.00\t35.00"]
    return "\n".join(lines) + "\n"


def two_eyes():
    rows = [f"{4_000_000 * i},{0.4 + 0.001 * (i % 9):.4f},0.5,ok,{eye},{size}" for i in range(200)
            for eye, size in (("left", 3.25), ("right", 3.5), ("cyclopean", 3.375))]
    return harness.gaze_csv(rows, header="t[ns],u[1],v[1],valid,eye,pupil[mm]")


class BidsValidator(harness.CliTest):
    def data_set(self, name, *convert):
        root = self.folder / name
        (root / "sub-01" / "func").mkdir(parents=True)
        (root / "dataset_description.json").write_text(json.dumps({
            "Name": "Gaze", "BIDSVersion": "1.11.0", "DatasetType": "raw", "License": "CC0", "Authors": ["A. Author", "B. Author"],
            "HEDVersion": "8.2.0", "GeneratedBy": [{"Name": "gazetrace"}], "SourceDatasets": [{"URL": "file:."}]}))
        (root / "README.md").write_text("Gaze that was recorded for a test of the writer. " * 10)
        self.run_ok("gaze", "import", *convert, "-o", root / "sub-01/func/sub-01_task-view_physio.tsv.gz")
        return root

    def sets(self):
        self.write("eyelink.asc", eyelink())
        self.write("eyes.csv", two_eyes())
        self.run_ok("gaze", "synth", "-o", "head.csv", "--head", "--duration", "5s")
        # Of no stated measure of the pupil, and with messages of long before the recording.
        self.write("bare.asc", eyelink((100_000, 110_000), pupil=()))
        return [self.data_set("one", "eyelink.asc", "--keep-ids"), self.data_set("two", "eyes.csv"), self.data_set("three", "head.csv"),
                self.data_set("four", "bare.asc", "--keep-ids")]

    @unittest.skipUnless(VALIDATOR, "bids-validator-deno is not installed")
    def test_the_validator_reports_nothing(self):
        for root in self.sets():
            result = subprocess.run([VALIDATOR, str(root), "--json"], capture_output=True, check=False, env={**os.environ, "NO_COLOR": "1"})
            report = json.loads(result.stdout)
            issues = [(i["severity"], i["code"], i.get("subCode"), i.get("location")) for i in report["issues"]["issues"]
                      if i["severity"] in ("error", "warning")]
            self.assertEqual(issues, [], root.name)

    def test_what_the_standard_asks_for(self):
        one, two, _, four = self.sets()
        func = one / "sub-01/func"
        table = (func / "sub-01_task-view_events.tsv").read_text().splitlines()
        self.assertEqual(table[0].split("\t")[:3], ["onset", "duration", "trial_type"])
        rows = [line.split("\t") for line in table[1:]]
        # Seconds from the first sample, which stands at 10 s of the tracker's clock.
        self.assertIn(["0.000000000", "1.000000000", "recording", "n/a"], rows)
        self.assertIn(["9.998000000", "0.000000000", "message", "TRIALID 2"], rows)
        sidecar = json.loads((func / "sub-01_task-view_recording-eye1_physio.json").read_text())
        self.assertEqual((sidecar["AverageCalibrationError"], sidecar["MaximalCalibrationError"], sidecar["CalibrationCount"]), (0.35, 0.48, 1))
        self.assertIn("area", sidecar["pupil_size"]["Description"])
        of_eyes = json.loads((two / "sub-01/func/sub-01_task-view_recording-eye1_physio.json").read_text())
        self.assertIn("diameter", of_eyes["pupil_size"]["Description"])
        self.assertEqual(of_eyes["pupil_size"]["Units"], "mm")
        # It is read again as it was: the unit of the pupil, the calibration, and what the tracker states.
        self.run_ok("gaze", "import", func / "sub-01_task-view_recording-eye1_physio.tsv.gz", "-o", "again.csv", "--keep-ids")
        self.run_ok("gaze", "import", "eyelink.asc", "-o", "first.csv", "--keep-ids")
        kinds = ("# calibration", "# event fixation", "t[ns]")
        again, first = ([line for line in (self.folder / name).read_text().splitlines() if line.startswith(kinds)] for name in ("again.csv", "first.csv"))
        self.assertEqual(again, first)

        # A message of long before the recording is no event of the run, and is kept beside what the eye did.
        func = four / "sub-01/func"
        table = (func / "sub-01_task-view_events.tsv").read_text()
        self.assertIn("TRIALID 1", table)
        self.assertNotIn("DISPLAY_COORDS", table)
        self.assertIn(b"DISPLAY_COORDS", gzip.decompress((func / "sub-01_task-view_recording-eye1_physioevents.tsv.gz").read_bytes()))
        self.assertEqual(json.loads((func / "sub-01_task-view_recording-eye1_physio.json").read_text())["pupil_size"]["Units"], "arbitrary")
        self.run_ok("gaze", "import", func / "sub-01_task-view_recording-eye1_physio.tsv.gz", "-o", "bare.csv")
        self.run_ok("gaze", "import", "bare.asc", "-o", "own.csv")
        headers = [next(line for line in (self.folder / name).read_text().splitlines() if line.startswith("t[ns]")) for name in ("bare.csv", "own.csv")]
        self.assertEqual(*headers)

    def test_calibrations_by_the_standards_names_are_read(self):
        self.write("sub-1_physio.tsv.gz", gzip.compress(b"".join(b"%d\t960\t540\n" % (4 * i) for i in range(100))))
        self.write("sub-1_physio.json", json.dumps({"PhysioType": "eyetrack", "SamplingFrequency": 250, "StartTime": 0, "RecordedEye": "left",
                   "SampleCoordinateSystem": "gaze-on-screen", "Columns": ["timestamp", "x_coordinate", "y_coordinate"], "timestamp": {"Units": "ms"},
                   "x_coordinate": {"Units": "pixel"}, "y_coordinate": {"Units": "pixel"}, "AverageCalibrationError": 0.4, "MaximalCalibrationError": 0.9}))
        self.write("sub-1_events.json", json.dumps({"StimulusPresentation": {"ScreenResolution": [1920, 1080], "ScreenSize": [0.5, 0.3], "ScreenDistance": 0.6,
                                                                            "ScreenOrigin": ["top", "left"]}}))
        report = json.loads(self.run_ok("gaze", "inspect", "sub-1_physio.tsv.gz", "--json").stdout)
        self.assertEqual([(c["eye"], c["mean_deg"], c["max_deg"]) for c in report["accuracy"]], [("left", 0.4, 0.9)])


if __name__ == "__main__":
    harness.main()
