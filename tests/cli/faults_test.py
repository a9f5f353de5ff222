# SPDX-License-Identifier: Apache-2.0
"""What must not happen unseen: films that a full disk cut, devices that become files, signals that leave tasks behind."""

import os
import signal
import stat
import subprocess
import time

import harness

# Takes all frames, leaves half a film, says so and ends well, as ffmpeg 5.1 does on a full disk.
CUTS_FILMS = """#!/bin/sh
for out; do :; done
cat > /dev/null
printf 'half a film' > "$out"
echo 'av_interleaved_write_frame(): No space left on device' >&2
"""
STILL = [*harness.SCREEN, "--size", "64x36", "--gaze-at", "0.5,0.5"]


class Faults(harness.CliTest):
    def start(self, *words, before=None):
        self.addCleanup(lambda: process.poll() is None and process.kill())
        log = open(self.folder / "log", "wb")  # the child's, too
        process = subprocess.Popen([harness.PROGRAM, *map(str, words)], cwd=self.folder, stdout=log, stderr=log, preexec_fn=before)
        log.close()
        return process

    def wait_for(self, is_there, seconds=60):
        limit = time.time() + seconds
        while not is_there():
            self.assertLess(time.time(), limit, (self.folder / "log").read_text())
            time.sleep(0.02)

    def test_a_film_that_a_full_disk_cut_is_none(self):
        self.run_ok("render", "box.gltf", *STILL, "--frames", "1-2", "-o", "p.####.png", "--quiet")
        cutter = self.write("cutter", CUTS_FILMS)
        cutter.chmod(0o755)
        video = ["video", "p.####.png", "-o", "v.mp4", "--fps", "24", "--ffmpeg", str(cutter)]
        self.assert_refused(video, ["v.mp4", "No space left"], code=3)
        self.write("v.mp4", "a good one")
        self.assert_refused([*video, "--overwrite"], ["v.mp4"], code=3)
        self.assertEqual((self.folder / "v.mp4").read_text(), "a good one")

    def test_a_pipe_stays_one(self):
        os.mkfifo(self.folder / "pipe")
        for more in ([], ["--overwrite"]):
            self.assert_refused(["plan", "--counts", *STILL, "--json", "pipe", *more], ["pipe: "])
            self.assertTrue(stat.S_ISFIFO((self.folder / "pipe").stat().st_mode))

    def test_a_camera_file_is_replaced_only_where_that_is_asked_for(self):
        self.write("c.chan", "of a day's work\n")
        save = ["plan", "box.gltf", *STILL, "--save-camera", "c.chan"]
        self.assert_refused(save, ["c.chan", "--overwrite"])
        self.assertEqual((self.folder / "c.chan").read_text(), "of a day's work\n")
        self.run_ok(*save, "--overwrite")
        self.assertNotIn("work", (self.folder / "c.chan").read_text())

    def test_settings_that_are_nested_without_end_are_refused(self):
        for text in (".".join("a" * 30_000) + " = 1\n", "[" + ".".join("a" * 30_000) + "]\n"):
            self.write("deep.toml", text)
            self.assert_refused(["plan", "--config", "deep.toml"], ["deep.toml:1", "too deep"])

    def long_render(self):
        return ["render", "box.gltf", *STILL, "--size", "320x180", "--frames", "1-200", "--spp", "16", "--accumulate", "off",
                "--threads", "1", "-o", "out/f.####.exr"]

    def test_a_terminal_that_closes_ends_a_run_like_a_queue_does(self):
        run = self.start(*self.long_render())
        self.wait_for((self.folder / "out/f.0001.exr").exists)
        run.send_signal(signal.SIGHUP)
        self.assertEqual(run.wait(timeout=60), 4, (self.folder / "log").read_text())
        self.assertIn("HUP", (self.folder / "log").read_text())

    def test_a_run_under_nohup_does_not_mind(self):
        run = self.start(*self.long_render(), before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_for((self.folder / "out/f.0001.exr").exists)
        run.send_signal(signal.SIGHUP)
        self.wait_for((self.folder / "out/f.0003.exr").exists)
        self.assertIsNone(run.poll())

    def test_a_farm_that_is_told_to_end_takes_its_tasks_along(self):
        for name, number in (("a", signal.SIGTERM), ("b", signal.SIGINT)):
            with self.subTest(signal=number):
                (self.folder / name).mkdir()
                (self.folder / name / "j.toml").write_text(
                    f'scene = "{self.folder}/box.gltf"\nfps = "10"\nsize = "320x180"\nspp = 16\naccumulate = "off"\n'
                    f'frames = "1-60"\noutput = ["{self.folder}/{name}/f.####.exr"]\n')
                farm = self.start("farm", f"{name}/j.toml", "--chunks", "3", "--processes", "1", "--threads", "1")
                self.wait_for(lambda: list((self.folder / name).glob("f.*.exr")))
                farm.send_signal(number)
                self.assertEqual(farm.wait(timeout=60), 4, (self.folder / "log").read_text())
                left = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
                self.assertFalse([line for line in left.splitlines() if str(self.folder) in line])


if __name__ == "__main__":
    harness.main()
