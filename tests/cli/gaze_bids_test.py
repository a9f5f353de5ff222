# SPDX-License-Identifier: Apache-2.0
"""Conversion to BIDS where recordings of the same name lie already."""

import fcntl
import json
import os
import subprocess

import harness

NAME = "sub-1_task-t_physio.tsv.gz"


def log(eyes, events=False, screen=True):
    lines = ["# gazetrace-gaze 1"] + ["# display_px 1000 500"] * screen
    lines += ["# event fixation left 0 40000000 "] * events + ["t[ns],u[1],v[1],valid,eye"]
    lines += [f"{i * 10_000_000},0.{400 + i},0.5,ok,{eye}" for i in range(20) for eye in eyes]
    return "\n".join(lines) + "\n"


class BidsFolder(harness.CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "b").mkdir()
        self.write("both.csv", log(["left", "right"], events=True))
        self.write("left.csv", log(["left"], screen=False))
        self.write("gaze.csv", log(["cyclopean"]))

    def convert(self, source, *arguments):
        return self.run_ok("gaze", "import", source, "-o", f"b/{NAME}", *arguments)

    def refused(self, words, source, *arguments):
        before = self.contents()
        self.assert_refused(["gaze", "import", source, "-o", f"b/{NAME}", *arguments], words)
        self.assertEqual(self.contents(), before)

    def contents(self):
        return {path.name: path.read_bytes() for path in (self.folder / "b").iterdir()}

    def fresh(self, source):
        (self.folder / "f").mkdir(exist_ok=True)
        for path in (self.folder / "f").iterdir():
            path.unlink()
        return {path.name: path.read_bytes() for path in self.written_in("f", source)}

    def test_overwriting_leaves_what_a_fresh_folder_has(self):
        for first, second in (("both", "left"), ("both", "gaze"), ("gaze", "both"), ("left", "gaze")):
            for path in (self.folder / "b").iterdir():
                path.unlink()
            self.convert(f"{first}.csv")
            removed = self.convert(f"{second}.csv", "--overwrite").stderr
            self.assertEqual(self.contents(), self.fresh(f"{second}.csv"), (first, second))
            self.assertEqual("removed" in removed, second != "both", (first, second))
        self.assertIn("recording-eye1_physio.tsv.gz", removed)

    def test_without_overwrite_nothing_is_joined(self):
        self.convert("left.csv")
        self.refused(["recording-eye1_physio.tsv.gz", "--overwrite"], "gaze.csv")

    def test_a_second_recording_of_the_same_eye_is_named(self):
        self.convert("left.csv")
        name = "sub-1_task-t_recording-eye1_physio"
        for ending in (".json", ".tsv.gz"):
            (self.folder / "b" / (name.replace("eye1", "again") + ending)).write_bytes((self.folder / "b" / (name + ending)).read_bytes())
        warnings = self.run_ok("gaze", "import", f"b/{name}.tsv.gz", "-o", "out.csv").stderr
        self.assertIn("recording-again_physio.tsv.gz: is a recording of the left eye as well, and is not read", warnings)

    def test_conversions_into_one_file_at_once_leave_a_whole_one(self):
        for _ in range(2):
            running = [subprocess.Popen([harness.PROGRAM, "gaze", "import", source, "-o", "c.csv", "--overwrite"], cwd=self.folder,
                                        stderr=subprocess.DEVNULL) for source in ("both.csv", "gaze.csv") * 2]
            self.assertEqual([process.wait() for process in running], [0] * len(running))
            whole = (self.folder / "c.csv").read_bytes()
            self.assertIn(whole, [self.converted(source) for source in ("both.csv", "gaze.csv")])

    def test_conversions_into_one_recording_at_once_leave_that_of_one_of_them(self):
        """The files of a recording belong together: none may be left of the other conversion."""
        for name, eyes in (("both", ["left", "right"]), ("gaze", ["cyclopean"])):
            rows = (f"{i * 2_000_000},0.{400 + i % 97},0.5,ok,{eye}" for i in range(6_000) for eye in eyes)
            self.write(f"long_{name}.csv", "# gazetrace-gaze 1\n# display_px 1000 500\nt[ns],u[1],v[1],valid,eye\n" + "\n".join(rows) + "\n")
        whole = [self.fresh(f"long_{name}.csv") for name in ("both", "gaze")]
        for _ in range(4):
            running = [subprocess.Popen([harness.PROGRAM, "gaze", "import", source, "-o", f"b/{NAME}", "--overwrite"], cwd=self.folder,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for source in ("long_both.csv", "long_gaze.csv") * 2]
            self.assertEqual([process.wait() for process in running], [0] * len(running))
            self.assertIn(self.contents(), whole)

    def test_what_another_conversion_leaves_while_one_waits_is_seen(self):
        """A conversion that has to wait for the folder must not act on what it held before."""
        left = {path: path.read_bytes() for path in self.written_in("f", "both.csv")}
        expected = self.fresh("gaze.csv")
        folder = os.open(self.folder / "b", os.O_RDONLY)
        try:
            fcntl.flock(folder, fcntl.LOCK_EX)
            waiting = subprocess.Popen([harness.PROGRAM, "gaze", "import", "gaze.csv", "-o", f"b/{NAME}", "--overwrite"], cwd=self.folder,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            self.assertRaises(subprocess.TimeoutExpired, waiting.wait, 2)  # long enough to have come to the lock
            for path, content in left.items():
                (self.folder / "b" / path.name).write_bytes(content)
        finally:
            os.close(folder)
        _, warnings = waiting.communicate()
        self.assertEqual(waiting.returncode, 0, warnings)
        self.assertEqual(self.contents(), expected)

    def written_in(self, folder, source):
        (self.folder / folder).mkdir(exist_ok=True)
        self.run_ok("gaze", "import", source, "-o", f"{folder}/{NAME}")
        return list((self.folder / folder).iterdir())

    def converted(self, source):
        self.run_ok("gaze", "import", source, "-o", "alone.csv", "--overwrite")
        return (self.folder / "alone.csv").read_bytes()

    def test_recordings_of_others_stay(self):
        self.convert("both.csv")
        sidecar = self.folder / "b" / "sub-1_task-t_recording-eye2_physio.json"
        other = json.loads(sidecar.read_text())
        del other["WrittenBy"]
        sidecar.write_text(json.dumps(other))
        self.refused(["recording-eye2_physio.tsv.gz", "did not write"], "left.csv", "--overwrite")

    def test_what_is_no_gaze_of_this_name_stays(self):
        self.convert("both.csv")
        for name, text in (("sub-1_task-t_recording-cardiac_physio.json", '{"SamplingFrequency": 100, "Columns": ["cardiac"]}'),
                           ("sub-1_task-t_recording-cardiac_physio.tsv", "0.1\n"), ("sub-1_task-t_events.tsv", "onset\tduration\n"),
                           ("sub-1_task-u_recording-eye2_physio.tsv", "1\t2\t3\n"), ("sub-1_task-t_bold.json", "{}")):
            (self.folder / "b" / name).write_text(text)
        self.convert("gaze.csv", "--overwrite")
        self.assertEqual(len([name for name in self.contents() if "eye2" in name or "cardiac" in name or "bold" in name]), 4)
        self.assertIn("sub-1_task-t_events.tsv", self.contents())

    def test_what_is_converted_is_not_removed(self):
        self.convert("both.csv")
        self.refused(["recording-cyclopean_physio.tsv.gz", "another name"], f"b/{NAME}".replace("_physio", "_recording-eye1_physio"),
                     "--gaze-eye", "left", "--overwrite")


if __name__ == "__main__":
    harness.main()
