# SPDX-License-Identifier: Apache-2.0
"""Frames that depend on those before them: two runs joined by a checkpoint, frames rendered before the first."""

import json
import zlib

import harness

# What stands on the command line wins over this file.
JOB_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "160x90"
frame-rect = [0, 0, 64, 36]
region-samples = [16, 16, 16]
exposure = "auto"
exposure-smoothing = "0.5s"
quiet = true
"""
JOB = ["--config", "job.toml"]
SMALL = ["--size", "64x36"]


def png_pixels(path):
    """What a .png shows, without what its header says."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        length = int.from_bytes(data[at:at + 4], "big")
        if data[at + 4:at + 8] == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += length + 12
    return zlib.decompress(packed)


class Histories(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.write("log.csv", harness.moving_gaze())
        self.write("job.toml", JOB_TOML)

    def render(self, folder, *more):
        self.run_ok("render", *JOB, "-o", f"{folder}/f.####.png", *more)
        return self.pictures(folder)

    def test_two_runs_joined_are_one(self):
        whole = self.render("whole", "--frames", "1-8")
        first = self.render("parts", "--frames", "1-5", "--checkpoint", "history.bin")
        joined = self.render("rest", "--frames", "6-8", "--resume-from", "history.bin")
        self.assertEqual(sorted({**first, **joined}), sorted(whole))
        for frame in range(1, 9):
            name = f"f.{frame:04d}.png"
            folder = "parts" if frame <= 5 else "rest"
            self.assertEqual(png_pixels(self.folder / folder / name), png_pixels(self.folder / "whole" / name))

    def record(self, path):
        return json.loads((self.folder / path).read_text())

    def part(self, folder, frames, *more):
        return self.run_ok("render", *JOB, *SMALL, "-o", f"{folder}/f.####.png", "--frames", frames, "--chunk", "1/1", *more)

    def test_parts_joined_by_a_checkpoint_merge(self):
        self.run_ok("render", *JOB, *SMALL, "-o", "whole/f.####.png", "--frames", "1-5")
        # One file hands the history on from part to part.
        self.part("parts", "1-2", "--checkpoint", "history.bin")
        self.part("parts", "3-4", "--resume-from", "history.bin", "--checkpoint", "history.bin")
        self.part("parts", "5", "--resume-from", "history.bin")
        merged = self.run_ok("merge", "parts")
        self.assertIn("3 parts joined, frames 1-5", merged.stdout)
        self.assertEqual(merged.stderr, "")
        for frame in range(1, 6):
            name = f"f.{frame:04d}.png"
            self.assertEqual(png_pixels(self.folder / "parts" / name), png_pixels(self.folder / "whole" / name))
        whole, parts = self.record("whole/f.run.json"), self.record("parts/f.run.json")
        for key in ("settings_digest", "frames", "is_part", "history", "input_digests"):
            self.assertEqual(parts[key], whole[key], key)
        self.assertEqual(parts["part_digests"], [])

    def test_broken_chains_of_parts_are_said(self):
        self.part("parts", "1-3", "--checkpoint", "after3.bin")
        alone = self.part("parts", "4")
        self.assertIn("--chunk: frame 4 begins without the history of those before it", alone.stderr)
        self.assert_refused(["merge", "parts"], ["f.timing.4.csv", "frame 4 was made without history",
                                                 "in one run it would have been with the history of frames 1-3",
                                                 "--resume-from and a checkpoint made after frame 3"])
        # The checkpoint of a part that lacks a frame.
        self.part("short", "1-2", "--checkpoint", "after2.bin")
        gap = self.part("parts", "4", "--resume-from", "after2.bin", "--overwrite")
        self.assertIn("those between are missing", gap.stderr)
        self.assert_refused(["merge", "parts"], ["f.timing.4.csv", "made with the history of frames 1-2"])
        # Rendered anew: joined, and the seam is said.
        prerolled = self.part("parts", "4", "--preroll", "2", "--overwrite")
        self.assertEqual(prerolled.stderr, "")
        merged = self.run_ok("merge", "parts")
        self.assertIn("f.timing.4.csv: frame 4 was made with the history of frames 2-3", merged.stderr)
        self.part("parts", "4", "--resume-from", "after3.bin", "--overwrite")
        self.assertEqual(self.run_ok("merge", "parts", "--overwrite").stderr, "")
        # Other settings stay other settings.
        self.part("parts", "5", "--preroll", "4", "--bounces", "2")
        self.assert_refused(["merge", "parts", "--overwrite"], ["f.timing.5.csv", "other settings"])

    def test_resume_writes_the_checkpoint_that_is_asked_for(self):
        def run(*more):
            return self.run_ok("render", *JOB, *SMALL, "-o", "out/f.####.png", "--frames", "1-3", *more)

        def state():
            return (self.folder / "history.bin").read_bytes()

        run("--checkpoint", "history.bin")
        wanted, pictures = state(), self.pictures("out")
        ask = ["--resume", "--checkpoint", "history.bin"]
        # Not there; not there and a frame to be rendered; older; damaged; of other settings.
        for damage in ("none", "frame", "old", "cut", "other"):
            with self.subTest(damage=damage):
                (self.folder / "history.bin").unlink(missing_ok=True)
                if damage == "frame":
                    (self.folder / "out/f.0002.png").unlink()
                elif damage == "old":
                    self.run_ok("render", *JOB, *SMALL, "-o", "old/f.####.png", "--frames", "1-2", "--checkpoint", "history.bin")
                elif damage == "cut":
                    self.write("history.bin", wanted[:-9])
                elif damage == "other":
                    self.run_ok("render", *JOB, *SMALL, "-o", "other/f.####.png", "--frames", "1-3", "--bounces", "2",
                                "--checkpoint", "history.bin")
                run(*ask, *(["--overwrite"] if damage == "other" else []))
                self.assertEqual(state(), wanted)
                self.assertEqual(self.pictures("out"), pictures)
        # What is there is left alone, and the frames are not rendered for it.
        before = (self.folder / "history.bin").stat().st_mtime_ns
        (self.folder / "out/f.0002.png").unlink()
        run(*ask, "--checkpoint-every", "1")
        self.assertEqual(self.pictures("out"), pictures)
        self.assertEqual(state(), wanted)
        self.assertEqual((self.folder / "history.bin").stat().st_mtime_ns, before)

    def test_the_checkpoint_has_a_place(self):
        self.run_ok("render", *JOB, *SMALL, "-o", "out/f.####.png", "--frames", "1", "--checkpoint", "new/folder/h.bin")
        self.assertEqual(self.files("new"), ["folder/h.bin"])
        self.write("file", "")
        (self.folder / "folder").mkdir()
        scene = (self.folder / "glide.gltf").read_bytes()
        for place, words in (("file/h.bin", "is not a folder"), ("folder", "is a folder"), ("glide.gltf", "would replace an input"),
                             ("bad/f.0001.png", "two outputs")):
            with self.subTest(place=place):
                self.assert_refused(["render", *JOB, *SMALL, "-o", "bad/f.####.png", "--frames", "1", "--checkpoint", place], [words])
        self.assertEqual((self.folder / "glide.gltf").read_bytes(), scene)

    def test_a_checkpoint_replaces_its_own_kind_alone(self):
        words = ["render", *JOB, *SMALL, "-o", "out/f.####.png", "--frames", "1", "--checkpoint", "notes.txt"]
        self.write("notes.txt", "mine")
        self.assert_refused(words, ["notes.txt", "is no whole checkpoint"])
        self.assertEqual((self.folder / "notes.txt").read_text(), "mine")
        self.run_ok(*words, "--overwrite")
        before = (self.folder / "notes.txt").read_bytes()
        other = [word.replace("out/", "other/") for word in words]
        self.assert_refused([*other, "--seed", "5"], ["notes.txt", "a checkpoint that was made under other settings"])
        self.assertEqual((self.folder / "notes.txt").read_bytes(), before)
        self.run_ok(*words, "--resume")
        # What a fault has left of one is no reason to stop.
        digit = before.index(b"\n") - 1  # of the settings' digest, in the first line
        for left in (before[:7], before[:digit] + b"x" + before[digit + 1:], b"\0" * 100, b""):
            (self.folder / "notes.txt").write_bytes(left)
            self.run_ok(*words, "--resume")

    def test_a_lost_row_of_a_chain(self):
        """The pictures are whole, and the history that the frame began from is gone: its row is made anew without times."""
        self.render("out", *SMALL, "--frames", "1-3", "--chunk", "1/1", "--checkpoint", "history.bin")
        second = [*SMALL, "--frames", "4-6", "--chunk", "1/1", "--resume-from", "history.bin"]
        whole = self.render("out", *second)
        table = self.folder / "out/f.timing.4-6.csv"
        lines = table.read_text().splitlines()
        table.write_text("\n".join(lines[:-1]) + "\n")
        self.assertEqual(self.render("out", *second, "--resume"), whole)
        self.assertEqual([line.split(",")[0] for line in table.read_text().splitlines()], [line.split(",")[0] for line in lines])

    def test_preroll_is_not_written(self):
        pictures = self.render("some", "--frames", "6-7", "--preroll", "3")
        self.assertEqual(sorted(pictures), ["f.0006.png", "f.0007.png"])

    def test_what_does_not_fit_is_said(self):
        self.render("parts", "--frames", "1-3", "--checkpoint", "history.bin")
        cases = [
            (["--frames", "3-5", "--resume-from", "history.bin"], "begin with frame 4"),
            (["--frames", "4-5", "--resume-from", "history.bin", "--bounces", "2"], "other settings"),
            (["--frames", "4-5", "--resume-from", "nothing.bin"], "nothing.bin"),
            (["--frames", "4-5", "--resume-from", "log.csv"], "is no checkpoint"),
            (["--frames", "4-5", "--exposure-smoothing", "0s", "--preroll", "2"], "do not depend"),
            (["--frames", "4-5", "--exposure-smoothing", "0s", "--checkpoint", "x.bin"], "do not depend"),
            (["--frames", "4-5", "--preroll", "2", "--resume-from", "history.bin"], "--preroll"),
            (["--frames", "4-5", "--checkpoint-every", "2"], "--checkpoint"),
            (["--animation", "walk"], "walk"),
        ]
        for options, text in cases:
            with self.subTest(options=options):
                self.assert_refused(["render", *JOB, "-o", "bad/f.####.png", *options], [text])


if __name__ == "__main__":
    harness.main()
