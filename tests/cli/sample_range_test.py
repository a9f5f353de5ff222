# SPDX-License-Identifier: Apache-2.0
"""Parts of the samples: merged they are the one run's files; what does not belong together is refused."""

import csv
import json
import random
import signal
import subprocess
import time

import harness

JOB_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "160x90"
frame-rect = [0, 0, 64, 36]
frames = "1-3"
region-samples = [64, 32, 20]
filter = "linear"
aov = ["albedo", "normal", "depth", "samples", "variance", "eccentricity"]
exposure = "auto"
quiet = true
"""
JOB = ["--config", "job.toml"]


def outputs(folder):
    return ["-o", f"{folder}/f.####.exr", "-o", f"{folder}/f.####.png", "--map", f"{folder}/m.####.exr"]


class SampleRanges(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.write("log.csv", harness.moving_gaze())
        self.write("job.toml", JOB_TOML)

    def render(self, folder, *more):
        self.run_ok("render", *JOB, *outputs(folder), *more)

    def parts(self, folder, ranges, *more):
        for samples in ranges:
            self.render(folder, "--sample-range", samples, *more)

    def merged(self, folder, ranges, *more):
        self.parts(folder, ranges, *more)
        self.assertEqual(self.pictures(folder), {}, "parts are no pictures")
        self.run_ok("merge", folder)
        return self.pictures(folder)

    def test_any_split_is_the_one_run(self):
        whole = self.merged("whole", ["0:64"])
        self.assertEqual(len(whole), 9)
        for number, ranges in enumerate((["0:16", "16:64"], ["33:64", "0:1", "1:33"], ["16:32", "48:90", "0:16", "32:48"])):
            with self.subTest(ranges=ranges):
                self.assertEqual(self.merged(f"split{number}", ranges, "--threads", "1"), whole)
                self.assertEqual(len(self.run_ok("merge", f"split{number}", "--overwrite").stdout.split()), 5)
                self.assertEqual(self.pictures(f"split{number}"), whole)

    def test_it_is_what_is_rendered_at_once(self):
        """Names, headers and digests too. Rays that graze an edge may differ: none does here."""
        merged = self.merged("parts", ["0:20", "20:64"])
        self.render("plain")
        self.assertEqual(merged, self.pictures("plain"))
        rows = {}
        for folder in ("parts", "plain"):
            with open(self.folder / folder / "timing.csv", newline="", encoding="utf-8") as file:
                rows[folder] = [(row["frame"], row["samples"], row["rays_primary"], row["fovea_samples"], row["exposure_ev"])
                                for row in csv.DictReader(file)]
        self.assertEqual(rows["parts"], rows["plain"])
        self.assertEqual(json.loads((self.folder / "parts/run.json").read_text())["frames"], "1-3")

    def test_frames_and_samples_in_parts(self):
        whole = self.merged("whole", ["0:64"])
        for frames, samples in (("1", "0:64"), ("2-3", "0:9"), ("2-3", "9:64")):
            self.render("parts", "--frames", frames, "--sample-range", samples)
        self.run_ok("merge", "parts")
        self.assertEqual(self.pictures("parts"), whole)

    def kill_and_resume(self, folder, samples):
        """Kills a part once it has written its first frame, and does it again; whether it was killed."""
        command = [harness.PROGRAM, "render", *JOB, *outputs(folder), "--sample-range", samples]
        process = subprocess.Popen(command, cwd=self.folder)
        deadline = time.monotonic() + 120
        while process.poll() is None and time.monotonic() < deadline:
            if list((self.folder / folder).glob(f"samples.0001.{samples.replace(':', '-')}.sums")):
                time.sleep(random.random() * 0.05)
                process.send_signal(signal.SIGKILL)
                break
            time.sleep(0.001)
        killed = process.wait() == -signal.SIGKILL
        self.render(folder, "--sample-range", samples, "--resume")
        return killed

    def test_killed_part_leaves_no_half_file(self):
        whole = self.merged("whole", ["0:64"])
        for attempt in range(20):  # on a busy machine a part may be finished before it is seen to have begun
            folder = f"killed{attempt}"
            (self.folder / folder).mkdir()
            killed = [self.kill_and_resume(folder, samples) for samples in ("0:60", "60:64")]
            self.run_ok("merge", folder)
            self.assertEqual(self.pictures(folder), whole)
            self.assertEqual([name for name in self.files(folder) if "part" in name], [])
            if any(killed):
                return
        self.fail("every part was finished before it could be killed")

    def test_what_does_not_belong_together(self):
        self.parts("hole", ["0:8", "24:64"])
        self.assert_refused(["merge", "hole"], ["samples 8:24 of frame 1 are missing", "--sample-range 8:24"])
        self.parts("short", ["0:8", "8:63"])
        self.assert_refused(["merge", "short"], ["samples 63:64 of frame 1 are missing"])
        self.parts("twice", ["0:8", "7:64"])
        self.assert_refused(["merge", "twice"], ["samples 7:8 of frame 1 are in another part as well"])
        self.parts("other", ["0:8"])
        self.parts("other", ["8:64"], "--seed", "4")
        self.assert_refused(["merge", "other"], ["other settings"])
        self.parts("kinds", ["0:8"])
        self.render("kinds", "--chunk", "1/1")
        self.assert_refused(["merge", "kinds"], ["another kind"])
        self.parts("good", ["0:8", "8:64"])
        sums = self.folder / "good/samples.0001.8-64.sums"
        good = sums.read_bytes()
        for damage in (good[:-100], good[:2000] + b"x" + good[2001:], b"something else"):
            sums.write_bytes(damage)
            self.assert_refused(["merge", "good"], ["samples.0001.8-64.sums"])
        sums.write_bytes(good)
        self.assert_refused(["render", *JOB, *outputs("good"), "--sample-range", "0:8"], ["exists already"])
        self.write("log.csv", harness.moving_gaze(samples=99))
        self.assert_refused(["merge", "good"], ["other files"])

    def test_what_cannot_be_made_of_parts(self):
        cases = [
            (["--sample-range", "8"], "A:B"),
            (["--sample-range", "8:8"], "A:B"),
            (["--sample-range=-1:8"], "A:B"),
            (["--sample-range", "0:8", "--filter", "guided"], "guided"),
            (["--sample-range", "0:8", "--accumulate", "running"], "depend on those before"),
            (["--sample-range", "0:8", "--only-pixel", "3,4"], "one pixel"),
            (["--sample-range", "0:8", "--falloff", "linear", "--contrast-strength", "0.5"], "first look"),
            (["--sample-range", "0:65", "--falloff", "uniform", "--spp", "64"], "beyond the 64 samples"),
        ]
        for options, text in cases:
            with self.subTest(options=options):
                self.assert_refused(["render", *JOB, *outputs("bad"), *options], [text])


if __name__ == "__main__":
    harness.main()
