# SPDX-License-Identifier: Apache-2.0
"""What a compositor asks of a shot: alpha, ACEScg and data windows, against numbers worked out by hand."""

import base64
import json
import struct

import harness
from exr_reader import Exr

GREY = (0.25, 0.5, 0.125)
CARD = (0.5, 0.25, 0.75)
UNIFORM = ["--falloff", "uniform", "--filter", "none", "--threads", "1", "--quiet", "--overwrite"]
EXACT = ["--exr-pixels", "float", "--exr-compression", "none"]
# Linear Rec.709 to ACEScg, as colour-science and the public ACES configurations publish it.
TO_ACESCG = ((0.6130974, 0.3395231, 0.0473795), (0.0701937, 0.9163539, 0.0134523), (0.0206156, 0.1095698, 0.8698147))
AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)


def card():
    """An unlit card from x = -3.25 to 3.75 and y = -2.5 to 2 before a camera that shows 16 m across and 8 m down."""
    corners = struct.pack("<12f", -3.25, -2.5, 0, 3.75, -2.5, 0, -3.25, 2, 0, 3.75, 2, 0)
    data = base64.b64encode(corners + struct.pack("<6H", 0, 1, 2, 2, 1, 3)).decode()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 5]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [*CARD, 1]}, "doubleSided": True, "extensions": {"KHR_materials_unlit": {}}}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 8, "ymag": 4, "znear": 0.1, "zfar": 10}}],
        "buffers": [{"byteLength": 60, "uri": "data:application/octet-stream;base64," + data}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-3.25, -2.5, 0], "max": [3.75, 2, 0]},
                      {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "extensionsUsed": ["KHR_materials_unlit"]}


def covered(x, y):
    """The share of a pixel of 1 m that the card covers: rows count down from 4 m."""
    width = max(0.0, min(x - 7, 3.75) - max(x - 8, -3.25))
    height = max(0.0, min(4 - y, 2) - max(3 - y, -2.5))
    return width * height


