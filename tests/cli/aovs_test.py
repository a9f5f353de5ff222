# SPDX-License-Identifier: Apache-2.0
"""Layers of pictures from outside, with a reader of EXR and of Cryptomatte of the test's own."""

import csv
import json

import harness
from exr_reader import Exr

COURTYARD = [str(harness.SOURCE / "scenes/courtyard/courtyard.gltf"), "--env",
             str(harness.SOURCE / "scenes/courtyard/dusk.hdr"), "--camera", "walk", "--size", "64x36", "--fps", "24"]
LIGHT = ["diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect", "emission", "background"]
ALL = ["albedo", "normal", "depth", *LIGHT, "position", "forward", "backward", "crypto_object", "crypto_material",
       "crypto_asset", "samples", "variance"]


def murmur3(data):
    """MurmurHash3 for 32 bits with seed 0."""
    mask, value = 0xFFFFFFFF, 0

    def mixed(block):
        block = block * 0xCC9E2D51 & mask
        return ((block << 15 | block >> 17) & mask) * 0x1B873593 & mask

    whole = len(data) // 4 * 4
    for i in range(0, whole, 4):
        value ^= mixed(int.from_bytes(data[i:i + 4], "little"))
        value = ((value << 13 | value >> 19) & mask) * 5 + 0xE6546B64 & mask
    if data[whole:]:
        value ^= mixed(int.from_bytes(data[whole:], "little"))
    value ^= len(data)
    for shift, factor in ((16, 0x85EBCA6B), (13, 0xC2B2AE35), (16, 1)):
        value = (value ^ value >> shift) * factor & mask
    return value


def identifier(name):
    value = murmur3(name.encode())
    return value ^ 1 << 23 if (value >> 23 & 255) in (0, 255) else value


class Mattes:
    """A Cryptomatte layer of a picture: names, and for each pixel pairs of identifier and coverage."""

    def __init__(self, exr, layer):
        key = f"cryptomatte/{identifier(layer):08x}"[:19] + "/"
        assert exr.text(key + "name") == layer
        assert exr.text(key + "hash") == "MurmurHash3_32"
        assert exr.text(key + "conversion") == "uint32_to_float32"
        self.names = {int(number, 16): name for name, number in json.loads(exr.text(key + "manifest")).items()}
        layers = sorted({name.split(".")[0] for name in exr.types if name.startswith(layer)})
        self.ids = [exr.channel(f"{one}.{c}", bits=True) for one in layers for c in "RB"]
        self.coverage = [exr.channel(f"{one}.{c}") for one in layers for c in "GA"]

    def pixel(self, x, y):
        return [(ids[y][x], share[y][x]) for ids, share in zip(self.ids, self.coverage) if ids[y][x]]


