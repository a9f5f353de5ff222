#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""FLIP and FovVideoVDP beside their authors' programs (Python packages flip-evaluator and pyfvvdp, with a PyTorch for the CPU).

    metrics_against_authors.py GAZETRACE [--pairs N] [--time]

Makes pairs of pictures, scores each with `gazetrace compare` and with those of the two programs that can be imported,
and prints the worst differences by what was done to them. --time scores one 3840 x 2160 pair as well and prints seconds
of three rounds, with reading and the start of the program on our side and not on theirs. Needs numpy.
"""

import argparse
import json
import math
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

import numpy as np

try:
    import flip_evaluator
except ImportError:
    flip_evaluator = None
try:
    import pyfvvdp
    import torch
except ImportError:
    pyfvvdp = None

FOV_DEG = 40
DISTANCE_CM = 60.0
KINDS = ("noise", "blur", "blocks of 4 pixels", "colour cast", "specks")


def blurred(picture, radius):
    kernel = np.ones(2 * radius + 1) / (2 * radius + 1)
    for axis in (0, 1):
        picture = np.apply_along_axis(lambda line: np.convolve(np.pad(line, radius, "edge"), kernel, "valid"), axis, picture)
    return picture


def scene(random, width, height):
    """Soft colour gradients, hard-edged discs and fine texture, 0..1."""
    y, x = np.mgrid[0:height, 0:width]
    picture = np.stack([0.5 + 0.4 * np.sin(x / width * random.uniform(2, 9) + y / height * random.uniform(2, 9) + c)
                        for c in random.uniform(0, 6, 3)], axis=-1)
    for _ in range(12):
        centre, radius = random.uniform(0, 1, 2) * (width, height), random.uniform(0.03, 0.2) * height
        picture[np.hypot(x - centre[0], y - centre[1]) < radius] = random.uniform(0, 1, 3)
    picture *= 1 + 0.15 * np.sin(x * random.uniform(0.3, 2.5))[..., None]
    return np.clip(picture, 0, 1)


def spoiled(random, picture, kind):
    height, width = picture.shape[:2]
    if kind == 0:
        return picture + random.normal(0, 0.08, picture.shape)
    if kind == 1:
        return blurred(picture, 2)
    if kind == 2:
        small = picture[: height // 4 * 4, : width // 4 * 4].reshape(height // 4, 4, width // 4, 4, 3).mean((1, 3))
        result = picture.copy()
        result[: height // 4 * 4, : width // 4 * 4] = small.repeat(4, 0).repeat(4, 1)
        return result
    if kind == 3:
        return picture * random.uniform(0.8, 1.2, 3)
    return np.where(random.uniform(0, 1, (height, width, 1)) < 0.01, 1.0, picture)


def png(codes):
    height, width = codes.shape[:2]
    rows = np.zeros((height, 1 + 3 * width), np.uint8)
    rows[:, 1:] = codes.reshape(height, -1)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 1)) + chunk(b"IEND", b"")


def write_pair(folder, random, width, height, kind):
    reference = scene(random, width, height)
    codes = []
    for name, picture in (("ref", reference), ("test", spoiled(random, reference, kind))):
        codes.append((np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8))
        (folder / f"{name}.png").write_bytes(png(codes[-1]))
    return codes


def screen_cm(width, height):
    width_cm = 2 * DISTANCE_CM * math.tan(math.radians(FOV_DEG / 2))
    return width_cm, width_cm * height / width


def ours(program, folder, width, height, metric):
    size = screen_cm(width, height)
    start = time.perf_counter()
    subprocess.run([program, "compare", folder / "ref.png", folder / "test.png", "--metrics", metric, "--json", folder / "out.json", "--overwrite",
                    "--screen-px", f"{width},{height}", "--screen-cm", f"{size[0]!r},{size[1]!r}",
                    "--screen-distance-cm", str(DISTANCE_CM), "--gaze-at", f"{(width // 2 + 0.5) / width!r},{(height // 2 + 0.5) / height!r}",
                    "--threads", "2"], check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - start
    result = json.loads((folder / "out.json").read_text())
    return result["sequence"][0]["scores"][0]["value"], seconds, float(result["conditions"]["ppd"].split()[0])


def their_flip(reference, test, ppd):
    start = time.perf_counter()
    _, mean, _ = flip_evaluator.evaluate(reference.astype(np.float32) / 255, test.astype(np.float32) / 255, "LDR",
                                         inputsRGB=True, applyMagma=False, parameters={"ppd": ppd})
    return float(mean), time.perf_counter() - start


def their_jod(reference, test):
    height, width = reference.shape[:2]
    geometry = pyfvvdp.fvvdp_display_geometry((width, height), distance_m=DISTANCE_CM / 100, fov_horizontal=FOV_DEG)
    metric = pyfvvdp.fvvdp(display_geometry=geometry, display_name="standard_4k", foveated=True, heatmap=None,
                           device=torch.device("cpu"))
    start = time.perf_counter()
    jod, _ = metric.predict(test, reference, dim_order="HWC")
    return float(jod), time.perf_counter() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--time", action="store_true")
    arguments = parser.parse_args()
    if flip_evaluator is None and pyfvvdp is None:
        sys.exit("neither flip_evaluator nor pyfvvdp can be imported")
    random = np.random.default_rng(20)
    worst = {}
    sizes = [(256, 256), (320, 180), (97, 64), (201, 133)]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for pair in range(arguments.pairs):
            width, height = sizes[pair % 4]
            kind = pair % 5
            pictures = write_pair(folder, random, width, height, kind)
            differences = {}
            if flip_evaluator is not None:
                value, _, ppd = ours(arguments.program, folder, width, height, "flip")
                differences["flip"] = abs(value - their_flip(*pictures, ppd)[0])
            if pyfvvdp is not None:
                value, _, _ = ours(arguments.program, folder, width, height, "fovvideovdp")
                differences["fovvideovdp"] = abs(value - their_jod(*pictures)[0])
            for metric, difference in differences.items():
                for row in (KINDS[kind], "all"):
                    worst[row, metric] = max(worst.get((row, metric), 0), difference)
        metrics = sorted({metric for _, metric in worst})
        print(f"{'worst difference':<24}" + "".join(f"{metric:>14}" for metric in metrics))
        for row in (*KINDS, "all"):
            print(f"{row:<24}" + "".join(f"{worst.get((row, metric), math.nan):>14.2g}" for metric in metrics))
        if arguments.time:
            width, height = 3840, 2160
            pictures = write_pair(folder, random, width, height, 0)
            for _ in range(3):
                if flip_evaluator is not None:
                    _, seconds, ppd = ours(arguments.program, folder, width, height, "flip")
                    print(f"flip         3840x2160: ours {seconds:.2f} s, flip-evaluator {their_flip(*pictures, ppd)[1]:.2f} s")
                if pyfvvdp is not None:
                    _, seconds, _ = ours(arguments.program, folder, width, height, "fovvideovdp")
                    print(f"fovvideovdp  3840x2160: ours {seconds:.2f} s, pyfvvdp {their_jod(*pictures)[1]:.2f} s")


if __name__ == "__main__":
    main()
