# SPDX-License-Identifier: Apache-2.0
"""Farms on real engines: one node of Slurm, and the reference implementation of Open Job Description. Frames depend on
those before them, tasks are killed and put back into the queue, the node is drained and brought back; what comes out are
the bits of one run. By hand for more: GAZETRACE_FARM_FRAMES=200 GAZETRACE_FARM_CHUNKS=8 GAZETRACE_FARM_SEED=1
GAZETRACE_FARM_SIZE=192x108 GAZETRACE_FARM_SAMPLES="256, 128, 64"."""

import csv
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import harness
import slurm_node

FRAMES = int(os.environ.get("GAZETRACE_FARM_FRAMES", "12"))
CHUNKS = int(os.environ.get("GAZETRACE_FARM_CHUNKS", "4"))
SEED = int(os.environ.get("GAZETRACE_FARM_SEED", "1"))
SIZE = os.environ.get("GAZETRACE_FARM_SIZE", "96x54")
SAMPLES = os.environ.get("GAZETRACE_FARM_SAMPLES", "64, 32, 16")
BY_HAND = "GAZETRACE_FARM_FRAMES" in os.environ

FARM_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "{size}"
frame-rect = [0, 0, 64, 36]
region-samples = [{samples}]
accumulate = "reproject"
filter = "guided"
exposure = 0.5
frames = "1-{frames}"
output = ["{folder}/f.####.exr", "{folder}/f.####.png"]
"""


class RealEngines(harness.CliTest):
    def setUp(self):
        super().setUp()
        seconds = FRAMES / 24 + 1
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=seconds)))
        self.write("log.csv", harness.moving_gaze(samples=int(seconds * 100) + 10))
        self.write("farm.toml", FARM_TOML.format(size=SIZE, samples=SAMPLES, frames=FRAMES, folder="out"))
        self.random = random.Random(SEED)
        print(f"seed {SEED}: {FRAMES} frames of {SIZE} in {CHUNKS} chunks", flush=True)

    def one_run(self):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        begin = time.monotonic()
        self.run_ok("render", "--config", "farm.toml", "-o", "whole/f.####.exr", "-o", "whole/f.####.png", "--quiet",
                    "--threads", "1", timeout=36000)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        self.whole_cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        self.whole_wall_s = time.monotonic() - begin
        return self.pictures("whole")

    def status(self):
        return json.loads(self.run_ok("farm", "status", "out", "--json").stdout)

    def milliseconds(self, path, *columns):
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return sum(float(row[column]) for row in csv.DictReader(file) for column in columns)

    def report(self, wall_s):
        """What tracing in chunks took beside one run, and what the serial rest leaves of the speed-up. Tracing by the
        threads' own clocks, which other processes of the machine do not change; the rest by the clock."""
        parts = [path.relative_to(self.folder) for path in (self.folder / "out").glob("timing.*.csv")]
        stages = ("guides_ms", "reconstruct_ms", "temporal_ms", "exposure_ms", "color_ms", "write_ms")
        traced_s = sum(self.milliseconds(path, "trace_cpu_ms") for path in parts) / 1000
        whole_traced_s = self.milliseconds("whole/timing.csv", "trace_cpu_ms") / 1000
        written_s = sum(self.milliseconds(path, "write_ms") for path in parts) / 1000
        rest_s = self.milliseconds("out/timing.csv", *stages) / 1000
        size = sum(path.stat().st_size for path in (self.folder / "out").glob("traced.*"))
        print(f"one run: {self.whole_cpu_s:.1f} s of CPU, tracing {whole_traced_s:.1f} s; tasks: tracing {traced_s:.1f} s "
              f"({100 * (traced_s / whole_traced_s - 1):+.1f} %), writing {written_s:.1f} s; finish: {rest_s:.1f} s; "
              f"speed-up at most {(whole_traced_s + rest_s) / rest_s:.1f} for any number of machines; traced frames "
              f"{size / 1e6:.1f} MB; the farm took {wall_s:.1f} s by the clock", flush=True)

    @unittest.skipIf(slurm_node.why_not(), "no Slurm: " + slurm_node.why_not())
    def test_slurm(self):
        whole = self.one_run()
        self.run_ok("farm", "farm.toml", "--engine", "slurm", "--chunks", CHUNKS, "--threads", "1", "--memory", "500M",
                    "--retries", "20", "--then", "ls out/f.*.png | wc -l > film.txt")
        with slurm_node.Node(self.folder / "slurm") as node:
            begin = time.monotonic()
            print(node.run("sh", self.folder / "out/farm/submit.sh"), flush=True)
            wanted = max(2, round(CHUNKS / 5)) if not BY_HAND else max(2, round(0.2 * CHUNKS))
            done_to = {"killed": 0, "requeued": 0, "drained": 0}
            deadline = time.monotonic() + (36000 if BY_HAND else 240)
            while node.jobs():
                self.assertLess(time.monotonic(), deadline, str(node.jobs()))
                node.begin_at_once()
                self.harm(node, wanted, done_to)
                time.sleep(0.3 if not BY_HAND else 1)
            self.assertEqual(done_to, {"killed": wanted - wanted // 2, "requeued": wanted // 2, "drained": 1})
            print("harmed:", done_to, flush=True)
            wall_s = time.monotonic() - begin
        log = {path.name: path.read_text(errors="replace")[-500:] for path in (self.folder / "out/farm/logs").iterdir()}
        self.assertTrue(self.status()["is_done"], f"{self.status()}\n{log}")
        self.assertEqual(self.pictures("out"), whole)
        self.assertEqual((self.folder / "film.txt").read_text().split(), [str(FRAMES)])
        self.report(wall_s)

    def harm(self, node, wanted, done_to):
        """Kills a task that runs, puts one back into the queue, and takes the node away for a moment."""
        running = [job for job, state in node.jobs().items() if state[0] == "RUNNING" and "_" in job]
        processes = self.renderers()
        if running and processes and done_to["killed"] < wanted - wanted // 2:
            os.kill(self.random.choice(processes), signal.SIGKILL)
            done_to["killed"] += 1
        elif running and done_to["requeued"] < wanted // 2:
            if not node.run("scontrol", "requeue", self.random.choice(running)):
                done_to["requeued"] += 1
        elif done_to["drained"] == 0 and done_to["killed"]:
            node.run("scontrol", "update", f"NodeName={node.host}", "State=DRAIN", "Reason=test")
            time.sleep(1)
            node.run("scontrol", "update", f"NodeName={node.host}", "State=RESUME")
            done_to["drained"] = 1

    def renderers(self):
        """Processes of this test's tasks that render."""
        found = []
        for entry in Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0") if entry.name.isdigit() else []
                if words[:2] == [os.path.realpath(harness.PROGRAM).encode(), b"render"] and b"trace" in words and \
                        os.readlink(entry / "cwd") == os.path.realpath(self.folder):
                    found.append(int(entry.name))
            except OSError:
                continue
        return found

    @unittest.skipIf(shutil.which("openjd") is None, "no openjd (pip install openjd-cli)")
    def test_openjd(self):
        whole = self.one_run()
        self.run_ok("farm", "farm.toml", "--engine", "openjd", "--chunks", CHUNKS, "--threads", "1", "--then",
                    "ls out/f.*.png | wc -l > film.txt")
        checked = subprocess.run(["openjd", "check", "out/farm/template.json"], cwd=self.folder, capture_output=True, text=True,
                                 check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        begin = time.monotonic()
        # Taken away in the middle, as by a worker that is stopped; then once more from the beginning.
        command = ["openjd", "run", "out/farm/template.json", "--step", "after-1", "--run-dependencies"]
        stopped = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        while stopped.poll() is None and not list((self.folder / "out").glob("traced.*")):
            time.sleep(0.02)
        stopped.send_signal(signal.SIGTERM)
        stopped.communicate()
        run = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout[-3000:] + run.stderr[-1000:])
        self.assertIn("openjd_progress: 100.0", run.stdout)
        self.assertTrue(self.status()["is_done"], str(self.status()))
        self.assertEqual(self.pictures("out"), whole)
        self.assertEqual((self.folder / "film.txt").read_text().split(), [str(FRAMES)])
        self.report(time.monotonic() - begin)

    @unittest.skipUnless(BY_HAND, "local is in farm_test.py; here by hand")
    def test_local(self):
        whole = self.one_run()
        begin = time.monotonic()
        farm = subprocess.Popen([harness.PROGRAM, "farm", "farm.toml", "--chunks", str(CHUNKS), "--threads", "1", "--processes",
                                 "2", "--retries", "20"], cwd=self.folder)
        killed = 0
        while farm.poll() is None:
            processes = self.renderers()
            if processes and killed < round(0.2 * CHUNKS):
                time.sleep(self.random.uniform(0.5, 3))
                try:
                    os.kill(self.random.choice(processes), signal.SIGKILL)
                    killed += 1
                except ProcessLookupError:
                    continue
            time.sleep(0.2)
        print("killed:", killed, flush=True)
        self.assertEqual(farm.returncode, 0)
        self.assertEqual(self.pictures("out"), whole)
        self.report(time.monotonic() - begin)


if __name__ == "__main__":
    sys.stdout.reconfigure(line_buffering=True)
    harness.main()
