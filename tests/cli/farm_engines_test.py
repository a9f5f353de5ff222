# SPDX-License-Identifier: Apache-2.0
"""Farms on real engines: one node of Slurm, and the reference implementation of Open Job Description. Tasks are
killed, put back into the queue and canceled while they are held at work, the node is drained
and brought back; what comes out are the bits of one run. By hand for more, with the processor time of every attempt: GAZETRACE_FARM_FRAMES=200
GAZETRACE_FARM_CHUNKS=8 GAZETRACE_FARM_SEED=1 GAZETRACE_FARM_SIZE=192x108 GAZETRACE_FARM_SAMPLES="256, 128, 64"."""

import csv
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
from farm_harm import Attempts, Harm, kill
from farm_test import SWEEP_TOML
from gliding_job import job_toml, write_inputs
from sweep_chunks_test import TIMES

FRAMES = int(os.environ.get("GAZETRACE_FARM_FRAMES", "12"))
CHUNKS = int(os.environ.get("GAZETRACE_FARM_CHUNKS", "4"))
SEED = int(os.environ.get("GAZETRACE_FARM_SEED", "1"))
SIZE = os.environ.get("GAZETRACE_FARM_SIZE", "96x54")
SAMPLES = os.environ.get("GAZETRACE_FARM_SAMPLES", "2048, 1024, 512")
BY_HAND = "GAZETRACE_FARM_FRAMES" in os.environ
RETRIES_AT_ONCE = SEED % 2 == 1  # else once Slurm has canceled what depends on a canceled task
WANTED = max(2, round(0.25 * CHUNKS))  # so many chunks are killed or put back
DEADLINE_S = 36000 if BY_HAND else 500  # nothing is asserted of times; a queue that stands still must end some time


