#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes examples/images/overview.jpg: uniform, foveated and sampling map of one frame.

    make_overview.py [GAZETRACE] [--frame N]

Runs 02-compare-one-frame.sh at 1280 x 720, reads the sampling map with oiiotool (package openimageio-tools), halves the
three pictures and puts them side by side with Pillow. Takes one or two minutes.
"""
import argparse
import csv
import glob
import json
import math
import os
import struct
import subprocess
import tempfile

from PIL import Image, ImageDraw, ImageFont

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COMPARE = os.path.join(ROOT, "out", "compare")
# Dark to light with the number of samples, evenly in its logarithm.
RAMP = ((13, 14, 28), (45, 40, 92), (110, 50, 120), (190, 70, 95), (240, 130, 60), (252, 215, 130))


def ramp_color(t):
    place = min(1.0, max(0.0, t)) * (len(RAMP) - 1)
    k = min(int(place), len(RAMP) - 2)
    return tuple(round(a + (b - a) * (place - k)) for a, b in zip(RAMP[k], RAMP[k + 1]))


def read_channel(path, channel):
    """A channel of an EXR as an 'F' picture, by way of a float TIFF."""
    with tempfile.TemporaryDirectory() as folder:
        tiff = os.path.join(folder, "channel.tif")
        subprocess.run(
            ["oiiotool", path, "--ch", channel, "-d", "float", "--compression", "none", "-o", tiff], check=True
        )
        with Image.open(tiff) as picture:
            return picture.convert("F").copy()


def pixels_of(picture):
    return struct.unpack(f"{picture.width * picture.height}f", picture.tobytes())


def map_picture(path):
    density = read_channel(path, "samples_per_pixel")
    values = pixels_of(density)
    low, high = min(v for v in values if v > 0) * 0.7, max(values)
    span = math.log(high / low)
    picture = Image.new("RGB", density.size)
    picture.putdata([ramp_color(math.log(max(v, low) / low) / span) for v in values])
    eccentricity = read_channel(path, "eccentricity")
    nearest = min(range(len(values)), key=pixels_of(eccentricity).__getitem__)
    return picture, (nearest % density.width + 0.5, nearest // density.width + 0.5)


def samples_in(folder):
    with open(glob.glob(os.path.join(COMPARE, folder, "timing*.csv"))[0], encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return sum(int(row["samples"]) for row in rows)


def mark_gaze(picture, at):
    """A thin ring about the gaze point."""
    draw = ImageDraw.Draw(picture)
    for radius, color in ((8.0, (0, 0, 0)), (7.0, (255, 255, 255))):
        box = [at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius]
        draw.ellipse(box, outline=color, width=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("gazetrace", nargs="?", default="")
    parser.add_argument("--frame", type=int, default=7)
    parser.add_argument("--out", default=os.path.join(ROOT, "examples", "images", "overview.jpg"))
    args = parser.parse_args()
    command = [os.path.join(ROOT, "examples", "02-compare-one-frame.sh")] + ([args.gazetrace] if args.gazetrace else [])
    subprocess.run(command, check=True, env={**os.environ, "FRAME": str(args.frame), "SIZE": "1280x720"})

    number = f"{args.frame:04d}"
    uniform, foveated = (
        Image.open(os.path.join(COMPARE, name, f"frame.{number}.png")).convert("RGB") for name in ("uniform", "foveated")
    )
    sampling, gaze = map_picture(os.path.join(COMPARE, "foveated", f"map.{number}.exr"))
    all_samples, few_samples = samples_in("uniform"), samples_in("foveated")
    pixels = uniform.width * uniform.height
    uniform, foveated, sampling = (picture.reduce(2) for picture in (uniform, foveated, sampling))
    for picture in (foveated, sampling):
        mark_gaze(picture, (gaze[0] / 2, gaze[1] / 2))
    labels = (
        f"uniform: {all_samples / pixels:.0f} samples a pixel",
        f"foveated: {few_samples / pixels:.2f} on average, {all_samples / few_samples:.0f} times fewer",
        "sampling map: 32 a pixel, 16 a 2 x 2 block, 8 a 4 x 4 block",
    )

    gap, strip = 6, 30
    width = 3 * uniform.width + 2 * gap
    sheet = Image.new("RGB", (width, uniform.height + strip), (255, 255, 255))
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(size=20)
    for k, (picture, label) in enumerate(zip((uniform, foveated, sampling), labels)):
        left = k * (uniform.width + gap)
        sheet.paste(picture, (left, 0))
        draw.text((left + uniform.width / 2, uniform.height + strip / 2), label, (30, 30, 30), font=font, anchor="mm")
    quality = 93
    while True:
        sheet.save(args.out, quality=quality, optimize=True, progressive=True)
        size = os.path.getsize(args.out)
        if size < 390 * 1024:
            break
        quality -= 4
    print(json.dumps({"picture": args.out, "bytes": size, "quality": quality, "labels": labels}, ensure_ascii=False))


if __name__ == "__main__":
    main()
