# SPDX-License-Identifier: Apache-2.0
"""Sweeps whose rows are measured by many tasks: what comes out is what one process measures, but for the times."""

import csv
import json
import signal
import subprocess
import time

import harness
from sweep_test import PLAN

# The rates of equal time follow from times, and what is measured at them differs from run to run.
CHUNKS_PLAN = PLAN.replace("[measure]", '[measure]\nbaselines = ["uniform-reference-rate", "equal-samples", "low-resolution"]')
TIMES = ("time_s", "time_low_s", "time_high_s", "speed_up", "speed_up_low", "speed_up_high", "end_to_end", "efficiency", "peak_mib")


class Chunks(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("gaze.csv", harness.moving_gaze())
        self.write("plan.toml", CHUNKS_PLAN)

    def chunk(self, number, of, folder, *more):
        return ["sweep", "plan.toml", "-o", folder, "--chunk", f"{number}/{of}", "--quiet", *more]

    def results(self, folder):
        return json.loads((self.folder / folder / "results.json").read_text())

    def table(self, folder):
        """results.csv without times, and the tasks in which these were taken."""
        with open(self.folder / folder / "results.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        tasks = {row["id"]: row.pop("task") for row in rows}
        return [{key: value for key, value in row.items() if key not in TIMES} for row in rows], tasks

    def merge_refused(self, *folders):
        """What a merge says that cannot be made; what it has taken in stays."""
        refused = self.run_program("sweep", "merge", "plan.toml", "-o", "out", *folders)
        self.assertEqual(refused.returncode, 2, refused.stdout)
        self.assertEqual(refused.stderr.count("\n"), 1, refused.stderr)
        return refused.stderr

    def check_as_one_process(self, folder, of):
        self.run_ok("sweep", "plan.toml", "-o", "whole", "--quiet")
        whole, tasks = self.table("whole")
        self.assertEqual(set(tasks.values()), {""})
        joined, tasks = self.table(folder)
        self.assertEqual(joined, whole)
        self.assertEqual(set(tasks.values()), {f"{k}/{of}" for k in range(1, of + 1)})
        one, many = self.results("whole"), self.results(folder)
        for results in (one, many):
            for row in results["rows"]:
                self.assertEqual(len(row["time_s"]["values"]), 2)
                for frame in row["frames"]:
                    self.assertTrue((self.folder / (folder if results is many else "whole") / frame["png"]).is_file())
        self.assertEqual([scene["reference"]["floor_by_gaze"] for scene in one["scenes"]],
                         [scene["reference"]["floor_by_gaze"] for scene in many["scenes"]])
        self.assertTrue(any("times were taken in" in note for note in many["notes"]), many["notes"])

    def test_folders_of_their_own(self):
        for number in (2, 1, 3):
            self.run_ok(*self.chunk(number, 3, f"part{number}"))
        self.assertIn("box-", self.merge_refused("part1", "part3"))
        self.write("part4/notes.txt", "nothing of a sweep")
        self.assertIn("part4: holds no chunk of a sweep", self.merge_refused("part4"))
        told = self.run_ok("sweep", "merge", "plan.toml", "-o", "out", "part1", "part2", "part3").stdout
        self.assertIn(", task 2/3", told)
        self.check_as_one_process("out", 3)

    def test_one_folder_and_tasks_that_are_killed(self):
        self.assert_refused(["sweep", "merge", "plan.toml", "-o", "out"], ["holds no chunk of a sweep"])
        tasks = [subprocess.Popen([harness.PROGRAM, *self.chunk(number, 2, "out")], cwd=self.folder) for number in (1, 2)]
        # Both work at the reference; one is gone before it has measured anything.
        while not list((self.folder / "out").glob("references/*/scrambling-*/*.exr")) and tasks[0].poll() is None:
            time.sleep(0.01)
        tasks[0].send_signal(signal.SIGKILL)
        self.assertEqual([task.wait() for task in tasks], [-signal.SIGKILL, 0])
        self.assertIn("box-", self.merge_refused())
        first = self.run_ok(*self.chunk(1, 2, "out", "--dry-run")).stdout
        # Borders that are written down stay, and a task that is done has nothing left to do.
        [borders] = (self.folder / "out").glob("chunks.2.*.json")
        before = borders.read_text()
        for number in (1, 2):
            self.run_ok(*self.chunk(number, 2, "out"))
        self.assertEqual(borders.read_text(), before)
        self.assertIn("box-moving-1", first)
        self.run_ok("sweep", "merge", "plan.toml", "-o", "out")
        self.check_as_one_process("out", 2)
        self.assert_refused(["sweep", "plan.toml", "-o", "out"], ["holds measurements of another machine"])
        self.assert_refused(self.chunk(1, 2, "out", "--restart"), ["would delete the measurements of other chunks"])

    def test_a_chunk_without_rows(self):
        told = self.run_program(*self.chunk(40, 40, "out"))
        divided = self.run_ok(*self.chunk(1, 40, "out", "--dry-run")).stdout.splitlines()
        empty = sum(len(line.split()) == 2 for line in divided[1:])
        self.assertGreater(empty, 0)
        self.assertEqual(told.returncode, 0, told.stderr)

    def test_plans_that_are_not_trusted(self):
        """Paths begin in the plan's folder; those that lead out of it are refused, whether there is such a file or not."""
        secret = self.write("secret/box.gltf", json.dumps(harness.box_gltf()))
        self.write("plans/gaze.csv", harness.moving_gaze())
        self.write("plans/box.gltf", json.dumps(harness.box_gltf()))
        command = ["sweep", "plans/plan.toml", "-o", "out", "--dry-run", "--confine"]
        self.write("plans/plan.toml", PLAN)
        self.run_ok(*command)
        for path in ("../secret/box.gltf", str(secret)):
            with self.subTest(path=path):
                self.write("plans/plan.toml", PLAN.replace('"box.gltf"', f'"{path}"'))
                self.assert_refused(command, ["plan.toml:", "scene", "leads outside"])
                self.run_ok(*command[:-1])
        for line, named in (('env = "../secret/sky.hdr"', "env: '"), ('allow-outside = true', "allow-outside")):
            with self.subTest(line=line):
                self.write("plans/plan.toml", PLAN.replace("[common]\n", f"[common]\n{line}\n"))
                self.assert_refused(command, [named])


if __name__ == "__main__":
    harness.main()
