#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes docs/images/fovea.jpg: what the filter `guided` makes of a frame's own samples, about the gaze.

    make_fovea.py [GAZETRACE] [--frame N] [--out FILE]

Renders one frame of example.toml by itself, without a filter and through `guided`, and puts the surroundings of the gaze
side by side, twice as large. Takes a minute on two cores. Needs Pillow.
"""
import argparse
import os

from make_first import ROOT, WHITE, render, ring
from PIL import Image, ImageDraw


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("gazetrace", nargs="?", default=os.path.join(ROOT, "build", "release", "bin", "gazetrace"))
    parser.add_argument("--frame", type=int, default=8)
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "images", "fovea.jpg"))
    args = parser.parse_args()
    size, gap = (360, 240), 8
    sheet = Image.new("RGB", (4 * size[0] + gap, 2 * size[1]), WHITE)
    for side, filter_name in enumerate(("none", "guided")):
        alone = ["--accumulate", "off", "--spp", "2", "--filter", filter_name]
        picture, row = render(args.gazetrace, args.frame, filter_name, alone)
        gaze = (float(row["gaze.u"]) * picture.width, float(row["gaze.v"]) * picture.height)
        left, top = (min(max(0, round(at - part / 2)), whole - part) for at, part, whole in zip(gaze, size, picture.size, strict=True))
        part = picture.crop((left, top, left + size[0], top + size[1])).resize((2 * size[0], 2 * size[1]), Image.Resampling.NEAREST)
        ring(ImageDraw.Draw(part), (2 * (gaze[0] - left), 2 * (gaze[1] - top)), 28)
        sheet.paste(part, (side * (2 * size[0] + gap), 0))
    sheet.save(args.out, quality=88, optimize=True, progressive=True)


if __name__ == "__main__":
    main()
