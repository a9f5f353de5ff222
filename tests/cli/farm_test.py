# SPDX-License-Identifier: Apache-2.0
"""Farms: borders of chunks, and the tasks of every engine."""

import json
import os
import shutil
import signal
import subprocess
import time

import harness
from farm_faults_test import Farm
from farm_harm import renderers
from gliding_job import job_toml, processes_in

FRAMES = ["--frames", "1-6"]


class Borders(Farm):
    def chunk(self, number, *more):
        return self.render("out", *FRAMES, "--chunk", f"{number}/3", *more)

    def test_a_chunk_that_never_began_is_missing(self):
        self.chunk(1)
        self.chunk(2)
        self.assert_refused(["merge", "out"], ["frames are missing", "6"])
        self.assertIn("2 parts joined", self.run_ok("merge", "out", "--allow-missing").stdout)

    def test_a_damaged_file_of_borders_is_made_again(self):
        self.chunk(1)
        [borders] = (self.folder / "out").glob("chunks.3.*.json")
        before = borders.read_text()
        borders.write_text(before[:40])
        self.chunk(2)
        self.assertEqual(borders.read_text(), before)

    def test_other_settings_have_borders_of_their_own(self):
        self.chunk(1)
        self.run_ok("render", "--config", "job.toml", "-o", "out/g.####.exr", *FRAMES, "--chunk", "2/3", "--seed", "7")
        self.assertEqual(len(list((self.folder / "out").glob("chunks.3.*.json"))), 2)


FARM_TOML = job_toml(frames=6, folder="out")
SWEEP_TOML = """
[common]
size = "48x27"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
fps = 12
frames = "1-2"
[[scene]]
name = "box"
path = "glide.gltf"
[[gaze]]
name = "left"
at = [0.2, 0.5]
[grid]
region-samples = [[8, 4, 2], [4, 2, 1]]
[reference]
spp = 4
[measure]
repeats = 1
reference-rate = 8
metrics = ["mse"]
controls = false
"""


class FarmFiles(Farm):
    def setUp(self):
        super().setUp()
        self.write("farm.toml", FARM_TOML)

    def farm(self, *arguments, job="farm.toml", program=None):
        return (program or self.run_ok)("farm", job, *arguments)

    def status(self):
        told = self.run_program("farm", "status", "out", "--json")
        status = json.loads(told.stdout)
        states = {task["state"] for task in status["tasks"]}
        self.assertEqual(told.returncode, 3 if "failed" in states else 4 if "interrupted" in states else 0, told.stdout)
        return status

    def whole(self, job):
        self.run_ok("render", "--config", job, "-o", "whole/f.####.exr", "-o", "whole/f.####.png", "--quiet")
        return self.pictures("whole")


