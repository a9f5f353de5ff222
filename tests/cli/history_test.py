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
accumulate = "reproject"
quiet = true
"""
JOB = ["--config", "job.toml"]


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
            (["--frames", "4-5", "--accumulate", "off", "--preroll", "2"], "do not depend"),
            (["--frames", "4-5", "--accumulate", "off", "--checkpoint", "x.bin"], "do not depend"),
            (["--frames", "4-5", "--preroll", "2", "--resume-from", "history.bin"], "--preroll"),
            (["--frames", "4-5", "--checkpoint-every", "2"], "--checkpoint"),
            (["--frames", "4-5", "--accumulate-blend", "1.5"], "outside 0..1"),
            (["--frames", "4-5", "--accumulate-blend", "1e-160"], "give 1e-06 or more"),
            (["--accumulate-order", "before", "--filter", "guided"], "--accumulate-order"),
            (["--animation", "walk"], "walk"),
        ]
        for options, text in cases:
            with self.subTest(options=options):
                self.assert_refused(["render", *JOB, "-o", "bad/f.####.png", *options], [text])


if __name__ == "__main__":
    harness.main()
