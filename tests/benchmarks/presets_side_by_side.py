#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One view under several presets on one sheet, to be looked at: the whole frame, and cut-outs enlarged.

  presets_side_by_side.py GAZETRACE SCENE OUT.png --exposure EV --gaze U,V --crop NAME=U,V [--crop ...]
                          [--reference-spp 512] [--size 960x540] [options of `gazetrace render` ...]

Columns: uniform (as many samples in all as `paper` takes), `paper`, `default`, `reference`.
All are shown at one exposure through one view. Cut-outs are 1/8 of the frame wide about their place and enlarged without
smoothing; the first line under a column says how many samples a pixel it took. Needs Pillow.
"""

import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile

from PIL import Image, ImageDraw

FRAME_WIDTH, LABEL, CROP = 480, 16, 8


def render(arguments, extra, folder, name, options):
    out = folder / name.replace(" ", "-")
    done = subprocess.run(
        [arguments.program, "render", arguments.scene, "--size", arguments.size, "--screen", "paper", "--gaze-at", arguments.gaze,
         "--exposure", arguments.exposure, "--view", arguments.view, "--frames", "1", "--seed", "1", "--quiet",
         "-o", out / "f.png", *options, *extra], stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    with open(out / "f.timing.csv", newline="") as file:
        samples = float(next(csv.DictReader(file))["samples"])
    picture = Image.open(out / "f.png").convert("RGB")
    return picture, samples / (picture.width * picture.height)


def cut_out(picture, place):
    width, height = picture.width // CROP, picture.height // CROP
    left = min(max(round(place[0] * picture.width - width / 2), 0), picture.width - width)
    top = min(max(round(place[1] * picture.height - height / 2), 0), picture.height - height)
    size = (FRAME_WIDTH, FRAME_WIDTH * height // width)
    return picture.crop((left, top, left + width, top + height)).resize(size, Image.NEAREST)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("output")
    parser.add_argument("--exposure", required=True)
    parser.add_argument("--view", default="Reinhard")
    parser.add_argument("--gaze", default="0.5,0.5")
    parser.add_argument("--crop", action="append", default=[])
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--reference-spp", default="512")
    arguments, extra = parser.parse_known_args()
    crops = [(name, tuple(map(float, place.split(",")))) for name, place in (c.split("=") for c in arguments.crop)]

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        columns = [("paper", *render(arguments, extra, folder, "paper", ["--preset", "paper"]))]
        budget = str(columns[0][2])
        columns.insert(0, ("uniform", *render(arguments, extra, folder, "uniform",
                                              ["--sampling", "uniform", "--spp", budget, "--filter", "none", "--no-guiding"])))
        for label, options in (("default", ["--preset", "default"]),
                               ("reference", ["--preset", "reference", "--spp", arguments.reference_spp])):
            columns.append((label, *render(arguments, extra, folder, label, options)))

    height = FRAME_WIDTH * columns[0][1].height // columns[0][1].width
    sheet = Image.new("RGB", (len(columns) * FRAME_WIDTH, (1 + len(crops)) * (height + LABEL)), "white")
    draw = ImageDraw.Draw(sheet)
    for i, (label, picture, spp) in enumerate(columns):
        x = i * FRAME_WIDTH
        draw.text((x + 4, 2), f"{label}: {spp:.3g} samples a pixel", fill="black")
        sheet.paste(picture.resize((FRAME_WIDTH, height), Image.LANCZOS), (x, LABEL))
        for row, (crop, place) in enumerate(crops, 1):
            y = row * (height + LABEL)
            draw.text((x + 4, y + 2), crop, fill="black")
            sheet.paste(cut_out(picture, place), (x, y + LABEL))
    sheet.save(arguments.output)


if __name__ == "__main__":
    main()
