# SPDX-License-Identifier: Apache-2.0
"""Layers beside the picture as arrays: against each other, against the cameras of the plan, and against the program's files."""

import gc
import sys
import unittest

import numpy as np

import gazetrace
from gazetrace import _core
from support import COURTYARD, ROOT, TestCase, needs_program, run_program

sys.path.append(str(ROOT / "tests/cli"))
from exr_reader import Exr  # noqa: E402  a reader of the tests' own

LIGHT = ["diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect", "emission", "background"]
CHANNELS = {**{name: "RGB" for name in (*LIGHT, "albedo")}, "normal": "XYZ", "position": "XYZ", "depth": "Z",
            "forward": "uv", "backward": "uv", "samples": "X", "variance": "X"}
MATTES = ["crypto_object", "crypto_material", "crypto_asset"]
OPTIONS = {"env": ROOT / "scenes/courtyard/dusk.hdr", "camera": "walk", "size": "64x36", "fps": "24", "sampling": "uniform",
           "spp": "2", "filter": "linear", "seed": "3", "exr_pixels": "float", "aov": ",".join([*CHANNELS, *MATTES])}


def frames_of(numbers, **options):
    return list(gazetrace.Job(scene=COURTYARD, frames=numbers, **{**OPTIONS, **options}).render())


def rotated_back(quaternion, vectors):
    """Vectors of the world along the axes of a camera with this orientation (x, y, z, w)."""
    axis, w = -np.array(quaternion[:3]), quaternion[3]
    crossed = 2 * np.cross(axis, vectors)
    return vectors + w * crossed + np.cross(axis, crossed)


