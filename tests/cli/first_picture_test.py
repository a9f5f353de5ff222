# SPDX-License-Identifier: Apache-2.0
"""The first picture that a user makes of a scene of her own is lit, and what makes it dark is said."""

import base64
import json
import shutil
import statistics
import struct

import harness

WHITE = 255


def room_gltf(lamp_w_m2=12.0):
    """A closed room of 4 x 3 x 2.5 m (x, z, y) with one window in its back wall and a square lamp of 0.5 m a side that
    shines down with so much radiant exitance; a camera stands at the front wall. Every face is a quad of its own."""
    w, h, d = 4.0, 2.5, 3.0
    quads = [  # corners in order around the quad
        ("floor", [(0, 0, 0), (0, 0, d), (w, 0, d), (w, 0, 0)]),
        ("wall", [(0, h, 0), (w, h, 0), (w, h, d), (0, h, d)]),
        ("wall", [(0, 0, 0), (0, h, 0), (0, h, d), (0, 0, d)]),
        ("wall", [(w, 0, 0), (w, 0, d), (w, h, d), (w, h, 0)]),
        ("wall", [(0, 0, d), (0, h, d), (w, h, d), (w, 0, d)]),
        # The back wall around a window of 1 x 1 m.
        ("wall", [(0, 0, 0), (1.5, 0, 0), (1.5, h, 0), (0, h, 0)]),
        ("wall", [(2.5, 0, 0), (w, 0, 0), (w, h, 0), (2.5, h, 0)]),
        ("wall", [(1.5, 0, 0), (2.5, 0, 0), (2.5, 0.9, 0), (1.5, 0.9, 0)]),
        ("wall", [(1.5, 1.9, 0), (2.5, 1.9, 0), (2.5, h, 0), (1.5, h, 0)]),
        ("lamp", [(1.75, 2.45, 1.25), (2.25, 2.45, 1.25), (2.25, 2.45, 1.75), (1.75, 2.45, 1.75)]),
    ]
    radiance = lamp_w_m2 / 3.14159265  # a diffuse emitter's exitance is pi times its radiance
    materials = [
        {"name": "wall", "doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.68, 0.65, 1], "metallicFactor": 0}},
        {"name": "floor", "doubleSided": True, "pbrMetallicRoughness": {"baseColorFactor": [0.35, 0.25, 0.18, 1], "metallicFactor": 0}},
        {"name": "lamp", "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": radiance}}},
    ]
    names = {material["name"]: i for i, material in enumerate(materials)}
    buffer, views, accessors, primitives = struct.pack("<6H", 0, 1, 2, 0, 2, 3), [], [], []
    views.append({"buffer": 0, "byteOffset": 0, "byteLength": 12})
    accessors.append({"bufferView": 0, "componentType": 5123, "count": 6, "type": "SCALAR"})
    for name, corners in quads:
        views.append({"buffer": 0, "byteOffset": len(buffer), "byteLength": 48})
        buffer += b"".join(struct.pack("<3f", *corner) for corner in corners)
        low, high = ([pick(axis) for axis in zip(*corners, strict=True)] for pick in (min, max))
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": 4, "type": "VEC3", "min": low, "max": high})
        primitives.append({"attributes": {"POSITION": len(accessors) - 1}, "indices": 0, "material": names[name]})
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "extensionsUsed": ["KHR_materials_emissive_strength"],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [2.0, 1.4, 2.8]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.01}}],
        "materials": materials, "meshes": [{"primitives": primitives}], "bufferViews": views, "accessors": accessors,
        "buffers": [{"byteLength": len(buffer), "uri": "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()}],
    }  # fmt: skip


class FirstPicture(harness.CliTest):
    def median(self, name):
        _, rows = harness.read_png(self.folder / name)
        return statistics.median(max(pixel[:3]) for row in rows for pixel in row) / WHITE

    def test_a_room_with_a_lamp_is_lit(self):
        # Whatever the lamp's power: the exposure follows.
        for lamp in (12.0, 0.12, 1200.0):
            self.write("room.gltf", json.dumps(room_gltf(lamp)))
            said = self.run_ok("render", "room.gltf", "--size", "64x40", "-o", "room.png", "--overwrite").stderr
            self.assertTrue(0.1 < self.median("room.png") < 0.9, (lamp, self.median("room.png")))
            self.assertNotIn("dark", said)
            self.assertIn("exposure: ", said)

    def test_a_sweep_of_the_room_says_early_what_it_can_tell(self):
        self.write("room.gltf", json.dumps(room_gltf()))
        plan = ('{}[common]\nsize = "32x20"\nscreen-px = [32, 20]\nscreen-ppd = 8\nframes = "1"\n[[scene]]\nname = "room"\npath = "room.gltf"\n'
                '[[gaze]]\nname = "middle"\nat = [0.5, 0.5]\n[grid]\nspp = [1]\n{}[measure]\nrepeats = 2\nmetrics = ["fovvideovdp"]\nbaselines = ["none"]\n'
                'controls = false\nefficiency-spp = 0\nquality = ["fovvideovdp=9"]\n')
        self.write("plan.toml", plan.format("", "[reference]\nspp = 1\n"))
        refused = self.run_program("sweep", "plan.toml", "-o", "out")
        self.assertEqual(refused.returncode, 2, refused.stderr)
        *told, line = refused.stderr.splitlines()
        self.assertIn("its halves differ by fovvideovdp", told[-1])
        self.assertNotIn("round 1", refused.stderr)
        for words in ("plan.toml: ", "reference of room has 4 samples a pixel", "nothing better can be told", "levels are 9", "samples would do", "go-on = true"):
            self.assertIn(words, line)
        self.write("plan.toml", plan.format("", "[reference]\nspp = 1\ngo-on = true\n"))
        self.assertIn("round 2", self.run_ok("sweep", "plan.toml", "-o", "out").stderr)
        # As many samples as it takes, and no more than it may.
        for most in (100, 2048):
            self.write("plan.toml", plan.format("", f'[reference]\nspp = "auto"\nmost-spp = {most}\ngo-on = true\n'))
            self.run_ok("sweep", "plan.toml", "-o", f"auto-{most}", "--quiet")
            reference = json.loads((self.folder / f"auto-{most}/results.json").read_text())["scenes"][0]["reference"]
            self.assertTrue(64 < reference["spp"] <= most, reference)
            again = self.run_ok("sweep", "plan.toml", "-o", f"auto-{most}")
            self.assertNotIn("scrambling", again.stderr)
        self.write("plan.toml", plan.format('reference = "auto"\n', ""))
        dry = self.run_ok("sweep", "plan.toml", "--dry-run")
        self.assertIn("two repeats give no interval", dry.stderr)
        row = next(line.split() for line in dry.stdout.splitlines() if line.startswith("reference"))
        self.assertEqual(int(row[2]) * int(row[3]), 8192 * 32 * 20)

    def test_a_dark_picture_says_so(self):
        self.write("room.gltf", json.dumps(room_gltf(0.12)))
        for bits in ("8", "16"):
            said = self.run_ok("render", "room.gltf", "--size", "64x40", "--spp", "4", "--exposure", "0", "-o", "room.png", "--bits", bits,
                               "--overwrite").stderr
            for word in ("1 of 1 pictures is dark", "2 % of white", "--exposure", "--env"):
                self.assertIn(word, said)

    def test_one_exposure_for_a_sequence_however_it_is_cut(self):
        self.write("glide.gltf", json.dumps(harness.box_gltf(camera_seconds=0.5)))
        job = ["render", "glide.gltf", "--size", "32x18", "--fps", "24", "--accumulate", "off", "--overwrite"]
        exposures = set()
        for more in (["--spp", "1"], ["--spp", "1", "--frames", "7"], ["--spp", "2", "--chunk", "2/3", "--seed", "5"], ["--spp", "1", "--threads", "1"]):
            self.run_ok(*job, *more, "-o", "a/f.####.png", "--json", "a.json")
            rows = [line for path in (self.folder / "a").glob("*timing*.csv") for line in path.read_text().splitlines() if not line.startswith("#")]
            column = rows[0].split(",").index("exposure_ev")
            exposures |= {line.split(",")[column] for line in rows[1:]}
            shutil.rmtree(self.folder / "a")
        self.assertEqual(len(exposures), 1, exposures)
        self.run_ok(*job, "--spp", "1", "--exposure", "auto+1", "-o", "b/f.####.png")
        record = json.loads((self.folder / "b/f.run.json").read_text())
        stops = float(record["facts"]["exposure"].split()[0])
        self.assertAlmostEqual(stops, float(exposures.pop()) + 1, delta=0.011)

    def test_linear_pictures_do_not_depend_on_it(self):
        job = ["render", "box.gltf", "--size", "32x18", "--spp", "2", "--filter", "none"]
        for name, exposure in (("a", "auto"), ("b", "3")):
            self.run_ok(*job, "--exposure", exposure, "-o", f"{name}/f.exr")
        self.run_ok("compare", "a/f.exr", "b/f.exr", "--metrics", "mse", "--anyway", "--csv", "c.csv")
        lines = [line for line in (self.folder / "c.csv").read_text().splitlines() if not line.startswith("#")]
        row = dict(zip(lines[0].split(","), lines[1].split(","), strict=True))
        self.assertEqual((row["metric"], float(row["value"])), ("mse", 0), row)

    def test_the_environment_that_a_scene_names(self):
        scene = harness.box_gltf()
        scene["scenes"][0]["extras"] = {"gazetrace": {"environment": "light/sky.hdr"}}
        self.write("box.gltf", json.dumps(scene))
        shutil.copy(harness.SOURCE / "scenes/courtyard/dusk.hdr", self.write("light/sky.hdr", b""))
        job = ["render", "box.gltf", "--size", "16x9", "--spp", "1", "-o", "f.exr", "--overwrite"]
        self.assertIn("sky.hdr, which the scene names", self.run_ok(*job).stderr)
        record = json.loads((self.folder / "f.run.json").read_text())
        self.assertTrue(any(path.endswith("sky.hdr") for path in record["input_digests"]))
        self.assertIn("environment: none", self.run_ok(*job, "--env", "none").stderr)
        # As any file that a scene names, it lies in the scene's folder.
        scene["scenes"][0]["extras"]["gazetrace"]["environment"] = "../outside.hdr"
        self.write("box.gltf", json.dumps(scene))
        self.assert_refused(["render", "box.gltf", "--size", "16x9", "-o", "g.exr"], ["outside.hdr"])


if __name__ == "__main__":
    harness.main()
