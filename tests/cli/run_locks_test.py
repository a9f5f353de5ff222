# SPDX-License-Identifier: Apache-2.0
"""Two runs do not make the same files at the same time, and a dead one holds nobody up."""

import json
import os
import signal
import socket
import subprocess
import time
from pathlib import Path

import harness
from farm_faults_test import JOB, Running, outputs


class Locks(Running):
    def test_two_runs_do_not_share_a_folder(self):
        first = self.start(*self.SLOW)
        lock = self.folder / "out/run.json.lock"
        self.wait_for(lock.exists, first)
        # From then on it makes no file until its first picture, which takes a while.
        self.wait_for(lambda: all((self.folder / "out" / name).exists() for name in ("run.json", "run.files", "timing.csv")), first)
        words = ["run.json.lock", f"process {first.pid}", "frames 1-4", "wait for it"]
        held = 3  # it will pass: worth another try
        self.assert_refused(["render", *JOB, *outputs("out"), *self.SLOW, "--resume"], words, held)
        # A part whose frames it makes as well; others are free.
        self.assert_refused(["render", *JOB, *outputs("out"), "--frames", "4-5", "--part", "--resume"], words, held)
        self.run_ok("render", *JOB, *outputs("out"), "--frames", "5-6", "--part")
        first.send_signal(signal.SIGKILL)
        first.wait()
        self.assertTrue(lock.exists())
        after = self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-4", "--resume", "--overwrite")
        self.assertIn("that run is dead", after.stderr)
        self.assertFalse(lock.exists())

    def test_a_lock_of_another_machine_that_is_silent(self):
        self.render("out", "--frames", "1")
        holder = {"host": "elsewhere", "machine": "other boot", "process": 1, "began": "5", "since_s": 1, "frames": "1", "samples": ""}
        lock = self.write("out/run.json.lock", json.dumps(holder))
        os.utime(lock, (time.time() - 3600, time.time() - 3600))
        self.assertIn("process 1 on elsewhere", self.render("out", "--frames", "1", "--resume").stderr)
        self.assertFalse(lock.exists())
        # One that cannot be read is no run either.
        self.write("out/run.json.lock", "{")
        os.utime(lock, (time.time() - 3600, time.time() - 3600))
        self.render("out", "--frames", "1", "--resume")

    def test_a_dead_run_whose_parent_has_not_asked_how_it_ended(self):
        """A zombie, as in containers in which nobody asks."""
        first = self.start(*self.SLOW)
        self.wait_for((self.folder / "out/run.json.lock").exists, first)
        first.send_signal(signal.SIGKILL)
        stat = Path(f"/proc/{first.pid}/stat")
        while " Z " not in stat.read_text():
            time.sleep(0.005)
        after = self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-4", "--resume", "--overwrite")
        self.assertIn("that run is dead", after.stderr)

    def test_every_folder_of_a_run_is_its_own(self):
        first = self.start_into(["-o", "a/f.####.exr", "-o", "b/f.####.png"], *self.SLOW)
        self.wait_for(lambda: all((self.folder / name).exists() for name in ("b", "a/run.files", "a/timing.csv")), first)
        self.wait_for(lambda: list((self.folder / "b").glob("pictures.*.run.json.lock")), first)
        self.assert_refused(["render", *JOB, "-o", "b/f.####.png", "--frames", "3"], ["b/pictures.", f"process {first.pid}"], 3)
        # Other pictures in that folder, and other frames of these, hold nobody up.
        self.run_ok("render", *JOB, "-o", "c/f.####.exr", "-o", "b/g.####.png", "--frames", "3")
        self.run_ok("render", *JOB, "-o", "b/f.####.png", "--frames", "6", "--part")
        first.send_signal(signal.SIGTERM)
        first.wait()
        self.assertEqual([path for path in self.files() if "lock" in path], [])

    def test_folders_of_any_name(self):
        self.run_ok("render", *JOB, "-o", "f.####.exr", "-o", "./g.####.png", "--frames", "1")
        self.run_ok("render", *JOB, "-o", "take#1/f.####.exr", "-o", "take%1/f.####.png", "--frames", "1")
        self.run_ok("render", *JOB, "-o", "each/%04d/f.%04d.exr", "--frames", "1-2")
        self.assertEqual([path for path in self.files() if "lock" in path], [])

    def test_what_is_no_lock_and_what_was_to_become_one(self):
        self.render("out", "--frames", "1")
        pipe = self.folder / "out/run.json.lock"
        os.mkfifo(pipe)  # to open it would take for ever
        os.utime(pipe, (time.time() - 3600, time.time() - 3600))
        left = self.folder / f"out/run.json.lock.{socket.gethostname()}.99"
        machine = Path("/proc/sys/kernel/random/boot_id").read_text().strip() + " " + os.readlink("/proc/self/ns/pid")
        left.write_text(json.dumps({"host": socket.gethostname(), "machine": machine, "process": 2**22 + 1, "began": "5", "since_s": 1,
                                    "frames": "1", "samples": ""}))
        self.render("out", "--frames", "1", "--resume")
        self.assertEqual([path for path in self.files() if "lock" in path], [])

    def start_into(self, places, *more):
        process = subprocess.Popen([harness.PROGRAM, "render", *JOB, *places, *more], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.poll() is None and process.kill(), process.wait(), process.stderr.close()))
        return process


if __name__ == "__main__":
    harness.main()
