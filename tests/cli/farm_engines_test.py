# SPDX-License-Identifier: Apache-2.0
"""Farms on real engines: one node of Slurm, and the reference implementation of Open Job Description. Frames depend on
those before them, tasks are killed, put back into the queue and canceled, the node is drained and brought back; what comes
out are the bits of one run. By hand for more, with the processor time of every attempt: GAZETRACE_FARM_FRAMES=200
GAZETRACE_FARM_CHUNKS=8 GAZETRACE_FARM_SEED=1 GAZETRACE_FARM_SIZE=192x108 GAZETRACE_FARM_SAMPLES="256, 128, 64"."""

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import unittest

import harness
import slurm_node
from farm_harm import CpuTimes, Harm

FRAMES = int(os.environ.get("GAZETRACE_FARM_FRAMES", "12"))
CHUNKS = int(os.environ.get("GAZETRACE_FARM_CHUNKS", "4"))
SEED = int(os.environ.get("GAZETRACE_FARM_SEED", "1"))
SIZE = os.environ.get("GAZETRACE_FARM_SIZE", "96x54")
SAMPLES = os.environ.get("GAZETRACE_FARM_SAMPLES", "2048, 1024, 512")
BY_HAND = "GAZETRACE_FARM_FRAMES" in os.environ
WANTED = max(2, round(0.25 * CHUNKS))  # so many chunks are killed or put back

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
        self.harm = Harm(self.folder, harness.PROGRAM, self.random, CHUNKS)
        self.times = CpuTimes(self.folder / "attempts.jsonl")
        print(f"seed {SEED}: {FRAMES} frames of {SIZE} in {CHUNKS} chunks", flush=True)

    def farm(self, engine, *more):
        measured = ["--container", self.times.words] if BY_HAND else []
        return ["farm", "farm.toml", "--engine", engine, "--chunks", str(CHUNKS), "--threads", "1", "--retries", "20", "--then",
                "ls out/f.*.png | wc -l > film.txt", *measured, *more]

    def one_run(self):
        whole = CpuTimes(self.folder / "whole.jsonl")
        subprocess.run([*whole.words.split(), harness.PROGRAM, "render", "--config", "farm.toml", "-o", "whole/f.####.exr", "-o",
                        "whole/f.####.png", "--quiet", "--threads", "1"], cwd=self.folder, check=True)
        self.whole_cpu_s = whole.attempts()[0]["cpu_s"]
        return self.pictures("whole")

    def status(self):
        return json.loads(self.run_ok("farm", "status", "out", "--json").stdout)

    def check(self, whole, told):
        """The farm is done, and its pictures are those of one run."""
        logs = {path.name: path.read_text(errors="replace")[-500:] for path in (self.folder / "out/farm/logs").iterdir()}
        self.assertTrue(self.status()["is_done"], f"{self.status()}\n{logs}\n{told}")
        self.assertEqual(self.pictures("out"), whole)
        self.assertEqual((self.folder / "film.txt").read_text().split(), [str(FRAMES)])
        print("harmed:", self.harm, flush=True)

    def report(self, wall_s):
        """What the attempts took beside one run, and what the serial rest leaves of the speed-up."""
        if not BY_HAND:
            return
        traced, lost = (self.times.seconds("trace", is_whole) for is_whole in (True, False))
        finish = sum(self.times.seconds("finish", True))
        size = sum(path.stat().st_size for path in (self.folder / "out").glob("traced.*"))
        both = sum(traced) + finish
        print(f"CPU: one run {self.whole_cpu_s:.1f} s; {len(traced)} attempts that traced to the end {sum(traced):.1f} s (longest "
              f"{max(traced):.1f} s), finish {finish:.1f} s, together {100 * (both / self.whole_cpu_s - 1):+.1f} %; apart from "
              f"that {len(lost)} attempts that were ended {sum(lost):.1f} s. Speed-up of {CHUNKS} machines "
              f"{self.whole_cpu_s / (max(traced) + finish):.1f}, by the model "
              f"{self.whole_cpu_s / ((self.whole_cpu_s - finish) / CHUNKS + finish):.1f}, of any number at most "
              f"{self.whole_cpu_s / finish:.1f}. Traced frames {size / 1e6:.1f} MB. {wall_s:.1f} s by the clock.", flush=True)

    @unittest.skipIf(slurm_node.why_not(), "no Slurm: " + slurm_node.why_not())
    def test_slurm(self):
        whole = self.one_run()
        self.run_ok(*self.farm("slurm", "--memory", "500M"))
        with slurm_node.Node(self.folder / "slurm") as node:
            begin = time.monotonic()
            told = node.run("sh", self.folder / "out/farm/submit.sh")
            array = told.split()[1]
            drained = False
            for _ in self.while_there_are_jobs(node):
                self.harm_slurm(node, array)
                if not drained and self.harm.count("killed"):
                    node.run("scontrol", "update", f"NodeName={node.host}", "State=DRAIN", "Reason=test")
                    time.sleep(1)
                    node.run("scontrol", "update", f"NodeName={node.host}", "State=RESUME")
                    drained = True
            self.assertEqual((self.harm.count("killed"), self.harm.count("requeued"), self.harm.count("canceled")),
                             (WANTED - WANTED // 2, WANTED // 2, 1), str(self.harm))
            # A task that is harmed goes on by itself and leaves the others alone.
            self.assertEqual({chunk: count > 0 for chunk, count in node.restarts(array).items()},
                             {chunk: self.harm.done.get(chunk) in ("killed", "requeued") for chunk in range(1, CHUNKS + 1)})
            # A task that somebody cancels takes what depends on it along.
            states = {task["task"]: task["state"] for task in self.status()["tasks"]}
            self.assertEqual((states["finish"], states["after-1"]), ("missing", "missing"), str(states))
            retried = subprocess.run([harness.PROGRAM, "farm", "retry", "out", "--submit"], cwd=self.folder, env=node.environment,
                                     capture_output=True, text=True, check=False)
            self.assertEqual(retried.returncode, 0, retried.stdout + retried.stderr)
            for _ in self.while_there_are_jobs(node):
                pass
            wall_s = time.monotonic() - begin
            told = (node.folder / "slurmctld.log").read_text(errors="replace")[-6000:]
        self.check(whole, told)
        self.report(wall_s)

    def while_there_are_jobs(self, node):
        deadline = time.monotonic() + (36000 if BY_HAND else 240)
        while node.jobs():
            self.assertLess(time.monotonic(), deadline, str(node.jobs()))
            node.begin_soon()
            yield
            time.sleep(0.1 if not BY_HAND else 0.5)

    def harm_slurm(self, node, array):
        """Kills a task, puts one back into the queue and cancels one. The last task of the array is among the killed: its
        number is the array's own."""
        if self.harm.count("killed") < WANTED - WANTED // 2:
            self.harm.kill(only=CHUNKS if not self.harm.count("killed") else None)
        running = [int(job.split("_")[1]) for job, state in node.jobs().items() if state[0] == "RUNNING" and "_" in job]
        for chunk in running:
            if chunk in self.harm.done or chunk == CHUNKS or chunk not in self.harm.renderers():
                continue
            if self.harm.count("requeued") < WANTED // 2:
                if not node.run("scontrol", "requeue", f"{array}_{chunk}"):
                    self.harm.done[chunk] = "requeued"
            elif not self.harm.count("canceled"):
                if not node.run("scancel", f"{array}_{chunk}"):
                    self.harm.done[chunk] = "canceled"

    @unittest.skipIf(shutil.which("openjd") is None, "no openjd (pip install openjd-cli)")
    def test_openjd(self):
        whole = self.one_run()
        self.run_ok(*self.farm("openjd"))
        checked = subprocess.run(["openjd", "check", "out/farm/template.json"], cwd=self.folder, capture_output=True, text=True,
                                 check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        begin = time.monotonic()
        command = ["openjd", "run", "out/farm/template.json", "--step", "after-1", "--run-dependencies"]
        # Taken away in the middle, as by a worker that is stopped; then once more from the beginning. The first task that
        # fails ends a run of the reference implementation, too.
        self.run_openjd(command, lambda run: run.send_signal(signal.SIGTERM))
        while self.harm.count() < WANTED:
            before = self.harm.count()
            code, told = self.run_openjd(command, lambda _: self.harm.kill())
            self.assertTrue(code != 0 and self.harm.count() == before + 1, f"{code}: {self.harm}\n{told}")
        code, told = self.run_openjd(command, None)
        self.assertEqual(code, 0, told[-3000:])
        self.assertIn("openjd_progress: 100.0", told)
        self.check(whole, told[-3000:])
        self.report(time.monotonic() - begin)

    def run_openjd(self, command, harm):
        """Runs it to its end, and harms it while a chunk renders."""
        with open(self.folder / "openjd.log", "w+", encoding="utf-8") as log:
            run = subprocess.Popen(command, cwd=self.folder, stdout=log, stderr=subprocess.STDOUT)
            while run.poll() is None and harm is not None:
                if set(self.harm.renderers()) - set(self.harm.done):
                    time.sleep(self.random.uniform(0, 0.3))
                    harm(run)
                    harm = None
                time.sleep(0.02)
            code = run.wait()
            log.seek(0)
            return code, log.read()

    @unittest.skipUnless(BY_HAND, "local is in farm_test.py; here by hand")
    def test_local(self):
        whole = self.one_run()
        begin = time.monotonic()
        farm = subprocess.Popen([harness.PROGRAM, *self.farm("local", "--processes", "2")], cwd=self.folder)
        while farm.poll() is None:
            if self.harm.count() < WANTED and self.harm.renderers():
                time.sleep(self.random.uniform(0.1, 1))
                self.harm.kill()
            time.sleep(0.1)
        self.assertEqual(farm.returncode, 0)
        self.assertEqual(self.harm.count(), WANTED)
        self.check(whole, "")
        self.report(time.monotonic() - begin)


if __name__ == "__main__":
    sys.stdout.reconfigure(line_buffering=True)
    harness.main()
