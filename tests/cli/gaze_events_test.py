# SPDX-License-Identifier: Apache-2.0
"""Events, synthetic gaze, conversion and processing from outside."""

import csv
import gzip
import json
import math

import harness


def eyelink(messages=()):
    """Two fixations of one eye with a saccade between them, as EyeLink writes them."""
    lines = ["** CONVERTED FROM x.edf", "MSG\t1000 DISPLAY_COORDS 0 0 1023 767", *messages, "START\t1000 \tLEFT\tSAMPLES\tEVENTS",
             "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR"]
    lines += [f"{1000 + 4 * i}\t {200 + 4 * max(0, min(i - 50, 5)) * 20:.1f}\t  300.0\t  900.0\t..." for i in range(100)]
    lines += ["EFIX L  1000\t1196\t200\t  200.0\t  300.0\t  900", "ESACC L  1200\t1216\t20\t  200.0\t  300.0\t  600.0\t  300.0\t  9.0\t 400",
              "EFIX L  1220\t1396\t180\t  600.0\t  300.0\t  900", "END\t1400 \tSAMPLES\tEVENTS\tRES\t  35.00\t  35.00"]
    return "\n".join(lines) + "\n"


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

    def test_degrees_of_a_desktop_tracker_are_known_by_their_format(self):
        self.write("gazebase.csv", "n,x,y,val,xT,yT,dP,lab\n" + "".join(f"{i},{0.01 * i},1.5,0,0,0,900,1\n" for i in range(500)))
        self.write("vr.csv", "n,x,y,lx,ly,rx,ry\n" + "".join(f"{4 * i},{0.01 * i},1.5,{0.01 * i},1.5,{0.01 * i},1.5\n" for i in range(500)))
        for output in ("again.csv", "sub-1_physio.tsv.gz"):
            self.run_ok("gaze", "import", "gazebase.csv", "-o", output)
        for log, preset in (("gazebase.csv", "ivt"), ("again.csv", "ivt"), ("sub-1_recording-cyclopean_physio.tsv.gz", "ivt"),
                            ("vr.csv", "ivt-attention")):
            self.run_ok("gaze", "events", log, "-o", "events.json", "--overwrite")
            self.assertEqual(json.loads((self.folder / "events.json").read_text())["preset"], preset, log)

    def test_places_without_angles_are_refused_until_a_screen_is_given(self):
        self.write("bare.csv", "t[ns],u[1],v[1]\n" + "".join(f"{i * 4000000},0.5,0.5\n" for i in range(100)))
        self.assert_refused(["gaze", "events", "bare.csv"], ["size and distance", "--screen"])
        self.assertEqual([row["movement"] for row in self.events("bare.csv", "--screen", "paper")], ["fixation"])

    def test_conversion_to_bids_and_back(self):
        self.synth("--blinks", "30")
        self.run_ok("gaze", "import", "log.csv", "-o", "sub-01_task-view_physio.tsv.gz")
        name = "sub-01_task-view_recording-cyclopean_physio"
        sidecar = json.loads((self.folder / f"{name}.json").read_text())
        self.assertEqual(sidecar["Columns"][:3], ["timestamp", "x_coordinate", "y_coordinate"])
        self.assertEqual(sidecar["PhysioType"], "eyetrack")
        first = gzip.decompress((self.folder / f"{name}.tsv.gz").read_bytes()).split(b"\n")[0].split(b"\t")
        self.assertEqual(len(first), len(sidecar["Columns"]))
        screen = json.loads((self.folder / "sub-01_task-view_events.json").read_text())["StimulusPresentation"]
        self.assertEqual(screen["ScreenResolution"], [1920, 1080])
        self.run_ok("gaze", "import", f"{name}.tsv.gz", "-o", "again.csv")

        def rows(path):
            lines = (self.folder / path).read_text().splitlines()
            return [line for line in lines if not line.startswith("#")]
        self.assertEqual(rows("again.csv"), rows("log.csv"))
        self.assert_refused(["gaze", "import", "log.csv", "-o", "sub-01_task-view_physio.tsv.gz"], ["exists already"])

    def head_log(self, repeats=False):
        """OpenXR poses: the eye rests on a thing in the world while the head turns by 40 degrees a second."""
        rows = []
        for i in range(200):
            a = math.radians(20 * math.sin(0.02 * i))
            head = f"0.1,{1.5 + 0.001 * i},-0.2,0,{math.sin(a / 2)},0,{math.cos(a / 2)}"
            stamp = 10_000_000 * (i // 2 * 2 if repeats else i) + 1
            rows.append(f"{10_000_000 * i + 1},{stamp},0,{math.sin(-a / 2)},0,{math.cos(-a / 2)},{head}")
        names = [f"gaze_q{c}" for c in "xyzw"] + [f"head_position_{c}" for c in "xyz"] + [f"head_q{c}" for c in "xyzw"]
        self.write("head.csv", "time[ns],sample_time," + ",".join(names) + "\n" + "\n".join(rows) + "\n")

    def test_a_converted_log_keeps_the_head_and_what_follows_from_it(self):
        for repeats in (False, True):
            self.head_log(repeats)
            self.run_ok("gaze", "import", "head.csv", "-o", "converted.csv", "--overwrite")
            columns = ("movement", "onset_ns", "offset_ns", "amplitude_deg", "dispersion_deg", "dx", "dy", "dz")
            of, kept = ([[event[c] for c in columns] for event in self.events(log)] for log in ("head.csv", "converted.csv"))
            self.assertEqual(of, kept)
            moving = ["plan", "--camera-from-gaze", "--size", "64x36", "--frames", "1-5", "--json"]
            views = [[frame["camera"] for frame in json.loads(self.run_ok(*moving, "--gaze", log).stdout)["frames"]]
                     for log in ("head.csv", "converted.csv")]
            self.assertEqual(*views)

    def test_a_converted_log_keeps_its_own_events(self):
        self.write("labels.asc", eyelink())
        self.run_ok("gaze", "import", "labels.asc", "-o", "labels.csv")
        own = [[(e["movement"], e["onset_ns"], e["offset_ns"]) for e in self.events(log, "--method", "log")] for log in ("labels.asc", "labels.csv")]
        self.assertEqual([movement for movement, *_ in own[0]], ["fixation", "saccade", "fixation"])
        self.assertEqual(*own)
        stated = [[(e["duration_ms"], e["amplitude_deg"], e["peak_velocity_deg_s"]) for e in self.events(log, "--method", "log")]
                  for log in ("labels.asc", "labels.csv")]
        self.assertEqual(*stated)

    def test_events_of_a_log_keep_what_the_tracker_states(self):
        self.write("labels.asc", eyelink())
        events = self.events("labels.asc", "--method", "log")
        # By EyeLink, the time of the last sample counts: from 1000 to 1196 ms at 250 Hz are 200 ms.
        self.assertEqual([e["duration_ms"] for e in events], ["200", "20", "180"])
        self.assertEqual([(e["amplitude_deg"], e["peak_velocity_deg_s"]) for e in events], [("n/a", "n/a"), ("9", "400"), ("n/a", "n/a")])
        # Our own velocity is named after its filter. 400 px are 11.4 deg at 35 px a degree.
        self.assertAlmostEqual(float(events[1]["measured_amplitude_deg"]), 11.4, delta=0.5)
        self.assertNotIn(events[1]["two_point_20ms_peak_velocity_deg_s"], ("n/a", "400"))
        self.run_ok("gaze", "events", "labels.asc", "--method", "log", "-o", "events.json")
        saccade = json.loads((self.folder / "events.json").read_text())["events"][1]
        self.assertEqual((saccade["duration_ms"], saccade["amplitude_deg"], saccade["peak_velocity_deg_s"]), (20, 9, 400))
        # Two fixations that touch stay two, and keep their durations.
        touching = eyelink().replace("EFIX L  1000\t1196\t200", "EFIX L  1000\t1100\t104\t  200.0\t  300.0\t  900\nEFIX L  1104\t1196\t96")
        self.write("touching.asc", touching)
        self.assertEqual([(e["movement"], e["duration_ms"]) for e in self.events("touching.asc", "--method", "log")],
                         [("fixation", "104"), ("fixation", "96"), ("saccade", "20"), ("fixation", "180")])

    def test_asks_for_nothing_that_the_log_states(self):
        rows = "t[ns],u[1],v[1],valid,eye\n" + "".join(f"{4000000 * i},0.5,0.5,ok,cyclopean\n" for i in range(40))
        for preamble, asks in (("", True), ("# display_px 1920 1080\n", False)):
            self.write("log.csv", "# gazetrace-gaze 1\n" + preamble + rows)
            said = self.assert_refused(["gaze", "events", "log.csv", "-o", "events.tsv"], ["--screen-cm W,H", "--screen-distance-cm D"])
            self.assertEqual("--screen-px" in said, asks, preamble)

    def test_no_saccade_lasts_no_time_and_no_mean_is_above_the_peak(self):
        for rate in ("60", "250", "1000"):
            self.run_ok("gaze", "synth", "-o", "log.csv", "--duration", "20s", "--noise", "0.02", "--rate", rate, "--overwrite")
            saccades = [row for row in self.events("log.csv") if row["movement"] == "saccade" and row["amplitude_deg"] != "n/a"]
            self.assertGreater(len(saccades), 20)
            for row in saccades:
                self.assertGreaterEqual(float(row["duration_ms"]), 1e3 / float(rate) - 1e-3)
                self.assertLessEqual(float(row["mean_velocity_deg_s"]), float(row["peak_velocity_deg_s"]))
                self.assertRegex(row["duration_ms"], r"^\d+(\.\d{1,3})?$")

    def test_one_frame_for_each_fixation(self):
        """Fixations at 0..196 and 220..396 ms, by the log and by detection; frame n of r a second is at (n - 1/2) / r."""
        screen = ["--screen-cm", "40,30", "--screen-distance-cm", "60"]
        job = ["box.gltf", "--gaze", "log.asc", *screen, "--frames", "fixations"]
        stated = eyelink()
        without = "\n".join(line for line in stated.splitlines() if not line.startswith(("EFIX", "ESACC"))) + "\n"
        for text, whose in ((stated, "the log's own"), (without, "by ivt")):
            self.write("log.asc", text)
            for fps, frames in (("25", [3, 8]), ("50", [5, 16]), ("2", [1])):  # 250 ms lies in the second alone
                result = self.run_ok("plan", *job, "--size", "64x48", "--fps", fps, "--json")
                self.assertEqual([frame["frame"] for frame in json.loads(result.stdout)["frames"]], frames, (whose, fps))
                lost = 2 - len(frames)
                self.assertIn(f"one for each fixation; of 2 fixations ({whose}), {lost} lie between frames and 0 outside", result.stderr)
            said = self.run_ok("render", *job, "--size", "16x12", "--fps", "25", "--spp", "1", "-o", "f.####.png", "--overwrite").stderr
            self.assertIn("one for each fixation", said)
            self.assertIn(whose, said)
            self.assertEqual([name for name in self.files() if name.endswith(".png")], ["f.0003.png", "f.0008.png"])
        self.write("job.toml", 'scene = "box.gltf"\ngaze = "log.asc"\nframes = "fixations"\nsize = "64x48"\nfps = 25\n')
        self.assertIn('frames = "fixations"', self.run_ok("render", "--config", "job.toml", "--print-config").stdout)
        self.assert_refused(["plan", *job, "--size", "64x48", "--fps", "0.1"], ["no fixation has a frame", "--fps"])

    def test_detection_that_gives_nonsense_says_so(self):
        """Noise of 0.3 degrees at 300 Hz: hundreds of saccades, where the truth has a hundred."""
        self.run_ok("gaze", "synth", "-o", "log.csv", "--noise", "0.3", "--rate", "300", "--duration", "20s")
        noisy = self.run_ok("gaze", "events", "log.csv", "-o", "events.tsv")
        for words in ("by ivt: noise of 0.", "deg RMS", "saccades begin at 30 deg/s", "saccades for", "not to be relied on", "--gaze-process "):
            self.assertIn(words, noisy.stderr)
        self.run_ok("gaze", "events", "log.csv", "-o", "events.json")
        doubts = json.loads((self.folder / "events.json").read_text())["doubts"]
        self.assertIn("noise", [doubt["code"] for doubt in doubts])
        self.assertTrue(all(doubt["what"] in noisy.stderr for doubt in doubts))
        # What is offered leaves no doubt, and the method has not changed by itself.
        self.assertIn("by ivt, ", noisy.stdout)
        offered = noisy.stderr.split("--gaze-process ")[1].split(" ")[0]
        processed = self.run_ok("gaze", "events", "log.csv", "--gaze-process", offered, "-o", "better.tsv")
        self.assertNotIn("not to be relied on", processed.stderr)
        self.assertLess((self.folder / "better.tsv").read_text().count("saccade"), (self.folder / "events.tsv").read_text().count("saccade"))
        idt = self.run_ok("gaze", "events", "log.csv", "--method", "idt", "-o", "idt.tsv").stderr
        self.assertIn("a fixation may spread over 1 deg", idt)
        # Nothing is said of good data, at any rate.
        for rate in ("50", "60", "120", "300", "1000"):
            self.run_ok("gaze", "synth", "-o", "log.csv", "--truth", "truth.tsv", "--duration", "20s", "--noise", "0.02", "--rate", rate, "--overwrite")
            self.assertEqual(self.run_ok("gaze", "events", "log.csv").stderr, "")
        self.run_ok("gaze", "events", "log.csv", "-o", "events.json", "--overwrite")
        self.assertEqual(json.loads((self.folder / "events.json").read_text())["doubts"], [])

    def test_microsaccades_of_both_eyes(self):
        """The left eye makes two of half a degree, the right eye one of them."""
        rows, random = [], 1
        for i in range(1000):
            for eye in ("left", "right"):
                random = (random * 1664525 + 1013904223) % 2**32
                ramps = [max(0, min((i - at) / 8, 1)) for at in ((200, 600) if eye == "left" else (200,))]
                u = 0.4 + 0.01 * sum(ramps) + (random / 2**32 - 0.5) * 1e-4
                random = (random * 1664525 + 1013904223) % 2**32
                rows.append(f"{i * 2_000_000},{u:.6f},{0.5 + (random / 2**32 - 0.5) * 1e-4:.6f},ok,{eye}")
        self.write("eyes.csv", harness.gaze_csv(rows))
        def count(*arguments):
            found = self.events("eyes.csv", "--method", "microsaccades", "--screen", "paper", *arguments)
            return [row["movement"] for row in found].count("microsaccade")
        self.assertEqual(count("--gaze-eye", "left"), 2)
        self.assertEqual(count("--binocular"), 1)
        self.synth()
        self.assert_refused(["gaze", "events", "log.csv", "--binocular"], ["both eyes"])
        self.assert_refused(["gaze", "events", "log.csv", "--method", "log", "--binocular"], ["--binocular"])

    def test_what_bids_has_no_place_for_is_said(self):
        self.head_log(repeats=True)  # not as many samples as poses
        result = self.run_ok("gaze", "import", "head.csv", "-o", "sub-01_physio.tsv.gz")
        self.assertIn("200 poses of the head", result.stderr)
        self.assertIn("gazetrace CSV keeps them", result.stderr)

    def test_processing_is_printed_recorded_and_exported(self):
        self.synth("--lost-share", "0.05")
        text = self.run_ok("gaze", "import", "log.csv", "-o", "clean.csv", "--gaze-process", "fill-gaps",
                           "--gaze-process", "median:samples=5").stdout
        self.assertIn("fill-gaps:max=75ms,angle=1deg: ", text)
        self.assertIn("interpolated", (self.folder / "clean.csv").read_text())
        plan = json.loads(self.plan("--gaze-process", "noise:sd=1,seed=4", "--json").stdout)
        self.assertEqual(len(plan["gaze_processing"]), 1)
        self.assertNotEqual(plan["frames"][0]["gaze_render"]["u"], plan["frames"][0]["gaze_true"]["u"])
        self.run_ok("render", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--region-samples", "1,1,1", "--frames", "1-2",
                    "--gaze-process", "snap-to-landing", "-o", "out/f.####.exr", "--quiet")
        record = json.loads((self.folder / "out/f.run.json").read_text())
        self.assertIn("(oracle)", record["facts"]["gaze processing"])
        # 500 Hz: a sample is at most 2 ms old; half of a frame at 24 fps is 20.8 ms.
        self.assertRegex(record["facts"]["effective gaze age"], r"^[01]\.\d ms in .*2 frames; 20\.8 ms less")
        self.assertIn("snap-to-landing", record["config_toml"])
        with open(self.folder / "out/f.timing.csv") as file:
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

    def test_anchors_map_the_clock(self):
        self.synth()
        plan = json.loads(self.plan("--gaze-anchor", "1s=0s", "--gaze-anchor", "3s=2.0002s", "--fps", "10", "--json").stdout)
        # Frame 1 is at 50 ms of the video; the video's clock runs 100 ppm faster.
        self.assertAlmostEqual(plan["frames"][0]["gaze_true"]["t_log_ns"], 1e9 + 50e6 / 1.0001, delta=2)
        base = ["plan", "--gaze", "log.csv", "--eye", "0,1,4", "--target", "0,0,0"]
        self.assert_refused([*base, "--gaze-anchor", "1s=0s", "--gaze-offset", "1s"], ["--gaze-anchor", "leave"])
        self.assert_refused([*base, "--gaze-anchor", "TRIAL=0s"], ["no message 'trial'"])
        self.assert_refused([*base, "--gaze-anchor", "1s"], ["no video time"])


if __name__ == "__main__":
    harness.main()