class RealEngines(harness.CliTest):
    def setUp(self):
        super().setUp()
        write_inputs(self.folder, FRAMES / 24 + 1)
        self.write("farm.toml", job_toml(SIZE, SAMPLES, FRAMES, "out"))
        self.random = random.Random(SEED)
        self.attempts = Attempts(self.folder / "attempts.jsonl")
        print(f"seed {SEED}: {FRAMES} frames of {SIZE} in {CHUNKS} chunks", flush=True)

    def fates(self, *kinds):
        """The last task of the array is killed, since its number is the array's own; others at random suffer the rest."""
        others = self.random.sample(range(1, CHUNKS), len(kinds))
        return Harm(self.attempts, {CHUNKS: "killed", **dict(zip(others, kinds))}, self.moment)

    def moment(self):
        """How far an attempt has come when it is harmed: within the start of the program, or some frames on."""
        return self.random.uniform(0, 0.5 if BY_HAND else 0.2)

    def farm(self, engine, *more):
        return ["farm", "farm.toml", "--engine", engine, "--chunks", str(CHUNKS), "--threads", "1", "--retries", "20", "--then",
                self.film(), "--container", self.attempts.words, *more]

    @staticmethod
    def film():
        """What follows the pictures: the video, where there is ffmpeg, and how many pictures it was made of."""
        video = f"'{harness.PROGRAM}' video out/f.####.png -o film.mp4 --overwrite && " if shutil.which("ffmpeg") else ""
        return video + "ls out/f.*.png | wc -l > film.txt"

    def one_run(self):
        whole = Attempts(self.folder / "whole.jsonl")
        subprocess.run([*whole.words.split(), harness.PROGRAM, "render", "--config", "farm.toml", "-o", "whole/f.####.exr", "-o",
                        "whole/f.####.png", "--quiet", "--threads", "1"], cwd=self.folder, check=True)
        self.whole_cpu_s = whole.all()[0]["cpu_s"]
        return self.pictures("whole")

    def status(self):
        return json.loads(self.run_program("farm", "status", "out", "--json").stdout)

    def check(self, whole, told, harm):
        """The farm is done, and its pictures are those of one run."""
        logs = {path.name: path.read_text(errors="replace")[-500:] for path in (self.folder / "out/farm/logs").iterdir()}
        self.assertTrue(self.status()["is_done"], f"{self.status()}\n{logs}\n{told}")
        self.assertEqual(self.pictures("out"), whole)
        self.assertEqual((self.folder / "film.txt").read_text().split(), [str(FRAMES)])
        if shutil.which("ffprobe"):
            frames = subprocess.run(["ffprobe", "-v", "error", "-count_packets", "-show_entries", "stream=nb_read_packets", "-of",
                                     "csv=p=0", "film.mp4"], cwd=self.folder, capture_output=True, text=True, check=True)
            self.assertEqual(frames.stdout.strip().strip(","), str(FRAMES))
        print("harmed:", harm, flush=True)

    def report(self, wall_s):
        """What the attempts took beside one run, and what the serial rest leaves of the speed-up."""
        if not BY_HAND:
            return
        chunks, lost = (self.attempts.seconds("--chunk", is_whole) for is_whole in (True, False))
        merge = sum(self.attempts.seconds("merge", True))
        both = sum(chunks) + merge
        print(f"CPU: one run {self.whole_cpu_s:.1f} s; {len(chunks)} attempts that came to their end {sum(chunks):.1f} s (longest "
              f"{max(chunks):.1f} s), merge {merge:.1f} s, together {100 * (both / self.whole_cpu_s - 1):+.1f} %; apart from "
              f"that {len(lost)} attempts that were ended {sum(lost):.1f} s. Speed-up of {CHUNKS} machines "
              f"{self.whole_cpu_s / (max(chunks) + merge):.1f}. {wall_s:.1f} s by the clock.", flush=True)

    @unittest.skipIf(slurm_node.why_not(), "no Slurm: " + slurm_node.why_not())
    def test_slurm(self):
        whole = self.one_run()
        self.run_ok(*self.farm("slurm", "--memory", "500M"))
        harm = self.fates(*["killed"] * (WANTED - WANTED // 2 - 1), *["requeued"] * (WANTED // 2), "canceled")
        with slurm_node.Node(self.folder / "slurm") as node:
            begin = time.monotonic()
            told = node.run("sh", self.folder / "out/farm/submit.sh")
            self.assertRegex(told, r"^chunks: \d+\n")
            array = told.split()[1]
            # Slurm says nothing where it has done what it was told; else it is told once more.
            ways = {"killed": kill, "requeued": lambda chunk, _: not node.run("scontrol", "requeue", f"{array}_{chunk}"),
                    "canceled": lambda chunk, _: not node.run("scancel", f"{array}_{chunk}")}
            drained = retried = False
            for _ in self.while_there_are_jobs(node):
                harm.harm(ways)
                if not drained and harm.done:
                    node.run("scontrol", "update", f"NodeName={node.host}", "State=DRAIN", "Reason=test")
                    time.sleep(1)
                    node.run("scontrol", "update", f"NodeName={node.host}", "State=RESUME")
                    drained = True
                if RETRIES_AT_ONCE and not retried and harm.is_over("canceled", "killed"):
                    retried = self.retry_what_was_canceled(node, harm)
            self.assertEqual(harm.done, harm.fates)
            # A task that is harmed goes on by itself and leaves the others alone.
            self.assertEqual({chunk: count > 0 for chunk, count in node.restarts(array).items()},
                             {chunk: harm.fates.get(chunk) in ("killed", "requeued") for chunk in range(1, CHUNKS + 1)})
            if not retried:
                # A task that somebody cancels has taken what depends on it along.
                states = {task["task"]: task["state"] for task in self.status()["tasks"]}
                self.assertEqual((states["finish"], states["after-1"]), ("missing", "missing"), str(states))
                self.retry(node)
                for _ in self.while_there_are_jobs(node):
                    pass
            wall_s = time.monotonic() - begin
            told = (node.folder / "slurmctld.log").read_text(errors="replace")[-6000:]
        self.check(whole, told, harm)
        self.report(wall_s)

    def retry(self, node):
        retried = subprocess.run([harness.PROGRAM, "farm", "retry", "out", "--submit"], cwd=self.folder, env=node.environment,
                                 capture_output=True, text=True, check=False)
        self.assertEqual(retried.returncode, 0, retried.stdout + retried.stderr)
        return retried.stdout

    def retry_what_was_canceled(self, node, harm):
        """Hands it over once more while other chunks run, wait or are being ended; true once it could be done."""
        [canceled] = [chunk for chunk, what in harm.done.items() if what == "canceled"]
        if self.status()["tasks"][canceled - 1]["state"] == "running":
            return False
        before = {job.split("_")[1] for job in node.jobs() if "_" in job}
        told = self.retry(node)
        array = told.split()[1]
        handed_over = {job.split("_")[1] for job in node.jobs() if job.startswith(array + "_")}
        self.assertIn(str(canceled), handed_over, told)
        self.assertFalse(handed_over & (before - {str(canceled)}), f"{told}: {before}, then {handed_over}")
        return True

    def while_there_are_jobs(self, node):
        deadline = time.monotonic() + DEADLINE_S
        while node.jobs():
            self.assertLess(time.monotonic(), deadline, str(node.jobs()))
            node.begin_soon()
            yield
            time.sleep(0.1)

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
        # fails would end a run of the reference implementation: one that is killed tries itself again.
        self.run_openjd(command, Harm(self.attempts, {1: "taken away"}, self.moment), {})
        harm = Harm(self.attempts, {chunk: "killed" for chunk in range(1, WANTED + 1)}, self.moment)
        code, told = self.run_openjd(command, harm, {"killed": kill})
        self.assertTrue(code == 0 and harm.is_over(), f"{code}: {harm}\n{told[-3000:]}")
        self.assertIn("openjd_progress: 100.0", told)
        self.check(whole, told[-3000:], harm.done)
        self.report(time.monotonic() - begin)

    def run_openjd(self, command, harm, ways):
        """Runs it to its end, and harms it while a chunk renders."""
        with open(self.folder / "openjd.log", "w+", encoding="utf-8") as log:
            run = subprocess.Popen(command, cwd=self.folder, stdout=log, stderr=subprocess.STDOUT)
            ways = {"taken away": lambda *_: run.send_signal(signal.SIGTERM) is None, **ways}
            while run.poll() is None:
                if harm:
                    harm.harm(ways)
                time.sleep(0.05)
            log.seek(0)
            return run.returncode, log.read()

    @unittest.skipUnless(BY_HAND, "local is in farm_test.py; here by hand")
    def test_local(self):
        whole = self.one_run()
        harm = self.fates(*["killed"] * (WANTED - 1))
        begin = time.monotonic()
        farm = subprocess.Popen([harness.PROGRAM, *self.farm("local", "--processes", "2")], cwd=self.folder)
        while farm.poll() is None:
            harm.harm({"killed": kill})
            time.sleep(0.05)
        self.assertEqual(farm.returncode, 0)
        self.assertEqual(harm.done, harm.fates)
        self.check(whole, "", harm)
        self.report(time.monotonic() - begin)


class SweepAsAnArray(harness.CliTest):
    @unittest.skipIf(slurm_node.why_not(), "no Slurm: " + slurm_node.why_not())
    def test_the_tables_are_those_of_one_process(self):
        write_inputs(self.folder)
        self.write("plan.toml", SWEEP_TOML)
        self.run_ok("sweep", "plan.toml", "-o", "whole", "--quiet")
        self.run_ok("farm", "plan.toml", "-o", "out", "--engine", "slurm", "--chunks", "2", "--threads", "1", "--memory", "500M",
                    "--then", f"'{harness.PROGRAM}' report out -o out/report.html")
        with slurm_node.Node(self.folder / "slurm") as node:
            told = node.run("sh", self.folder / "out/farm/submit.sh")
            deadline = time.monotonic() + DEADLINE_S
            while node.jobs():
                self.assertLess(time.monotonic(), deadline, str(node.jobs()))
                time.sleep(0.2)
        self.assertEqual(self.rows("out"), self.rows("whole"), told)
        self.assertEqual({row["task"] for row in json.loads((self.folder / "out/results.json").read_text())["rows"]}, {"1/2", "2/2"})
        self.assertIn("box", (self.folder / "out/report.html").read_text())

    def rows(self, folder):
        """results.csv but for times, where they were taken, and the baselines of equal time, whose rates follow from times."""
        with open(self.folder / folder / "results.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key not in (*TIMES, "task")} for row in csv.DictReader(file)
                    if "equal time" not in " ".join(row.values())]


if __name__ == "__main__":
    sys.stdout.reconfigure(line_buffering=True)
    harness.main()
