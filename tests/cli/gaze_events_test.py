# SPDX-License-Identifier: Apache-2.0
"""Events, synthetic gaze, conversion and processing from outside."""

import base64
import csv
import gzip
import json
import xml.etree.ElementTree

import harness


class GazeTools(harness.CliTest):
    def synth(self, *arguments):
        self.run_ok("gaze", "synth", "-o", "log.csv", "--truth", "truth.tsv", "--duration", "5s", "--noise", "0.05", *arguments)

    def events(self, *arguments):
        text = self.run_ok("gaze", "events", *arguments).stdout
        return list(csv.DictReader(text.splitlines(), delimiter="\t"))

    def plan(self, *arguments):
        return self.run_ok("plan", "--gaze", "log.csv", "--eye", "0,1,4", "--target", "0,0,0", "--size", "64x36",
                           "--frames", "1-10", *arguments)

    def test_events_of_a_synthetic_log_are_its_truth(self):
        self.synth()
        with open(self.folder / "truth.tsv") as file:
            rows = list(csv.DictReader(file, delimiter="\t"))
        # A movement that the log's end cuts after a sample or two is not there to be found.
        truth = [row["movement"] for row in rows if row is not rows[-1] or float(row["duration_ms"]) >= 10]
        found = [row["movement"] for row in self.events("log.csv")]
        for movement in ("fixation", "saccade"):
            self.assertEqual(found.count(movement), truth.count(movement))
        self.run_ok("gaze", "events", "log.csv", "--method", "adaptive", "-o", "events.json")
        report = json.loads((self.folder / "events.json").read_text())
        self.assertEqual(report["preset"], "adaptive")
        self.assertGreater(report["peak_threshold_deg_s"], 0)

    def test_presets_of_headsets_and_desktops_do_not_mix(self):
        self.synth()
        self.assert_refused(["gaze", "events", "log.csv", "--method", "ivt-attention"], ["recorded on a desktop", "use ivt"])
        self.run_ok("gaze", "synth", "-o", "head.csv", "--head", "--duration", "2s")
        self.assert_refused(["gaze", "events", "head.csv", "--method", "ivt"], ["recorded on a head", "ivt-attention"])
        self.assertTrue(self.events("head.csv"))
        self.assertTrue(self.events("head.csv", "--method", "ivt", "--device", "desktop"))
        self.assert_refused(["gaze", "events", "head.csv", "--method", "ivtt"], ["did you mean 'ivt'"])

    def test_places_without_angles_are_refused_until_a_screen_is_given(self):
        self.write("bare.csv", "t[ns],u[1],v[1]\n" + "".join(f"{i * 4000000},0.5,0.5\n" for i in range(100)))
        self.assert_refused(["gaze", "events", "bare.csv"], ["size and distance", "--screen"])
        self.assertEqual([row["movement"] for row in self.events("bare.csv", "--screen", "paper")], ["fixation"])

    def test_conversion_to_bids_and_back(self):
        self.synth("--blinks", "30")
        self.run_ok("gaze", "convert", "log.csv", "-o", "sub-01_task-view_physio.tsv.gz")
        name = "sub-01_task-view_recording-cyclopean_physio"
        sidecar = json.loads((self.folder / f"{name}.json").read_text())
        self.assertEqual(sidecar["Columns"][:3], ["timestamp", "x_coordinate", "y_coordinate"])
        self.assertEqual(sidecar["PhysioType"], "eyetrack")
        first = gzip.decompress((self.folder / f"{name}.tsv.gz").read_bytes()).split(b"\n")[0].split(b"\t")
        self.assertEqual(len(first), len(sidecar["Columns"]))
        screen = json.loads((self.folder / "sub-01_task-view_events.json").read_text())["StimulusPresentation"]
        self.assertEqual(screen["ScreenResolution"], [1920, 1080])
        self.run_ok("gaze", "convert", f"{name}.tsv.gz", "-o", "again.csv")

        def rows(path):
            lines = (self.folder / path).read_text().splitlines()
            return [line for line in lines if not line.startswith("#")]
        self.assertEqual(rows("again.csv"), rows("log.csv"))
        self.assert_refused(["gaze", "convert", "log.csv", "-o", "sub-01_task-view_physio.tsv.gz"], ["exists already"])

    def test_processing_is_printed_recorded_and_exported(self):
        self.synth("--lost-share", "0.05")
        text = self.run_ok("gaze", "convert", "log.csv", "-o", "clean.csv", "--gaze-process", "fill-gaps",
                           "--gaze-process", "median:samples=5").stdout
        self.assertIn("fill-gaps:max=75ms,angle=1deg: ", text)
        self.assertIn("interpolated", (self.folder / "clean.csv").read_text())
        plan = json.loads(self.plan("--gaze-process", "noise:sd=1,seed=4", "--json").stdout)
        self.assertEqual(len(plan["gaze_processing"]), 1)
        self.assertNotEqual(plan["frames"][0]["gaze_render"]["u"], plan["frames"][0]["gaze_true"]["u"])
        self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--region-samples", "1,1,1", "--frames", "1-2",
                    "--gaze-process", "snap-to-landing", "-o", "out/f.####.exr", "--quiet")
        record = json.loads((self.folder / "out/run.json").read_text())
        self.assertIn("(oracle)", record["facts"]["gaze processing"])
        # 500 Hz: a sample is at most 2 ms old; half of a frame at 24 fps is 20.8 ms.
        self.assertRegex(record["facts"]["effective gaze age"], r"^[01]\.\d ms in the median, .*over 2 frames; 20\.8 ms less")
        self.assertIn("snap-to-landing", record["config_toml"])
        with open(self.folder / "out/timing.csv") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(rows[0]["gaze_event"], "fixation")
        self.assertEqual(rows[0]["no_gaze"], "0")
        self.assert_refused(["plan", "--gaze", "log.csv", "--eye", "0,1,4", "--target", "0,0,0", "--gaze-process", "mediam"],
                            ["did you mean 'median'"])

    def test_latency_is_judged_by_the_frame_rate(self):
        self.synth()
        slow = self.plan("--gaze-latency", "50ms", "--fps", "24")
        self.assertIn("effective age at mid-display", slow.stdout)
        self.assertIn("1.2 frames at 24 fps", slow.stderr)
        self.assertNotIn("frames at", self.plan("--gaze-latency", "50ms", "--fps", "120").stderr)

    def test_a_picture_lies_behind_the_scanpath(self):
        self.synth()
        self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--region-samples", "1,1,1", "--frames", "1",
                    "-o", "f.####.png", "--quiet")
        self.run_ok("gaze", "inspect", "log.csv", "--svg", "gaze.svg", "--frame-image", "f.0001.png")
        svg = xml.etree.ElementTree.parse(self.folder / "gaze.svg").getroot()
        space = "{http://www.w3.org/2000/svg}"
        images = list(svg.iter(space + "image"))
        self.assertEqual(len(images), 1)
        head, data = images[0].get("href").split(",", 1)
        self.assertEqual(head, "data:image/png;base64")
        self.assertEqual(base64.b64decode(data, validate=True), (self.folder / "f.0001.png").read_bytes())
        # It fills the display, which is drawn as a white rectangle.
        display = [r for r in svg.iter(space + "rect") if r.get("fill") == "#ffffff" and r.get("stroke")]
        self.assertIn([images[0].get(k) for k in ("x", "y", "width", "height")],
                      [[r.get(k) for k in ("x", "y", "width", "height")] for r in display])
        self.assertAlmostEqual(float(images[0].get("width")) / float(images[0].get("height")), 16 / 9, delta=0.01)
        self.assert_refused(["gaze", "inspect", "log.csv", "--svg", "other.svg", "--frame-image", "none.png"], ["none.png"])

    def test_anchors_map_the_clock(self):
        self.synth()
        plan = json.loads(self.plan("--gaze-anchor", "1s=0s", "--gaze-anchor", "3s=2.0002s", "--fps", "10", "--json").stdout)
        # Frame 1 is at 50 ms of the video; the video's clock runs 100 ppm faster.
        self.assertAlmostEqual(plan["frames"][0]["gaze_true"]["t_log_ns"], 1e9 + 50e6 / 1.0001, delta=2)
        base = ["plan", "--gaze", "log.csv", "--eye", "0,1,4", "--target", "0,0,0"]
        self.assert_refused([*base, "--gaze-anchor", "1s=0s", "--gaze-offset", "1s"], ["--gaze-anchor", "leave"])
        self.assert_refused([*base, "--gaze-anchor", "TRIAL=0s"], ["no message 'trial'"])
        self.assert_refused([*base, "--gaze-anchor", "1s"], ["no video time"])

    def test_uncertainty_needs_to_be_known(self):
        self.synth()
        base = ["plan", "--gaze", "log.csv", "--eye", "0,1,4", "--target", "0,0,0", "--frames", "10"]
        self.assert_refused([*base, "--gaze-uncertainty"], ["accuracy", "--gaze-accuracy"])
        self.assert_refused([*base, "--gaze-accuracy", "1"], ["--gaze-uncertainty"])
        plan = json.loads(self.run_ok(*base, "--gaze-uncertainty", "--gaze-accuracy", "1", "--json").stdout)
        self.assertGreater(plan["frames"][0]["gaze_uncertainty_deg"], 1)


if __name__ == "__main__":
    harness.main()
