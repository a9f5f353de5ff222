# SPDX-License-Identifier: Apache-2.0
"""Plans of farms: what they say, where they lie, and what is refused before a task begins."""

import json
import os
import shutil
import subprocess

import harness
from farm_test import FARM_TOML, FarmFiles


class Plans(FarmFiles):
    def test_a_damaged_plan_of_a_farm(self):
        self.farm("--engine", "slurm", "--chunks", "2")
        path = self.folder / "out/farm/farm.json"
        plan = json.loads(path.read_text())
        for text, words in ((path.read_text()[:60], "is damaged: it is no JSON object"), ("[1, 2]", "it is no JSON object"),
                            (json.dumps({**plan, "threads": "many"}), "'threads' has a value of another kind"),
                            (json.dumps({**plan, "chunks": ["1-3", "x"]}), "'x' is no list of frames"),
                            (json.dumps({**plan, "samples": []}), "does not tell the same of every chunk"),
                            (json.dumps({key: value for key, value in plan.items() if key != "then"}), "does not tell 'then'"),
                            (json.dumps({**plan, "kind": "stars"}), "chunks are of frames or sweep"),
                            (json.dumps({**plan, "chunks": [], "samples": []}), "does not tell the same of every chunk"),
                            (json.dumps({**plan, "time_s": 2**63 - 1}), "limits that no farm can have"),
                            (json.dumps({**plan, "engine": "condor"}), "condor")):
            path.write_text(text)
            for command in ("status", "retry"):
                told = self.run_program("farm", command, "out")
                self.assertEqual((told.returncode, told.stderr.count("\n")), (2, 1), told.stderr)
                self.assertIn(words, told.stderr)
                self.assertNotIn("json.exception", told.stderr)

    def test_what_is_no_farm(self):
        for arguments, words in ((["--engine", "condor", "--chunks", "2"], "condor"), ([], "give --chunks"),
                                 (["--engine", "flamenco", "--chunks", "2"], "flamenco")):
            refused = self.farm(*arguments, program=self.run_program)
            self.assertEqual(refused.returncode, 2)
            self.assertIn(words, refused.stderr)
        self.assert_refused(["farm", "status", "nowhere"], ["there is no farm in it"])

    def test_a_job_that_has_changed_is_not_done(self):
        local = ("--chunks", "3", "--processes", "2", "--threads", "1", "--retries", "1")
        self.farm(*local)
        before = self.pictures("out")
        self.write("farm.toml", FARM_TOML + "seed = 9\n")
        self.assertEqual(self.farm(*local, program=self.run_program).returncode, 2)
        self.assertEqual([task["state"] for task in self.status()["tasks"]], ["failed"] * 3 + ["missing"])
        self.assertNotEqual(self.run_program("farm", "retry", "out").returncode, 0)
        self.assertFalse(self.status()["is_done"])
        self.assertEqual(self.pictures("out"), before)  # nothing was rendered over
        self.write("farm.toml", FARM_TOML)
        self.farm(*local)
        self.assertTrue(self.status()["is_done"])

    def test_another_division_is_refused_before_it_renders(self):
        self.farm("--chunks", "3", "--processes", "2", "--threads", "1")
        before = self.files("out")
        refused = self.farm("--chunks", "2", "--processes", "2", program=self.run_program)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("holds parts of another division, in 3 chunks, such as f.run.1-2.json", refused.stderr)
        self.assertEqual(self.files("out"), before)

    def test_a_folder_that_was_moved(self):
        self.farm("--chunks", "2", "--processes", "2", "--threads", "1")
        shutil.move(self.folder / "out", self.folder / "moved")
        status = json.loads(self.run_ok("farm", "status", "moved", "--json").stdout)
        self.assertTrue(status["is_done"])
        refused = self.run_program("farm", "retry", "moved")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("was made for another folder", refused.stderr)
        self.assertFalse((self.folder / "out").exists())
        # By another name of the same folder it is where it was.
        shutil.move(self.folder / "moved", self.folder / "out")
        (self.folder / "link").symlink_to("out")
        self.assertIn("nothing to do", self.run_ok("farm", "retry", "link").stderr)

    def test_what_follows_has_a_limit_of_its_own(self):
        time = ("--chunks", "3", "--time", "100min", "--then", "true")
        self.farm("--engine", "slurm", *time, "--retries", "0")
        script = (self.folder / "out/farm/task.sh").read_text()
        self.assertIn("--max-time 5940s", script)
        self.assertIn("#SBATCH --time=100\n", (self.folder / "out/farm/task.sbatch").read_text())
        self.assertIn("time_after=--time=100\n", (self.folder / "out/farm/submit.sh").read_text())
        self.farm("--engine", "openjd", *time)
        steps = json.loads((self.folder / "out/farm/template.json").read_text())["steps"]
        self.assertEqual([step["script"]["actions"]["onRun"]["timeout"] for step in steps], [6000, 6000, 6000])

    def test_a_queue_that_does_not_answer_gets_nothing(self):
        self.farm("--engine", "slurm", "--chunks", "2")
        tools = self.folder / "tools"
        tools.mkdir()
        for name, text in (("squeue", "exit 1"), ("sbatch", "touch handed-over; echo 1")):
            (tools / name).write_text(f"#!/bin/sh\n{text}\n")
            (tools / name).chmod(0o755)
        submitted = subprocess.run(["sh", "out/farm/submit.sh"], cwd=self.folder, capture_output=True, text=True, check=False,
                                   env={**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"})
        self.assertEqual(submitted.returncode, 3, submitted.stderr)
        self.assertEqual([path for path in self.files() if "handed-over" in path], [])

    def test_a_job_by_others_is_confined(self):
        (self.folder / "job").mkdir()
        self.write("job/farm.toml", FARM_TOML.replace("glide.gltf", "../glide.gltf").replace("log.csv", "../log.csv"))
        refused = self.farm("--confine", "--chunks", "2", job="job/farm.toml", program=self.run_program)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("glide.gltf", refused.stderr)
        for name in ("glide.gltf", "log.csv"):
            shutil.copy(self.folder / name, self.folder / "job")
        self.write("job/farm.toml", FARM_TOML.replace('"out/', '"job/out/'))
        self.farm("--confine", "--engine", "slurm", "--chunks", "2", job="job/farm.toml")
        script = next(self.folder.rglob("task.sh")).read_text()
        self.assertEqual(script.count(" --confine"), 1)

    def test_names_that_cannot_be_kept(self):
        odd = os.fsencode(self.folder) + b"/odd\xff"
        os.mkdir(odd)
        for name in ("farm.toml", "glide.gltf", "log.csv"):
            shutil.copy(os.path.join(os.fsencode(self.folder), name.encode()), odd)
        refused = subprocess.run([harness.PROGRAM, "farm", "farm.toml", "--chunks", "2"], cwd=odd, capture_output=True, check=False)
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn(b"is not UTF-8", refused.stderr)
        self.write("braces.toml", FARM_TOML.replace('"out/', '"o{{x}}/'))
        braces = self.farm("--engine", "openjd", "--chunks", "2", job="braces.toml", program=self.run_program)
        self.assertEqual(braces.returncode, 2)
        self.assertIn("begins an expression", braces.stderr)


if __name__ == "__main__":
    harness.main()
