# SPDX-License-Identifier: Apache-2.0
"""Two runs do not make the same files at the same time, wherever they run and however long one is stopped."""

import ctypes
import errno
import json
import os
import platform
import signal
import struct
import subprocess
import time
import unittest
from pathlib import Path

import harness
from farm_faults_test import JOB, Running, outputs
from farm_test import FARM_TOML

# A list of processes of its own, as in containers and on other machines: nothing can be asked of the other run.
NAMESPACE = ["unshare", "--pid", "--fork", "--mount-proc", "--kill-child"]


def can_make_namespaces():
    try:
        return subprocess.run([*NAMESPACE, "true"], capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def without_locks():
    """In a child before the program: the kernel refuses F_OFD_GETLK and what comes after it, as a file system without locks."""
    numbers = {"x86_64": 72, "aarch64": 25}  # of fcntl
    program = [(0x20, 0, 0, 0), (0x15, 0, 3, numbers[platform.machine()]), (0x20, 0, 0, 24), (0x35, 0, 1, 36),
               (0x06, 0, 0, 0x00050000 | errno.ENOLCK), (0x06, 0, 0, 0x7FFF0000)]
    code = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *line) for line in program))
    filter_of = ctypes.create_string_buffer(struct.pack("HxxxxxxP", len(program), ctypes.addressof(code)))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(38, 1, 0, 0, 0) != 0 or libc.prctl(22, 2, filter_of, 0, 0) != 0:
        os._exit(77)


