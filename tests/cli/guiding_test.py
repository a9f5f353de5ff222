# SPDX-License-Identifier: Apache-2.0
"""Learned light: frames that trains from paths of their own have the same bits alone, in parts and with any threads."""

import csv
import json

import harness


def hall_gltf():
    """The box and its floor in a hall that is open on one side, through which a part of the sky is seen; a camera that glides."""
    gltf = harness.box_gltf(camera_seconds=1.0)
    nodes = gltf["nodes"]
    for translation, scale in (([0, 3, 0], [4, 0.1, 4]), ([-3, 1, 0], [0.1, 3, 4]), ([0, 1, -3], [4, 3, 0.1]), ([0, 1, 5], [4, 3, 0.1])):
        gltf["scenes"][0]["nodes"].append(len(nodes))
        nodes.append({"mesh": 0, "translation": translation, "scale": scale})
    gltf["scenes"][0]["nodes"].remove(3)  # the lamp
    return gltf


# So large that paths follow what the first 4096 have found.
JOB = ["hall.gltf", "--size", "240x160", "--fps", "24", "--quiet", "--exposure", "0"]
GAZE = ["--gaze-at", "0.4,0.5", "--screen-px", "240,160", "--screen-ppd", "8"]


class GuidingField(harness.CliTest):
    def setUp(self):
        super().setUp()
        self.write("hall.gltf", json.dumps(hall_gltf()))

    def render(self, folder, *more, frames="1-3", training=()):
        self.run_ok("render", *JOB, "--frames", frames, *training, *more, "-o", f"{folder}/f.####.exr")
        return self.pictures(folder)

    def rows(self, folder):
        with open(self.folder / folder / "f.timing.csv", newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_the_same_bits_however_it_is_rendered(self):
        for name, settings in (("foveated", GAZE), ("visible", [*GAZE, "--sampling", "adaptive", "--spp", "2"]),
                               ("around", ["--sampling", "uniform", "--spp", "1", "--accumulate", "window", "--accumulate-past", "0.05s", "--accumulate-future", "0.05s"])):
            with self.subTest(settings=name):
                whole = self.render(f"{name}", *settings, "--threads", "1")
                self.assertEqual(len(whole), 3)
                self.assertEqual(self.render(f"{name}-threads", *settings, "--threads", "2"), whole)
                alone = self.render(f"{name}-alone", *settings, frames="2")
                self.assertEqual(alone, {key: value for key, value in whole.items() if "0002" in key})
                folder = self.folder / name
                (folder / "f.0003.exr").unlink()
                self.assertEqual(self.render(name, *settings, "--resume"), whole)

    def test_it_changes_pictures_and_is_counted(self):
        raw = ["--sampling", "uniform", "--spp", "2", "--filter", "none", "--accumulate", "off"]
        guided = self.render("guided", *raw)
        plain = self.render("plain", *raw, training=("--no-guiding",))
        self.assertTrue(all(guided[key] != plain[key] for key in plain))
        for row in self.rows("guided"):
            self.assertGreater(int(row["training_paths"]), 4096 + 500)
            self.assertEqual(int(row["samples"]), 2 * 240 * 160)  # what is discarded is no sample
            self.assertGreater(float(row["guiding_ms"]), 0)
        self.assertEqual({row["training_paths"] for row in self.rows("plain")}, {"0"})


if __name__ == "__main__":
    harness.main()
