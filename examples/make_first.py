#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes examples/images/first.jpg, the picture of the README: one frame as it is traced, and as it is shown.

    make_first.py [GAZETRACE] [--frame N] [--out FILE]

Renders one frame of example.toml twice with the same number of samples, once as it stands and once uniformly, without
filter and without the frames around it, and puts both side by side with Pillow: a ring about the gaze, and below each
picture the place that the eye looks at and one in the periphery, three times as large. Takes a minute on two cores.
"""
import argparse
import csv
import os
import subprocess

from PIL import Image, ImageDraw, ImageFont

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDER = os.path.join(ROOT, "out", "first-picture")
INK, WHITE, BLACK = (30, 30, 30), (255, 255, 255), (0, 0, 0)
ALONE = ["--sampling", "uniform", "--spp", "2", "--accumulate", "off", "--filter", "none"]


def render(gazetrace, frame, name, more):
    pattern = os.path.join(FOLDER, f"{name}.####.png")
    config = os.path.join(ROOT, "examples", "example.toml")
    subprocess.run([gazetrace, "render", "--config", config, "--frames", str(frame), "-o", pattern, "--overwrite", "--quiet", *more], check=True)
    with open(os.path.join(FOLDER, f"{name}.timing.csv"), encoding="utf-8") as file:
        row = next(csv.DictReader(line for line in file if not line.startswith("#")))
    return Image.open(pattern.replace("####", f"{frame:04d}")).convert("RGB"), row


def ring(draw, at, radius):
    """A ring with a dark rim, which leaves what it is about to be seen."""
    for grow, color in ((1, BLACK), (0, WHITE), (-1, WHITE), (-2, BLACK)):
        box = [at[0] - radius - grow, at[1] - radius - grow, at[0] + radius + grow, at[1] + radius + grow]
        draw.ellipse(box, outline=color, width=1)


def inset(picture, at, size):
    """The surroundings of a place, three times as large, and where they lie."""
    width, height = size[0] // 3, size[1] // 3
    left = min(max(0, round(at[0] - width / 2)), picture.width - width)
    top = min(max(0, round(at[1] - height / 2)), picture.height - height)
    return picture.crop((left, top, left + width, top + height)).resize(size, Image.Resampling.NEAREST), (left, top, left + width, top + height)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("gazetrace", nargs="?", default=os.path.join(ROOT, "build", "release", "bin", "gazetrace"))
    parser.add_argument("--frame", type=int, default=8)
    parser.add_argument("--periphery", default="800,300", help="X,Y of the place in the periphery, in pixels")
    parser.add_argument("--out", default=os.path.join(ROOT, "examples", "images", "first.jpg"))
    args = parser.parse_args()
    alone, _ = render(args.gazetrace, args.frame, "alone", ALONE)
    joined, row = render(args.gazetrace, args.frame, "joined", [])
    gaze = (float(row["gaze.u"]) * joined.width, float(row["gaze.v"]) * joined.height)
    places = (gaze, tuple(float(number) for number in args.periphery.split(",")))
    font, small, gap, strip = ImageFont.load_default(size=26), ImageFont.load_default(size=20), 8, 44
    size = ((alone.width - gap) // 2, 210)
    sheet = Image.new("RGB", (2 * alone.width + gap, alone.height + gap + size[1] + 2 * strip), WHITE)
    draw = ImageDraw.Draw(sheet)
    labels = ("two samples a pixel, as they are traced", "the default: as many samples, with those of the frames around, denoised")
    for side, (picture, label) in enumerate(((alone, labels[0]), (joined, labels[1]))):
        x = side * (alone.width + gap)
        draw.text((x + alone.width / 2, strip / 2), label, INK, font=font, anchor="mm")
        marked = picture.copy()
        pen = ImageDraw.Draw(marked)
        for k, place in enumerate(places):
            enlarged, box = inset(picture, place, size)
            pen.rectangle(box, outline=WHITE)
            left = x + k * (size[0] + gap)
            sheet.paste(enlarged, (left, strip + alone.height + gap))
            words = ("where the eye looks (ring), 3 x", "in the periphery, 3 x")[k]
            draw.text((left + size[0] / 2, sheet.height - strip / 2), words, INK, font=small, anchor="mm")
        ring(pen, gaze, 14)
        sheet.paste(marked, (x, strip))
    quality = 90
    while sheet.save(args.out, quality=quality, optimize=True, progressive=True) or os.path.getsize(args.out) > 390 * 1024:
        quality -= 4
    print(args.out, os.path.getsize(args.out), "bytes")


if __name__ == "__main__":
    main()