class Locks(Running):
    OUTPUTS = ["-o", "a/f.####.exr", "-o", "b/f.####.png"]
    # No frame of it is finished while the test looks.
    SLOW = [option.replace("400", "9000") for option in Running.SLOW] + ["--grace", "0s"]

    def begin(self, *more, before=()):
        """A run that holds its files, and takes a while."""
        process = subprocess.Popen([*before, harness.PROGRAM, "render", *JOB, *self.OUTPUTS, *self.SLOW, *more], cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.poll() is None and process.kill(), process.wait(), process.stderr.close()))
        self.wait_for(lambda: all(self.owners(folder) for folder in ("a", "b")) and (self.folder / "a/f.run.files").exists(), process)
        return process

    def owners(self, folder):
        path = self.folder / folder / ".gazetrace.lock"
        return path.read_text() if path.exists() else ""

    def refused(self, places, words, *more):
        """It will pass: the exit code says that another try is worth it."""
        return self.assert_refused(["render", *JOB, *places, "--frames", "3", *more], [*words, "wait for it"], 3)

    def test_every_folder_of_a_run_is_its_own_however_it_is_spelled(self):
        first = self.begin()
        (self.folder / "link").symlink_to("b")
        (self.folder / "c").mkdir()
        self.run_ok("render", *JOB, "-o", "c/f.####.exr", "-o", "b/g.####.png", "--frames", "3")
        for name in ("b/f.####.png", "b/f.%04d.png", "link/f.%04d.png", "./b/../link/f.0003.png"):
            self.refused(["-o", "e/h.####.exr", "-o", name], ["f.0003.png", f"process {first.pid} on", "render --config job.toml"])
        self.assert_refused(["render", *JOB, *self.OUTPUTS, *self.SLOW, "--resume"], ["a/", f"process {first.pid} on"], 3)
        # Other frames are free.
        self.run_ok("render", *JOB, "-o", "d/f.####.exr", "-o", "b/f.####.png", "--frames", "5-6")
        first.send_signal(signal.SIGTERM)
        first.wait()
        self.assertEqual([self.owners(folder) for folder in ("a", "b", "c", "d")], [""] * 4)

    def test_chunks_share_a_folder_at_the_same_time(self):
        self.OUTPUTS = outputs("a") + ["--map", "b/m.####.exr"]
        job = ["render", *JOB, *self.OUTPUTS]
        first = subprocess.Popen([harness.PROGRAM, *job, *self.SLOW, "--chunk", "1/2"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (first.kill(), first.wait(), first.stderr.close()))
        self.wait_for(lambda: self.owners("b") and list((self.folder / "a").glob("*run.*.files")), first)
        self.run_ok(*job, "--frames", "1-4", "--chunk", "2/2")
        self.assertIsNone(first.poll(), "it was to run all the while")
        self.assert_refused([*job, *self.SLOW, "--chunk", "1/2", "--resume"], [f"process {first.pid} on"], 3)

    def test_a_merge_writes_no_record_that_is_a_run_s(self):
        for frame in ("5", "6"):
            self.run_ok("render", *JOB, "-o", "a/f.####.exr", "--frames", frame, "--chunk", "1/1")
        first = self.begin()
        record = (self.folder / "a/f.run.json").read_bytes()
        self.assert_refused(["merge", "a", "--overwrite"], ["another run is writing", f"process {first.pid} on"], 3)
        self.assertEqual((self.folder / "a/f.run.json").read_bytes(), record)

    def test_nothing_of_a_run_is_read_or_renamed_before_it_ends(self):
        self.run_ok("render", *JOB, "-o", "c/g.####.exr", "--frames", "3")
        for name in ("run.json", "timing.csv"):  # as the version before named them
            (self.folder / "c" / f"g.{name}").rename(self.folder / "c" / name)
        self.begin()
        self.refused(["-o", "c/g.####.exr", "-o", "b/f.####.png"], ["f.0003.png"], "--resume")

    def test_a_killed_run_holds_up_nobody(self):
        first = self.begin()
        first.send_signal(signal.SIGKILL)
        stat = Path(f"/proc/{first.pid}/stat")
        while " Z " not in stat.read_text():  # nobody has asked yet how it ended, as in containers in which nobody asks
            time.sleep(0.005)
        self.run_ok("render", *JOB, *self.OUTPUTS, "--frames", "1-4", "--resume", "--overwrite")

    @unittest.skipUnless(can_make_namespaces(), "no namespace of processes can be made here")
    def test_a_run_that_is_stopped_elsewhere_keeps_its_files(self):
        """No time-out: `GAZETRACE_LOCKS_STOPPED_S` says for how long it is stopped, and the refusal waits for nothing."""
        first = self.begin(before=NAMESPACE)
        [inside] = Path(f"/proc/{first.pid}/task/{first.pid}/children").read_text().split()
        os.kill(int(inside), signal.SIGSTOP)
        while " T " not in Path(f"/proc/{inside}/stat").read_text():
            time.sleep(0.005)
        time.sleep(float(os.environ.get("GAZETRACE_LOCKS_STOPPED_S", "2")))
        second = [*NAMESPACE, harness.PROGRAM, "render", *JOB, "-o", "c/f.####.exr", "-o", "b/f.%04d.png", "--frames", "1-4"]
        result = subprocess.run(second, cwd=self.folder, capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("process 1 on", result.stderr)
        self.assertEqual(self.pictures("b"), {})
        os.kill(int(inside), signal.SIGCONT)
        self.assertIsNone(first.poll())
        os.kill(int(inside), signal.SIGTERM)
        self.assertEqual(first.wait(timeout=120), 4)

    def test_a_file_system_without_locks(self):
        if platform.machine() not in ("x86_64", "aarch64"):
            self.skipTest("the number of the system call is not known")
        result = subprocess.run([harness.PROGRAM, "render", *JOB, *self.OUTPUTS, "--frames", "1-2"], cwd=self.folder, capture_output=True,
                                text=True, preexec_fn=without_locks, check=False)
        if result.returncode == 77:
            self.skipTest("system calls cannot be filtered here")
        self.assertEqual(result.returncode, 0, result.stderr)
        said = [line for line in result.stderr.splitlines() if "no files can be locked" in line]
        self.assertEqual(len(said), 2, result.stderr)
        self.assertEqual(sorted(self.pictures("a")), ["f.0001.exr", "f.0002.exr"])

    def test_what_cannot_be_known_without_locks(self):
        self.write("farm.toml", FARM_TOML)
        self.run_ok("farm", "farm.toml", "--chunks", "2")
        [record] = (self.folder / "out").glob("f.run.1-*.json")
        record.write_text(record.read_text().replace('"state": "done"', '"state": "running"'))
        for name in ("f.0001.exr", "farm/tasks/1.exit"):
            (self.folder / "out" / name).unlink()
        for prepare, state in ((None, "failed"), (without_locks, "unknown")):
            told = subprocess.run([harness.PROGRAM, "farm", "status", "out", "--json"], cwd=self.folder, capture_output=True, text=True,
                                  preexec_fn=prepare, check=False)
            if told.returncode == 77:
                self.skipTest("system calls cannot be filtered here")
            self.assertEqual(json.loads(told.stdout)["tasks"][0]["state"], state, told.stderr)
        # Somebody may be at it: nobody begins it a second time unasked.
        refused = subprocess.run([harness.PROGRAM, "farm", "retry", "out"], cwd=self.folder, capture_output=True, text=True,
                                 preexec_fn=without_locks, check=False)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("task 1 still runs cannot be told", refused.stderr)

    def test_folders_of_any_name(self):
        self.run_ok("render", *JOB, "-o", "f.####.exr", "-o", "./g.####.png", "--frames", "1")
        self.run_ok("render", *JOB, "-o", "take#1/f.####.exr", "-o", "take%1/f.####.png", "--frames", "1")
        self.run_ok("render", *JOB, "-o", "each/%04d/f.%04d.exr", "--frames", "1-2")
        self.assertFalse((self.folder / "each/0001/.gazetrace.lock").exists())


if __name__ == "__main__":
    harness.main()