class Aovs(harness.CliTest):
    def render(self, name, *options, frames="9"):
        self.run_ok("render", *COURTYARD, "--frames", frames, "--quiet", "--exr-compression", "none", "-o",
                    f"{name}/f.####.exr", *options)
        return [Exr(path) for path in sorted((self.folder / name).glob("f.*.exr"))]

    def test_mattes_by_a_reader_of_its_own(self):
        (exr,) = self.render("out", "--spp", "1", "--aov", "crypto_object,crypto_material,crypto_asset,depth")
        depth = exr.channel("depth.Z")
        gltf = json.loads((harness.SOURCE / "scenes/courtyard/courtyard.gltf").read_text())
        known = {"crypto_object": {node["name"] for node in gltf["nodes"] if "mesh" in node},
                 "crypto_material": {material["name"] for material in gltf["materials"]},
                 "crypto_asset": {gltf["nodes"][i]["name"] for i in gltf["scenes"][0]["nodes"]}}
        for layer, names in known.items():
            mattes = Mattes(exr, layer)
            self.assertEqual(len(mattes.ids), 6)
            self.assertLessEqual(set(mattes.names.values()), names)
            for number, name in mattes.names.items():
                self.assertEqual(number, identifier(name))
            seen = set()
            for y in range(exr.height):
                for x in range(exr.width):
                    pixel = mattes.pixel(x, y)
                    shares = [share for _, share in pixel]
                    self.assertEqual(shares, sorted(shares, reverse=True))
                    self.assertLessEqual(sum(shares), 1 + 1e-6)
                    seen |= {mattes.names[number] for number, _ in pixel}
                    if not pixel:
                        self.assertEqual(depth[y][x], float("inf"))
            self.assertGreater(len(seen), 5, layer)
        # All leaves and the pot of a shrub are one asset.
        self.assertIn("shrub by the niche", Mattes(exr, "crypto_asset").names.values())
        self.assertNotIn("shrub by the niche: pot", Mattes(exr, "crypto_asset").names.values())

    def test_coverage_is_the_same_however_samples_are_spread(self):
        mattes = ["--aov", "crypto_object", "--crypto-samples", "16", "--crypto-ranks", "4"]
        (uniform,) = self.render("uniform", "--spp", "2", *mattes)
        (foveated,) = self.render("foveated", "--screen", "paper", "--gaze-at", "0.2,0.3", "--region-samples", "8,2,1", *mattes)
        self.assertNotEqual(uniform.channel("R"), foveated.channel("R"))
        one, two = Mattes(uniform, "crypto_object"), Mattes(foveated, "crypto_object")
        self.assertEqual(len(one.ids), 4)
        self.assertEqual(one.ids, two.ids)
        self.assertEqual(one.coverage, two.coverage)
        for share in {share for rows in one.coverage for row in rows for share in row}:
            self.assertEqual(share * 16, int(share * 16))

    def test_layers_leave_the_picture_and_add_up_to_it(self):
        for options in (["--spp", "2"],
                        ["--screen", "paper", "--gaze-at", "0.4,0.5", "--region-samples", "8,2,1", "--filter", "guided"]):
            name = "with" + str(len(options))
            (plain,) = self.render(name + "out", "--exr-pixels", "float", *options)
            (exr,) = self.render(name, "--exr-pixels", "float", "--aov", ",".join(ALL), *options)
            for c in "RGB":
                beauty = exr.channel(c, bits=True)
                self.assertEqual(beauty, plain.channel(c, bits=True))
                parts = [exr.channel(f"{layer}.{c}") for layer in LIGHT]
                for y, row in enumerate(exr.channel(c)):
                    for x, whole in enumerate(row):
                        self.assertAlmostEqual(sum(part[y][x] for part in parts), whole, delta=1e-4 * max(whole, 1e-3))

    def test_all_frames_have_the_same_channels_in_groups(self):
        frames = self.render("out", "--spp", "1", "--aov", ",".join(ALL), frames="1,119")
        self.assertEqual(len(frames), 2)
        self.assertEqual(frames[0].types, frames[1].types)
        for channel in frames[0].types:
            self.assertTrue("." in channel or channel in "RGB", channel)
        for frame, number in zip(frames, (1, 119)):
            self.assertEqual(frame.attributes["framesPerSecond"][0], "rational")
            self.assertEqual(frame.attributes["worldToCamera"][0], "m44f")
            self.assertEqual(frame.attributes["worldToNDC"][0], "m44f")
            seconds, rest = divmod(number - 1, 24)
            digits = int.from_bytes(frame.attributes["timeCode"][1][:4], "little")
            self.assertEqual(digits & 0xFF3F, int(str(seconds), 16) << 8 | int(str(rest), 16))

    def test_gaze_as_numbers(self):
        rows = [f"{i * 10_000_000},{0.25 + i / 1000},0.75,{'ok' if i < 10 else 'lost'},left" for i in range(40)]
        self.write("log.csv", harness.gaze_csv(rows))
        frames = self.render("out", "--gaze", "log.csv", "--gaze-missing", "uniform", "--gaze-max-age", "20ms",
                             "--screen-px", "64,36", "--screen-cm", "64,36", "--screen-distance-cm", "60", "--spp", "1",
                             frames="1-8")
        with open(self.folder / "out/f.timing.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual(len(table), 8)
        valid = []
        for exr, row in zip(frames, table):
            self.assertEqual(exr.number("gaze.valid"), int(row["gaze.valid"]))
            valid.append(int(row["gaze.valid"]))
            for name in ("gaze.u", "gaze.v"):
                if valid[-1]:
                    self.assertAlmostEqual(exr.number(name), float(row[name]), delta=1e-6)
        self.assertEqual(valid[0], 1)
        self.assertEqual(valid[-1], 0)
        self.assertAlmostEqual(float(table[0]["gaze.v"]), 0.75, delta=1e-6)
        self.assertAlmostEqual(float(table[0]["gaze.u"]), 0.251, delta=0.0015)  # row 2 at 20.8 ms

    def test_what_cannot_be_is_refused(self):
        render = ["render", *COURTYARD, "--frames", "1", "--spp", "1", "-o", "f.####.exr", "--aov"]
        self.assert_refused([*render, "crypto_object", "--exr-compression", "dwaa"], ["exr-compression", "--exr-parts multi"])
        self.assert_refused([*render, "crypto_object", "--crypto-ranks", "5"], ["crypto-ranks", "even"])
        self.assert_refused([*render, "depth,depth"], ["aov", "twice"])
        self.run_ok(*render, "crypto_object", "--exr-compression", "dwaa", "--exr-parts", "multi")
        self.run_ok(*render, "crypto_object", "--exr-compression", "dwaa", "--exr-parts", "multi", "--resume")


if __name__ == "__main__":
    harness.main()