def seen_from(camera, places, size):
    """Where a pinhole sees places of the world, in pixels from the top left, and how far along its axis they are."""
    height, width = size
    local = rotated_back(camera["orientation_xyzw"], places - np.array(camera["position_m"]))
    depth = -local[..., 2]
    focal_px = height / 2 / np.tan(np.radians(camera["yfov_deg"]) / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack([width / 2 + focal_px * local[..., 0] / depth, height / 2 - focal_px * local[..., 1] / depth], -1), depth


def filled_again(objects, numbers, size):
    """Outlines as numbers of pixels, by the even-odd rule along each row of pixels' middles."""
    filled = np.zeros((size[1], size[0]), int)
    for seen in objects:
        crossed = np.zeros((size[1], size[0] + 1), int)
        for ring in (ring for polygon in seen["polygons"] for ring in polygon):
            for (x, y), (to_x, to_y) in zip(ring, ring[1:] + ring[:1]):
                if x == to_x:
                    crossed[min(y, to_y):max(y, to_y), x] += 1
        filled[crossed.cumsum(1)[:, :-1] % 2 == 1] = numbers[seen["object"]]
    return filled


class LayersTest(TestCase):
    def test_every_layer_is_there_and_is_the_frame(self):
        (frame,) = frames_of("9")
        arrays = frame.aovs
        self.assertEqual(set(arrays), set(CHANNELS))
        for name, channels in CHANNELS.items():
            shape = (36, 64) if len(channels) == 1 else (36, 64, len(channels))
            self.assertEqual((arrays[name].shape, arrays[name].dtype), (shape, np.float32), name)
            self.assertIsInstance(arrays[name].base, _core.Frame, name)
        kept = arrays["position"]
        before = kept.copy()
        del frame, arrays
        gc.collect()
        np.testing.assert_array_equal(kept, before)

    def test_light_in_groups_adds_up_to_the_picture(self):
        (frame,) = frames_of("9")
        total = sum(frame.aovs[name].astype(np.float64) for name in LIGHT)
        np.testing.assert_allclose(total, frame.radiance, rtol=1e-4, atol=1e-7)
        for name in ("diffuse_direct", "specular_direct", "emission", "background"):
            self.assertGreater(frame.aovs[name].max(), 0, name)

    def test_motion_is_the_way_of_places_between_two_frames(self):
        one, two = frames_of("20,21", size="160x90", fps="10", spp="1")
        for frame, other, layer in ((one, two, "forward"), (two, one, "backward")):
            position, depth = frame.aovs["position"].astype(np.float64), frame.aovs["depth"]
            shown = (position != 0).any(-1)  # by the pixel's centre: samples beside it can hit where it does not
            self.assertGreater(shown.mean(), 0.5)
            self.assertGreater(np.mean(shown == np.isfinite(depth)), 0.95)
            size = depth.shape
            own, along = seen_from(frame.request["camera"], position, size)
            centres = np.stack(np.meshgrid(np.arange(size[1]), np.arange(size[0])), -1) + 0.5
            np.testing.assert_allclose(own[shown], centres[shown], atol=1e-3)
            self.assertLess(np.median(np.abs(along - depth)[shown] / along[shown]), 0.01)  # samples lie beside the centre
            then, _ = seen_from(other.request["camera"], position, size)
            way = (then - own) * (1, -1)  # up is positive
            self.assertGreater(np.abs(way[shown]).max(), 0.5)
            np.testing.assert_allclose(frame.aovs[layer][shown], way[shown], atol=2e-3)

    def test_mattes_share_the_pixels_out(self):
        (frame,) = frames_of("9")
        away = np.isinf(frame.aovs["depth"])
        for layer in MATTES:
            names = frame.matte_names(layer)
            self.assertEqual(len(set(names)), len(names))
            mattes = {name: frame.matte(layer, name) for name in names}
            total = sum(mattes.values())
            self.assertLessEqual(total.max(), 1 + 1e-6)
            self.assertGreater(np.mean(total[~away] == 1), 0.9, layer)
            self.assertGreater(sum(matte.max() > 0 for matte in mattes.values()), 5, layer)
        nothing = frame.matte("crypto_object", "no such thing")
        self.assertEqual((nothing.shape, nothing.max()), ((36, 64), 0))
        self.assertSays("crypto_light", "usage", frame.matte, "crypto_light", "lamp")

    def test_outlines_filled_again_are_the_mattes(self):
        """Each pixel is of the object that most of its first hits are on, but for some at borders, whose hits are on both sides: the shipped walk."""
        numbers, size = "1-40x3", (96, 54)
        outlines = gazetrace.Job(scene=COURTYARD, camera="walk", frames=numbers, size=size, fps=10).outlines()
        nodes = ["", *dict.fromkeys(one["node"] for one in outlines["objects"])]
        inside = wrong = at_border = wrong_there = 0
        for frame, outlined in zip(frames_of(numbers, size="96x54", fps="10", spp="1", accumulate="off", aov="crypto_object"), outlines["frames"], strict=True):
            filled = filled_again(outlined["objects"], [nodes.index(one["node"]) for one in outlines["objects"]], size)
            mattes = np.stack([frame.matte("crypto_object", node) for node in nodes])
            mattes[0] = 1 - mattes.sum(0)  # the environment
            around = np.lib.stride_tricks.sliding_window_view(filled, (3, 3)).reshape(size[1] - 2, size[0] - 2, 9)
            alone = (around == around[..., :1]).all(-1)
            differs = np.take_along_axis(mattes, filled[None], 0)[0, 1:-1, 1:-1] < 0.499
            inside, at_border = inside + alone.sum(), at_border + (~alone).sum()
            wrong, wrong_there = wrong + differs[alone].sum(), wrong_there + differs[~alone].sum()
        self.assertGreater(inside, 14 * 96 * 54 / 2)
        self.assertEqual(wrong, 0, f"of {inside} pixels whose neighbours are all of the same object")
        self.assertLess(wrong_there, at_border / 8)  # moved by a pixel, more than a quarter

    @needs_program
    def test_they_are_the_layers_of_the_program(self):
        flags = [text for name, value in OPTIONS.items() for text in (f"--{name.replace('_', '-')}", value)]
        run_program("render", COURTYARD, *flags, "--frames", "9", "--exr-compression", "none", "--quiet", "-o",
                    self.folder / "f.####.exr")
        exr = Exr(self.folder / "f.0009.exr")
        (frame,) = frames_of("9")
        for name, channels in CHANNELS.items():
            array = frame.aovs[name].reshape(36, 64, -1)
            for i, channel in enumerate(channels):
                key = f"{name}.{channel}"
                if exr.types[key] == 2:
                    written = np.array(exr.channel(key, bits=True), np.uint32)
                    np.testing.assert_array_equal(array[..., i].view(np.uint32), written, key)
                else:
                    np.testing.assert_array_equal(array[..., i].astype(np.float16), np.array(exr.channel(key), np.float16), key)
        for layer in MATTES:
            ranks = sorted({key.split(".")[0] for key in exr.types if key.startswith(layer)})
            written = sum(np.array(exr.channel(f"{rank}.{c}")) for rank in ranks for c in "GA")
            ours = sum(frame.matte(layer, name).astype(np.float64) for name in frame.matte_names(layer))
            np.testing.assert_allclose(ours, written, atol=1e-6)


if __name__ == "__main__":
    unittest.main()
