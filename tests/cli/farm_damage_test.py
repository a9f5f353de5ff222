# SPDX-License-Identifier: Apache-2.0
"""What is damaged after a farm or a sweep has finished it is found, and made again; nothing is taken for done by its name."""

import csv
import json
import signal
import subprocess
import time

import harness
from farm_faults_test import Farm
from farm_test import FARM_TOML, SWEEP_TOML
from gliding_job import write_inputs
from sweep_chunks_test import TIMES

SWEEP = SWEEP_TOML.replace("repeats = 1", 'repeats = 1\nbaselines = ["uniform-reference-rate", "equal-samples"]')


def cut(path):
    path.write_bytes(path.read_bytes()[:len(path.read_bytes()) // 2])


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 4
    path.write_bytes(content)


def remove(path):
    path.unlink()


class DamagedFarm(Farm):
    def states(self, *more):
        status = json.loads(self.run_program("farm", "status", "out", "--json", *more).stdout)
        return [task["state"] for task in status["tasks"]]

    def test_it_is_seen_and_made_again(self):
        self.write("job.toml", FARM_TOML)
        farm = ("farm", "job.toml", "--chunks", "3", "--processes", "2", "--threads", "1", "--then", "echo made >> film.txt")
        self.run_ok(*farm)
        whole = self.pictures("out")
        table = (self.folder / "out/f.timing.csv").read_text().splitlines()
        for name, harm, is_seen_by_size in (("f.0003.exr", cut, True), ("f.0005.png", remove, True), ("f.0004.exr", flip, False),
                                            ("f.timing.csv", cut, True), ("f.run.json", remove, True)):
            with self.subTest(name):
                harm(self.folder / "out" / name)
                self.assertEqual(set(self.states()) != {"done"}, is_seen_by_size)
                (self.folder / "film.txt").unlink()
                again = farm if harm is cut else ("farm", "retry", "out")
                self.run_ok(*again)
                self.assertEqual((self.folder / "film.txt").read_text(), "made\n")
                self.assertEqual(self.pictures("out"), whole)
                rows = (self.folder / "out/f.timing.csv").read_text().splitlines()
                self.assertEqual([row.split(",")[0] for row in rows], [row.split(",")[0] for row in table])
                self.assertEqual(set(self.states()), {"done"})


class DamagedSweep(harness.CliTest):
    def setUp(self):
        super().setUp()
        write_inputs(self.folder)
        self.write("plan.toml", SWEEP)

    def table(self, folder):
        with open(self.folder / folder / "results.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key not in (*TIMES, "task")} for row in csv.DictReader(file)]

    def pictures_of(self, folder):
        return {str(path.relative_to(self.folder / folder)): path.read_bytes() for path in (self.folder / folder).rglob("*")
                if path.suffix in (".exr", ".png")}

    def kept(self, pattern):
        """The first file of that kind that a sweep keeps, by its name within the folder."""
        return str(sorted((self.folder / "out").glob(pattern))[0].relative_to(self.folder / "out"))

    def test_it_is_measured_again(self):
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        table, pictures = self.table("out"), self.pictures_of("out")
        kinds = ("runs/run-*.json", "runs/cost-*.json", "references/*/frame.0002.json", "references/*/floor-*.json",
                 "frames/*/frame.0001.png", "references/*/half-1.0002.exr", "references/*/reference.0001.exr",
                 "references/*/reference.0001.png")
        for name in map(self.kept, kinds):
            for harm in (cut, flip, remove):
                with self.subTest(name=name, harm=harm.__name__):
                    harm(self.folder / "out" / name)
                    again = self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
                    self.assertEqual(self.table("out"), table)
                    self.assertEqual(self.pictures_of("out"), pictures)
                    if not (name.endswith(".json") and harm is remove):  # nothing says that it was ever there
                        self.assertRegex(again.stderr, r"^gazetrace: warning: \S+: .*does not count as finished\n$")

    def test_of_a_reference_that_frame_alone_is_rendered_again(self):
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        flip(self.folder / "out" / self.kept("references/*/half-2.0002.exr"))
        kept = self.folder / "out" / self.kept("references/*/half-2.0001.exr")
        before = kept.stat().st_ino  # a file that is written anew is another one
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        self.assertEqual(kept.stat().st_ino, before)

    def test_a_signal_ends_it_in_order(self):
        """Rows and pictures of a reference that are finished stay, and the same call goes on with the others."""
        self.write("plan.toml", SWEEP.replace('frames = "1-2"', 'frames = "1-4"').replace("spp = 4", "spp = 400"))
        words = ["sweep", "plan.toml", "-o", "out", "--quiet", "--threads", "1"]
        self.run_ok("sweep", "plan.toml", "-o", "whole", "--quiet")
        ends = []
        for number in (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT, signal.SIGXCPU):
            process = subprocess.Popen([harness.PROGRAM, *words], cwd=self.folder, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, text=True)
            before = len(self.files("out")) if (self.folder / "out").exists() else 0
            while process.poll() is None and len(self.files("out") if (self.folder / "out").exists() else []) < before + 3:
                time.sleep(0.005)
            process.send_signal(number)
            said = process.communicate(timeout=100)[1]
            ends.append(process.returncode)
            if process.returncode == 4:
                self.assertRegex(said, r"^gazetrace: interrupted by signal \w+; finished measurements are kept, and the same call continues\n$")
        self.assertLessEqual(set(ends), {0, 4})
        self.assertIn(4, ends)
        limited = self.run_program(*words[:2], "-o", "limited", "--quiet", "--max-time", "300ms", "--grace", "0s")
        self.assertEqual(limited.returncode, 4, limited.stderr)
        self.assertIn("interrupted by --max-time", limited.stderr)
        self.run_ok(*words)
        self.assertEqual(self.table("out"), self.table("whole"))

    def test_a_merge_joins_nothing_that_is_damaged(self):
        for chunk in ("1/2", "2/2"):
            self.run_ok("sweep", "plan.toml", "-o", "out", "--chunk", chunk, "--quiet")
        self.run_ok("sweep", "merge", "plan.toml", "-o", "out")
        table = self.table("out")
        flip(self.folder / "out" / self.kept("frames/*/frame.0001.png"))
        refused = self.run_program("sweep", "merge", "plan.toml", "-o", "out")
        self.assertEqual(refused.returncode, 2, refused.stdout)
        self.assertRegex(refused.stderr, r"are missing: box-left-\S+ \(round 1\)")
        for chunk in ("1/2", "2/2"):
            self.run_ok("sweep", "plan.toml", "-o", "out", "--chunk", chunk, "--quiet")
        self.run_ok("sweep", "merge", "plan.toml", "-o", "out")
        self.assertEqual(self.table("out"), table)
        # Damaged pictures that are believed stay as they are.
        path = self.folder / "out" / self.kept("frames/*/frame.0001.png")
        flip(path)
        damaged = path.read_bytes()
        self.run_ok("sweep", "merge", "plan.toml", "-o", "out", "--trust-files")
        self.assertEqual(path.read_bytes(), damaged)

    def test_a_record_leads_to_no_file_outside(self):
        """A folder that came from elsewhere must not have files removed that are not the sweep's."""
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        self.write("mine.txt", "mine")
        path = self.folder / "out" / self.kept("runs/run-*.json")
        path.write_text(path.read_text().replace('"frames/', '"../', 1))
        self.run_ok("sweep", "plan.toml", "-o", "out", "--quiet")
        self.assertEqual((self.folder / "mine.txt").read_text(), "mine")


if __name__ == "__main__":
    harness.main()
