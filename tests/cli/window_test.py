# SPDX-License-Identifier: Apache-2.0
"""Frames that read those around them: parts, resumed runs and single frames have the bits of one run."""

import csv
import json
import zlib

import harness

JOB_TOML = """
scene = "glide.gltf"
gaze = "log.csv"
size = "64x36"
frame-rect = [0, 0, 64, 36]
region-samples = [8, 8, 8]
accumulate = "window"
accumulate-past = "90ms"
accumulate-future = "50ms"
filter = "guided"
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


class Window(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        self.write("log.csv", harness.moving_gaze())
        self.write("job.toml", JOB_TOML)

    def render(self, folder, *more):
        self.run_ok("render", *JOB, "-o", f"{folder}/f.####.png", *more)
        return {path.name: png_pixels(path) for path in (self.folder / folder).glob("f.*.png")}

    def test_without_a_window_every_frame_stands_for_itself(self):
        off = self.render("off", "--frames", "3,4", "--accumulate", "off", "--filter", "none")
        alone = self.render("alone", "--frames", "3,4", "--accumulate-past", "0s", "--accumulate-future", "40ms", "--filter", "none")
        self.assertEqual(alone, off)  # a frame is 41.7 ms
        self.assertNotEqual(self.render("both", "--frames", "3,4", "--filter", "none"), off)

    def test_raw_samples_join_only_where_that_is_asked(self):
        self.write("job.toml", "\n".join(line for line in JOB_TOML.splitlines() if not line.startswith("accumulate")))
        raw = self.render("raw", "--frames", "3,4", "--filter", "none")
        self.assertEqual(raw, self.render("off", "--frames", "3,4", "--filter", "none", "--accumulate", "off"))
        self.assertNotEqual(raw, self.render("window", "--frames", "3,4", "--filter", "none", "--accumulate", "window"))
        filtered = self.render("filtered", "--frames", "3,4")
        self.assertNotEqual(filtered, self.render("alone", "--frames", "3,4", "--accumulate", "off"))

    def test_a_frame_is_the_same_in_every_run(self):
        whole = self.render("whole", "--frames", "1-8")
        for frames in ("1-3", "4", "5-8", "2,7"):
            part = self.render(f"part-{frames}", "--frames", frames, "--chunk", "1/1")
            for name, pixels in part.items():
                self.assertEqual(pixels, whole[name], f"{frames}: {name}")
        self.assertEqual(self.render("one-thread", "--frames", "4", "--threads", "1")["f.0004.png"],
                         whole["f.0004.png"])

    def test_nothing_flickers_at_rest(self):
        self.run_ok("render", "box.gltf", "--size", "64x36", "--fps", "24", "--frames", "1-8", "--sampling", "uniform", "--spp", "2",
                    "--accumulate", "window", "--accumulate-past", "50ms", "--accumulate-future", "50ms", "--filter", "guided",
                    "--quiet", "-o", "rest/f.####.png")
        frames = [png_pixels(self.folder / f"rest/f.{frame:04d}.png") for frame in range(3, 8)]  # whose windows are whole
        self.assertEqual(len(set(frames)), 1)

    def test_parts_merge_and_a_run_resumes(self):
        whole = self.render("whole", "--frames", "1-6")
        self.render("parts", "--frames", "1-3", "--chunk", "1/1")
        self.render("parts", "--frames", "4-6", "--chunk", "1/1")
        self.run_ok("merge", "parts")
        self.assertEqual({p.name: png_pixels(p) for p in (self.folder / "parts").glob("f.*.png")}, whole)
        (self.folder / "whole" / "f.0004.png").unlink()
        self.assertEqual(self.render("whole", "--frames", "1-6", "--resume"), whole)

    def test_the_table_tells_a_frames_own_samples_from_those_of_others(self):
        self.render("one", "--frames", "5", "--sampling", "uniform", "--spp", "2")
        row, = self.table("one")
        own = 2 * 64 * 36
        self.assertEqual((int(row["samples"]), int(row["other_samples"])), (4 * own, 3 * own))  # two before, one after
        self.render("off", "--frames", "5", "--sampling", "uniform", "--spp", "2", "--accumulate", "off")
        row, = self.table("off")
        self.assertEqual((int(row["samples"]), int(row["other_samples"])), (own, 0))

    def table(self, folder):
        with open(self.folder / folder / "f.timing.csv", newline="") as file:
            return list(csv.DictReader(line for line in file if not line.startswith("#")))

    def test_the_plan_says_what_the_frames_around_cost(self):
        told = self.run_ok("plan", *JOB, "--frames", "5-8").stderr
        self.assertIn("3 more frames are traced for the windows of these 4", told)

    def test_the_largest_number_of_a_frame(self):
        self.write("still.gltf", json.dumps(harness.box_gltf()))
        self.run_ok("render", "still.gltf", "--size", "16x9", "--sampling", "uniform", "--spp", "1", "-o", "f.####.png",
                    "--accumulate", "window", "--frames", "2147483647")
        self.assertEqual([path.name for path in self.folder.glob("f.*.png")], ["f.2147483647.png"])

    def test_frames_beyond_the_camera_path_are_not_read(self):
        # The path of one second has 24 frames.
        last = self.render("last", "--frames", "24")
        self.assertEqual(last, {"f.0024.png": self.render("all", "--frames", "20-24")["f.0024.png"]})

    def test_the_record_says_whether_it_is_causal(self):
        self.render("both", "--frames", "3")
        facts = json.loads((self.folder / "both" / "f.run.json").read_text())["facts"]
        self.assertEqual(facts["causal"], "false")
        self.render("past", "--frames", "3", "--accumulate-future", "0s")
        self.assertNotIn("causal", json.loads((self.folder / "past" / "f.run.json").read_text())["facts"])

    def test_a_window_that_does_not_fit_is_refused(self):
        self.assert_refused(["render", *JOB, "-o", "x/f.####.png", "--frames", "3", "--size", "1920x1080", "--max-memory", "64MiB"],
                            ["--accumulate-past", "GiB"])

    def test_former_ways_to_accumulate(self):
        for old, words in ((["two-sided"], "--accumulate-past"), (["reproject"], "--accumulate-future"), (["running"], "window")):
            told = self.run_ok("render", *JOB, "-o", f"{old[0]}/f.####.png", "--frames", "3", "--accumulate", *old).stderr
            self.assertIn(words, told)
        self.assert_refused(["render", *JOB, "-o", "x/f.####.png", "--frames", "3", "--accumulate-window", "4"], ["--accumulate-past"])


if __name__ == "__main__":
    harness.main()
