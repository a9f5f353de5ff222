# SPDX-License-Identifier: Apache-2.0
"""A run killed at any frame and resumed leaves the same files; parts of a sequence join; threads change nothing."""

import csv
import json
import random
import signal
import subprocess
import time

import harness

# What stands on the command line wins over this file.
JOB_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "160x90"
frame-rect = [0, 0, 64, 36]
frames = "1-12"
region-samples = [64, 64, 64]
exposure = 0.5
quiet = true
"""
JOB = ["--config", "job.toml"]


def outputs(folder):
    return ["-o", f"{folder}/f.####.exr", "-o", f"{folder}/f.####.png", "--map", f"{folder}/m.####.exr"]


class Sequences(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.write("log.csv", harness.moving_gaze())
        self.write("job.toml", JOB_TOML)

    def render(self, folder, *more):
        self.run_ok("render", *JOB, *outputs(folder), *more)
        return self.pictures(folder)

    def frames_in_timing(self, path):
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return [int(row["frame"]) for row in csv.DictReader(file)]

    def kill_after(self, folder, pictures, *more):
        """Starts a run and kills it as soon as so many pictures are there."""
        process = subprocess.Popen([harness.PROGRAM, "render", *JOB, *outputs(folder), *more], cwd=self.folder)
        deadline = time.monotonic() + 120
        while process.poll() is None and time.monotonic() < deadline:
            if len(list((self.folder / folder).glob("f.*.exr"))) >= pictures:
                time.sleep(random.random() * 0.02)
                process.send_signal(signal.SIGKILL)
                break
            time.sleep(0.001)
        process.wait()
        return process.returncode

    def check_kill_and_resume(self, *more):
        whole = self.render("whole", *more)
        self.assertEqual(len(whole), 36)
        killed = 0
        for pictures in (0, 1, 5, 9):
            with self.subTest(pictures=pictures):
                folder = f"killed{pictures}"
                (self.folder / folder).mkdir()
                killed += self.kill_after(folder, pictures, *more) == -signal.SIGKILL
                self.assertEqual(self.render(folder, *more, "--resume"), whole)
                self.assertEqual(self.frames_in_timing(f"{folder}/f.timing.csv"), list(range(1, 13)))
                self.assertEqual([name for name in self.files(folder) if "part" in name or "tmp" in name], [])
        self.assertGreater(killed, 0, "every run was finished before it could be killed")

    def test_killed_and_resumed(self):
        self.check_kill_and_resume()

    def test_resume_with_a_camera_at_rest(self):
        still = ["--eye", "0,1,4", "--target", "0,0,0", "--exposure", "auto"]
        whole = self.render("whole", *still)
        self.render("again", *still)
        for name in ("f.0006.exr", "f.0009.png"):
            (self.folder / "again" / name).unlink()
        self.assertEqual(self.render("again", *still, "--resume"), whole)
        self.assertNotEqual(whole["f.0001.exr"], whole["f.0002.exr"])

    def test_resume_renders_what_other_settings_left(self):
        first = self.render("out", "--frames", "1-4")
        again = ["render", *JOB, *outputs("out"), "--frames", "1-4", "--resume", "--seed", "5"]
        self.assert_refused(again, ["4 finished frames, 1-4", "--seed was 0 and is 5", "--overwrite"])
        self.run_ok(*again, "--overwrite")
        second = self.pictures("out")
        self.assertTrue(all(first[name] != second[name] for name in first if name.startswith("f.0")))

    def test_resume_does_nothing_twice(self):
        self.render("out", "--frames", "1-4")
        before = {path: path.stat().st_mtime_ns for path in (self.folder / "out").glob("?.[0-9]*")}
        summary = json.loads(self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-4", "--resume", "--json").stdout)
        self.assertEqual((summary["rendered"], summary["skipped"]), (0, 4))
        self.assertEqual({path: path.stat().st_mtime_ns for path in (self.folder / "out").glob("?.[0-9]*")}, before)

    def test_threads_and_neighbours_change_nothing(self):
        whole = self.render("whole", "--threads", "2")
        self.assertEqual(self.render("one", "--threads", "1"), whole)
        alone = self.render("alone", "--only-frame", "7")
        self.assertEqual(set(alone), {"f.0007.exr", "f.0007.png", "m.0007.exr"})
        for name, content in alone.items():
            self.assertEqual(content, whole[name], name)

    def test_parts_join(self):
        whole = self.render("whole")
        for frames in ("5-8", "1-4", "9-12"):
            self.render("parts", "--frames", frames, "--chunk", "1/1")
        self.assertEqual(self.pictures("parts"), whole)
        records = [name for name in self.files("parts") if name.endswith((".json", ".csv"))]
        self.assertEqual(records, sorted(f"f.{stem}.{frames}.{suffix}" for frames in ("1-4", "5-8", "9-12")
                                         for stem, suffix in (("run", "json"), ("timing", "csv"))))
        self.assertIn("1-12", self.run_ok("merge", "parts").stdout)
        self.assertEqual(self.frames_in_timing("parts/f.timing.csv"), list(range(1, 13)))
        digests = [json.loads((self.folder / folder / "f.run.json").read_text())["settings_digest"] for folder in ("parts", "whole")]
        self.assertEqual(digests[0], digests[1])
        self.assert_refused(["merge", "parts"], ["exists", "--overwrite"])

    def test_files_by_another_name_are_the_same_job(self):
        whole = self.render("whole", "--frames", "1-2")
        self.write("copy/elsewhere.gltf", (self.folder / "glide.gltf").read_bytes())
        self.run_ok("render", "copy/elsewhere.gltf", *JOB, *outputs("other"), "--frames", "1-2")
        self.assertEqual(self.pictures("other"), whole)


if __name__ == "__main__":
    harness.main()