class Shots(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("card.gltf", json.dumps(card()))

    def picture(self, name, *arguments):
        self.run_ok("render", *arguments, *EXACT, "-o", name)
        return Exr(self.folder / name)

    def colors(self, exr):
        return [list(zip(*rows)) for rows in zip(*(exr.channel(c) for c in "RGB"))]

    def card(self, name, *arguments):
        return self.picture(name, "card.gltf", "--env", "constant:" + ",".join(map(str, GREY)), "--size", "16x8", "--spp", "256", *arguments)

    def test_a_card_over_grey_is_the_picture_with_grey_behind(self):
        opaque = self.colors(self.card("opaque.exr", *UNIFORM))
        layered = self.card("card.exr", *UNIFORM, "--alpha")
        self.assertNotIn("A", Exr(self.folder / "opaque.exr").types)
        alpha, premultiplied = layered.channel("A"), self.colors(layered)
        for y in range(8):
            for x in range(16):
                share = covered(x, y)
                self.assertAlmostEqual(alpha[y][x], share, delta=0.02, msg=(x, y))
                for c in range(3):
                    self.assertAlmostEqual(premultiplied[y][x][c], share * CARD[c], delta=0.02)
                    over = premultiplied[y][x][c] + (1 - alpha[y][x]) * GREY[c]
                    self.assertAlmostEqual(over, opaque[y][x][c], delta=0.02)
                if share == 0:
                    self.assertEqual((alpha[y][x], *premultiplied[y][x]), (0, 0, 0, 0))

    def test_coverage_does_not_follow_samples_and_filters(self):
        self.write("log.csv", harness.moving_gaze(20))
        gaze = ["--gaze", "log.csv", *harness.SCREEN, "--frame-rect", "0,0,64,32", "--spp", "2", "--quiet", "--alpha"]
        for name, more in (("a.exr", ["--filter", "linear"]), ("b.exr", ["--filter", "guided"]), ("c.exr", ["--falloff", "uniform", "--accumulate", "window"])):
            other = self.picture(name, "card.gltf", "--env", "constant:1,1,1", "--size", "16x8", "--frames", "2", *gaze, *more)
            colors = self.colors(other)
            for y, row in enumerate(other.channel("A")):
                for x, value in enumerate(row):
                    self.assertAlmostEqual(value, covered(x, y), delta=0.02, msg=(name, x, y))
                    if value == 0:
                        self.assertEqual(colors[y][x], (0, 0, 0))

    def test_png_is_straight(self):
        self.run_ok("render", "card.gltf", "--env", "none", "--size", "16x8", "--spp", "64", *UNIFORM, "--view", "Raw", "--exposure", "0", "--alpha",
                    "-o", "card.png")
        size, rows = harness.read_png(self.folder / "card.png")
        self.assertEqual(size, (16, 8))
        for y in range(8):
            for x in range(16):
                self.assertAlmostEqual(rows[y][x][3], 255 * covered(x, y), delta=5)
                if covered(x, y) > 0.4:  # a pixel at an edge has the colour of the card
                    for c in range(3):
                        self.assertAlmostEqual(rows[y][x][c], 255 * CARD[c], delta=12, msg=(x, y))
        self.assert_refused(["render", "card.gltf", "--size", "16x8", "--alpha", "-o", "card.jpg"], ["card.jpg", "alpha", ".png"])

    def test_exr_is_compressed_by_zip_unless_said_otherwise(self):
        """By the number in the file's header: of OpenEXR's methods 0 is none and 3 is zip."""
        for number, options in ((3, []), (0, ["--exr-compression", "none"])):
            self.run_ok("render", "card.gltf", "--size", "16x8", "--spp", "1", *options, *UNIFORM, "-o", "f.exr")
            self.assertEqual(Exr(self.folder / "f.exr").attributes["compression"][1], bytes([number]), options)

    def test_acescg_is_converted_and_stated(self):
        arguments = ["box.gltf", "--size", "32x18", "--spp", "2", "--aov", "albedo,depth,diffuse_direct", *UNIFORM]
        plain = self.picture("plain.exr", *arguments)
        aces = self.picture("aces.exr", *arguments, "--exr-space", "ACEScg")
        self.assertEqual(aces.text("colorSpace"), "ACEScg")
        for stated, wanted in zip(struct.unpack("<8f", aces.attributes["chromaticities"][1]), AP1):
            self.assertAlmostEqual(stated, wanted, 6)
        for layer in ("", "albedo.", "diffuse_direct."):
            before, after = ([exr.channel(layer + c) for c in "RGB"] for exr in (plain, aces))
            for i, row in enumerate(TO_ACESCG):
                for y in range(18):
                    for x in range(32):
                        wanted = sum(row[c] * before[c][y][x] for c in range(3))
                        self.assertAlmostEqual(after[i][y][x], wanted, delta=2e-6 + (2e-6 if not layer else 2e-3) * abs(wanted))
        self.assertEqual(plain.channel("depth.Z"), aces.channel("depth.Z"))

    def test_a_crop_is_what_the_frame_shows_there(self):
        arguments = ["box.gltf", "--size", "64x36", "--spp", "4", "--aov", "depth,position", *UNIFORM]
        whole = self.picture("whole.exr", *arguments)
        part = self.picture("part.exr", *arguments, "--crop", "20,11,25,13")
        window = {name: struct.unpack("<4i", part.attributes[name][1]) for name in ("dataWindow", "displayWindow")}
        self.assertEqual(window, {"dataWindow": (20, 11, 44, 23), "displayWindow": (0, 0, 63, 35)})
        for name in ("worldToNDC", "gazetrace:camera"):
            self.assertEqual(part.attributes[name], whole.attributes[name])
        for channel in ("R", "G", "B", "depth.Z", "position.X"):
            inside = [row[20:45] for row in whole.channel(channel)[11:24]]
            pairs = [(a, b) for ours, theirs in zip(part.channel(channel), inside) for a, b in zip(ours, theirs)]
            same = sum(a == b or abs(a - b) < 1e-4 * abs(b) for a, b in pairs)  # rays differ by their last bits
            self.assertGreater(same, 0.98 * len(pairs), channel)
        self.run_ok("render", *arguments[:5], "--crop", "20,11,25,13", "--quiet", "-o", "window.png")
        self.assertEqual(harness.read_png(self.folder / "window.png")[0], (25, 13))
        self.assert_refused(["render", *arguments[:5], "--crop", "40,0,25,13", "-o", "x.exr"], ["--crop", "64 x 36"])


if __name__ == "__main__":
    harness.main()