class Engines(FarmFiles):
    def test_local(self):
        told = self.farm("--chunks", "3", "--processes", "2", "--threads", "1", "--then", "echo made > film.txt")
        self.assertIn("6 of 6 frames are rendered", told.stdout)
        self.assertEqual((self.folder / "film.txt").read_text(), "made\n")
        self.assertEqual(self.pictures("out"), self.whole("farm.toml"))
        status = self.status()
        self.assertTrue(status["is_done"])
        self.assertEqual([task["state"] for task in status["tasks"]], ["done"] * 5)
        self.assertIn("nothing to do", self.run_ok("farm", "retry", "out").stderr)

    def test_a_name_with_a_percent_sign(self):
        self.write("percent.toml", FARM_TOML.replace("out/f.####", "out/90%%.####"))
        self.assertIn("6 of 6 frames are rendered", self.farm("--chunks", "2", job="percent.toml").stdout)
        self.assertIn("90%.run.json", self.files("out"))

    def test_local_where_the_caller_ignores_what_becomes_of_its_children(self):
        done = subprocess.run([harness.PROGRAM, "farm", "farm.toml", "--chunks", "2", "--processes", "2", "--threads", "1"],
                              cwd=self.folder, capture_output=True, text=True, check=False,
                              preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("tried again", done.stderr)
        self.assertTrue(self.status()["is_done"])

    def test_what_follows_is_done_again(self):
        """After frames that are made anew, and where its commands are others."""
        local = ("--chunks", "3", "--processes", "2", "--threads", "1")
        self.farm(*local, "--then", "echo made >> film.txt")
        (self.folder / "film.txt").unlink()
        (self.folder / "out/f.0003.exr").unlink()
        self.run_ok("farm", "retry", "out")
        self.assertEqual((self.folder / "film.txt").read_text(), "made\n")
        self.farm(*local, "--then", "echo other > other.txt")
        self.assertEqual((self.folder / "other.txt").read_text(), "other\n")
        self.assertTrue(self.status()["is_done"])

    def test_a_job_with_a_name_of_words(self):
        self.write("my job.toml", FARM_TOML)
        self.farm("--engine", "slurm", "--chunks", "2", job="my job.toml")
        self.assertIn("#SBATCH --job-name=my_job\n", (self.folder / "out/farm/task.sbatch").read_text())
        for task in ("1-2", "finish"):
            done = subprocess.run(["sh", str(self.folder / "out/farm/task.sh"), task], capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.pictures("out"), self.whole("farm.toml"))
        self.write("wrong.toml", FARM_TOML + "only-pixel = [3000, 3]\n")
        refused = self.farm("--chunks", "2", job="wrong.toml", program=self.run_program)
        self.assertEqual(refused.returncode, 2)

    def test_what_failed_is_named_and_tried_again(self):
        (self.folder / "out").mkdir()
        broken = self.folder / "out/f.0003.exr"
        broken.mkdir()  # a folder in the place of a picture: no file can be made there
        failed = self.farm("--chunks", "3", "--retries", "1", program=self.run_program)
        self.assertNotEqual(failed.returncode, 0, failed.stderr)
        status = self.status()
        self.assertFalse(status["is_done"])
        states = {task["task"]: task["state"] for task in status["tasks"]}
        self.assertEqual(states["1"], "done")
        self.assertIn("failed", states.values())
        self.assertEqual(states["finish"], "missing")
        broken.rmdir()
        self.run_ok("farm", "retry", "out")
        self.assertTrue(self.status()["is_done"])
        self.assertEqual(self.pictures("out"), self.whole("farm.toml"))

    def test_a_task_that_runs_is_seen(self):
        self.farm("--engine", "slurm", "--chunks", "2")
        self.assertEqual([task["state"] for task in self.status()["tasks"]], ["missing"] * 3)
        # It would take minutes, and a frame in hand is given up soon.
        self.write("slow.toml", FARM_TOML.replace("[4, 2, 1]", "[8192, 8192, 8192]").replace("48x27", "256x144") + 'grace = "1s"\n')
        self.farm("--engine", "slurm", "--chunks", "2", job="slow.toml")
        task = subprocess.Popen(["sh", str(self.folder / "out/farm/task.sh"), "1"], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        seen = set()
        begin = time.monotonic()
        while time.monotonic() - begin < 100 and "running" not in seen:
            seen.add(self.status()["tasks"][0]["state"])
        task.send_signal(signal.SIGTERM)
        self.assertEqual(task.wait(timeout=100), 4)
        self.assertEqual(seen - {"missing"}, {"running"})
        self.assertEqual(self.status()["tasks"][0]["state"], "interrupted")

    def what_follows_begun(self, chunks):
        """Runs the chunks and `finish`, and gives the process of what follows them, once it has made the file `began`."""
        script = str(self.folder / "out/farm/task.sh")
        for task in (chunks, "finish"):
            subprocess.run(["sh", script, task], capture_output=True, check=True)
        after = subprocess.Popen(["sh", script, "after-1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(after.kill)
        begin = time.monotonic()
        while not (self.folder / "began").exists() and time.monotonic() - begin < 100:
            time.sleep(0.02)
        return after

    def test_what_follows_is_seen_while_it_runs(self):
        self.farm("--engine", "slurm", "--chunks", "2", "--then", "touch began; timeout 100 sh -c 'until [ -e go ]; do sleep 0.05; done'")
        after = self.what_follows_begun("1-2")
        self.assertEqual([task["state"] for task in self.status()["tasks"]], ["done", "done", "done", "running"])
        (self.folder / "go").touch()
        self.assertEqual(after.wait(timeout=100), 0)
        self.assertTrue(self.status()["is_done"])

    def test_what_follows_ends_as_a_whole(self):
        """A signal reaches what the shell of `--then` has begun, and the shell begins nothing else."""
        waits = "sh -c 'trap \"touch told; exit 0\" TERM; touch began; while :; do sleep 0.05; done'"
        self.farm("--engine", "slurm", "--chunks", "1", "--then", f"{waits}; touch went-on")
        after = self.what_follows_begun("1")
        begin = time.monotonic()
        after.send_signal(signal.SIGTERM)
        self.assertEqual(after.wait(timeout=100), 128 + signal.SIGTERM)
        while processes_in(self.folder) and time.monotonic() - begin < 100:
            time.sleep(0.02)
        self.assertEqual(processes_in(self.folder), {})
        self.assertTrue((self.folder / "told").exists())
        self.assertFalse((self.folder / "went-on").exists())

    def test_files_for_slurm(self):
        self.farm("--engine", "slurm", "--chunks", "3", "--threads", "2", "--time", "2h", "--then",
                  "echo 'it is done'")
        batch = (self.folder / "out/farm/task.sbatch").read_text()
        for words in ("#SBATCH --cpus-per-task=2", "#SBATCH --mem=", "#SBATCH --time=", "--requeue", "--signal=B:USR1@90"):
            self.assertIn(words, batch)
        submit = (self.folder / "out/farm/submit.sh").read_text()
        for words in ("chunks='1 2 3'", "--dependency=afterok$after", "submit finish\nsubmit after-1"):
            self.assertIn(words, submit)
        # The script that every engine runs does the tasks.
        for task in ("3", "1-2", "finish", "after-1"):
            done = subprocess.run(["sh", str(self.folder / "out/farm/task.sh"), task], capture_output=True, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(self.status()["is_done"])
        (self.folder / "out/f.0001.exr").unlink()
        states = {task["task"]: task["state"] for task in self.status()["tasks"]}
        self.assertEqual((states["2"], states["finish"], states["after-1"]), ("done", "missing", "missing"))
        self.run_ok("farm", "retry", "out")
        self.assertIn("chunks='1'", (self.folder / "out/farm/submit.sh").read_text())

    def test_files_for_openjd(self):
        self.farm("--engine", "openjd", "--chunks", "3")
        job = json.loads((self.folder / "out/farm/template.json").read_text())
        self.assertEqual((job["specificationVersion"], job["extensions"]), ("jobtemplate-2023-09", ["TASK_CHUNKING"]))
        chunks, finish = job["steps"]
        self.assertEqual(chunks["parameterSpace"]["taskParameterDefinitions"][0]["type"], "CHUNK[INT]")
        self.assertEqual(chunks["script"]["actions"]["onRun"]["cancelation"]["mode"], "NOTIFY_THEN_TERMINATE")
        self.assertEqual(finish["dependencies"], [{"dependsOn": "Chunks"}])
        told = self.run_ok("render", "--config", "farm.toml", "--progress", "openjd", "-o", "o/f.####.exr").stdout.splitlines()
        self.assertIn("openjd_progress: 100.0", told)
        self.assertTrue(any(line.startswith("openjd_status: frame 6 done, 6 of 6") for line in told))
        wrong = self.run_program("render", "--config", "farm.toml", "--progress", "openjd", "--gaze", "none.csv", "-o", "p/f.####.exr")
        self.assertTrue(wrong.stdout.startswith("openjd_fail: none.csv"), wrong.stdout)

    def test_rows_of_a_sweep(self):
        self.write("plan.toml", SWEEP_TOML)
        told = self.run_ok("farm", "plan.toml", "-o", "out", "--chunks", "2", "--processes", "2", "--threads", "1", "--then",
                           "gazetrace_report=made; echo $gazetrace_report > report.txt")
        self.assertIn("box-left-1", told.stderr)
        self.assertTrue(self.status()["is_done"])
        results = json.loads((self.folder / "out/results.json").read_text())
        self.assertEqual({row["task"] for row in results["rows"]}, {"1/2", "2/2"})
        self.assertEqual((self.folder / "report.txt").read_text(), "made\n")
        self.run_ok("farm", "plan.toml", "-o", "out", "--chunks", "2", "--engine", "slurm")
        self.assertIn("sweep merge ", (self.folder / "out/farm/task.sh").read_text())

    def test_a_chunk_is_tried_again_when_the_others_have_ended(self):
        self.write("slow.toml", FARM_TOML.replace("[4, 2, 1]", "[1024, 512, 256]"))
        (self.folder / "out").mkdir()
        first = subprocess.Popen([harness.PROGRAM, "farm", "slow.toml", "--chunks", "2", "--processes", "2", "--threads", "1",
                                  "--retries", "0"], cwd=self.folder, stderr=subprocess.PIPE, text=True)
        self.addCleanup(first.kill)
        lock = self.folder / "out/.gazetrace.lock"
        while not (lock.exists() and all(f"--chunk {k}/2" in lock.read_text() for k in (1, 2))) and first.poll() is None:
            time.sleep(0.002)
        chunks = renderers(self.folder, harness.PROGRAM)
        held = chunks[2]
        os.kill(held, signal.SIGSTOP)
        os.kill(chunks[1], signal.SIGKILL)  # the first chunk fails, and the second one is held up
        self.addCleanup(lambda: os.path.exists(f"/proc/{held}") and os.kill(held, signal.SIGKILL))
        while self.states().get("1") != "failed" and first.poll() is None:
            time.sleep(0.02)
        self.assertEqual(self.states()["2"], "running")
        # One farm at a time runs tasks here.
        for words in (["retry", "out"], ["slow.toml", "--chunks", "2"]):
            refused = self.run_program("farm", *words)
            self.assertNotEqual(refused.returncode, 0)
            self.assertRegex(refused.stderr, "task 2 is running|another 'gazetrace farm' runs these tasks")
        os.kill(held, signal.SIGCONT)
        self.assertNotEqual(first.wait(), 0)
        first.stderr.close()
        told = self.run_ok("farm", "retry", "out").stderr
        self.assertIn("task 1: begins", told)
        self.assertNotIn("task 2: begins", told)
        self.assertTrue(self.status()["is_done"])
        self.assertEqual(self.pictures("out"), self.whole("slow.toml"))

    def states(self):
        told = self.run_program("farm", "status", "out", "--json")
        return {task["task"]: task["state"] for task in json.loads(told.stdout)["tasks"]} if told.stdout else {}


if __name__ == "__main__":
    harness.main()
