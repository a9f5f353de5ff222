# SPDX-License-Identifier: Apache-2.0
"""Where the samples go by a picture from outside: --density FILE.exr."""

import csv
import json
import struct

import harness

VIEW = ["--size", "64x36", "--eye", "0,0,3", "--target", "0,0,0", "--quiet"]


def exr(width, height, rows):
    """The bytes of an uncompressed EXR of one float channel Y."""

    def attribute(name, kind, value):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value

    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    channel = b"Y\0" + struct.pack("<i4B2i", 2, 0, 0, 0, 0, 1, 1) + b"\0"
    head = struct.pack("<2i", 20000630, 2) + b"".join([
        attribute("channels", "chlist", channel), attribute("compression", "compression", b"\0"),
        attribute("dataWindow", "box2i", box), attribute("displayWindow", "box2i", box),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    size = 8 + 4 * width
    offsets = b"".join(struct.pack("<Q", len(head) + 8 * height + y * size) for y in range(height))
    lines = b"".join(struct.pack("<2i", y, 4 * width) + struct.pack(f"<{width}f", *rows[y]) for y in range(height))
    return head + offsets + lines


class DensityMap(harness.CliTest):
    def write_map(self, name, *values):
        (self.folder / name).write_bytes(exr(len(values), 1, [values]))

    def render(self, out, *more):
        self.run_ok("render", "box.gltf", *VIEW, *more, "-o", f"{out}/f.####.exr")
        with open(self.folder / out / "f.timing.csv", newline="") as file:
            return [int(row["samples"]) for row in csv.DictReader(file)]

    def test_rates_of_one_picture_and_of_a_budget(self):
        self.write_map("even.exr", 3)
        self.assertEqual(self.render("even", "--density", "even.exr"), [3 * 64 * 36])
        self.write_map("uneven.exr", 8, 8, 1, 1)
        free, = self.render("free", "--density", "uneven.exr")
        self.assertAlmostEqual(free, 4.5 * 64 * 36, delta=0.01 * free)
        bound, = self.render("bound", "--density", "uneven.exr", "--spp", "1.25")
        self.assertAlmostEqual(bound, 1.25 * 64 * 36, delta=1.1)

    def test_counts_need_no_rendering_and_the_map_of_one_run_serves_another(self):
        self.run_ok("render", "box.gltf", *VIEW, *harness.SCREEN, "--gaze-at", "0.4,0.5", "--density", "acuity", "--spp",
                    "6", "-o", "a/f.exr", "--map", "a/map.exr")
        with open(self.folder / "a" / "f.timing.csv", newline="") as file:
            samples = int(next(csv.DictReader(file))["samples"])
        counts = json.loads(self.run_ok("plan", "--counts", "--json", "--size", "64x36", "--density",
                                        "a/map.exr").stdout)[0]
        self.assertAlmostEqual(counts["traced_samples"], samples, delta=1.1)

    def test_a_sequence_of_maps(self):
        for frame in (1, 2, 3):
            self.write_map(f"d.{frame:04}.exr", frame)
        common = ["--density", "d.####.exr", "--frames", "1-3"]
        self.assertEqual(self.render("all", *common), [64 * 36 * frame for frame in (1, 2, 3)])
        # Parts have the digest of the whole, and the same pictures.
        for part in ("1", "2-3"):
            self.run_ok("render", "box.gltf", *VIEW, "--density", "d.####.exr", "--frames", part, "--chunk", "1/1",
                        "-o", "parts/f.####.exr")
        self.run_ok("merge", "parts")
        self.assertEqual(self.pictures("all"), self.pictures("parts"))
        record = json.loads((self.folder / "all" / "f.run.json").read_text())
        self.assertIn("d.0002.exr", record["input_digests"])
        # Another content is another run.
        before = (self.folder / "all/f.0002.exr").read_bytes()
        self.render("all", *common, "--resume")
        self.assertEqual((self.folder / "all/f.0002.exr").read_bytes(), before)
        self.write_map("d.0002.exr", 5)
        again = ["render", "box.gltf", *VIEW, *common, "--resume", "-o", "all/f.####.exr"]
        self.assert_refused(again, ["3 finished frames, 1-3", "d.0002.exr has changed"])
        self.assertEqual(self.render("all", *common, "--resume", "--overwrite"), [64 * 36 * frame for frame in (1, 5, 3)])
        self.assert_refused(["render", "box.gltf", *VIEW, "--density", "d.####.exr", "--frames", "4", "-o",
                             "x.exr"], ["d.0004.exr"])

    def test_what_is_refused(self):
        self.write_map("bad.exr", 1, 1, -2)
        self.write_map("nan.exr", 1, float("nan"))
        self.write_map("good.exr", 1)
        for words, *arguments in [
            (["bad.exr: pixel 2,0 has the value -2"], "--density", "bad.exr"),
            (["nan.exr: pixel 1,0 has the value nan"], "--density", "nan.exr"),
            (["missing.exr"], "--density", "missing.exr"),
            (["no-such-density.png", "a file: .csv for a curve, .exr for a picture"], "--density", "no-such-density.png"),
        ]:
            with self.subTest(arguments=arguments):
                self.assert_refused(["render", "box.gltf", *VIEW, *arguments, "-o", "x/x.exr"], words)
        self.write("job.toml", 'density = "good.exr"\n')
        idle = self.run_ok("render", "box.gltf", *VIEW, "--config", "job.toml", "--sampling", "uniform", "-o", "idle/f.exr").stderr
        self.assertIn("--density does nothing with --sampling uniform", idle)


if __name__ == "__main__":
    harness.main()
