#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Are adaptive frames unbiased before reconstruction, after they decided where to sample and when to stop?

  adaptive_mean.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--frames 512] [--size 96x54] [--ppd 12]
                   [--uniform-spp 16] [--margin 0.5] [--adaptive "--sampling adaptive --target-relmse 0.02"]

OPTIONS are those of `gazetrace render`. Frames of a view at rest are independent: their scramblings follow from seed and frame. The
mean over all adaptive frames is compared with that over as many uniform ones, each without a filter, in every band of
eccentricity (gaze in the middle) and in every tenth of the pixels by their variance, which is that of uniform frames of
another seed: the compared frames would class themselves. Equivalence (two one-sided tests): the 99 % interval of the
difference, Student's by Welch, its level divided by the number of tests (Holm 1979), lies within +-margin % of the mean of the band.
It needs the Python packages numpy, scipy and OpenEXR.
"""

import argparse
import math
import pathlib
import shlex
import shutil
import subprocess
import sys

import numpy
import OpenEXR
from scipy import stats

BAND_ENDS_DEG = (1, 2, 3, 4)
LEVEL = 0.005


def luminances(folder, frames):
    """(frame, row, column)"""
    def of(path):
        with OpenEXR.File(str(path), separate_channels=True) as file:
            red, green, blue = (file.channels()[c].pixels.astype(numpy.float64) for c in "RGB")
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return numpy.stack([of(folder / f"f.{frame:04d}.exr") for frame in range(1, frames + 1)])


class Bench:
    def __init__(self, asked):
        self.asked = asked
        width, height = (int(n) for n in asked.size.split("x"))
        x, y = numpy.meshgrid(numpy.arange(width) + 0.5 - width / 2, numpy.arange(height) + 0.5 - height / 2)
        eccentricity = numpy.degrees(numpy.arctan(numpy.hypot(x, y) * math.tan(math.radians(1 / asked.ppd))))
        self.band = numpy.searchsorted(BAND_ENDS_DEG, eccentricity)
        self.screen = ["--size", asked.size, "--screen-px", f"{width},{height}", "--screen-ppd", str(asked.ppd), "--gaze-at", "0.5,0.5"]

    def frames(self, name, what, scene, seed, *options):
        folder = pathlib.Path(self.asked.out) / name / what
        if not (folder / "done").exists():
            shutil.rmtree(folder, ignore_errors=True)
            subprocess.run([self.asked.program, "render", *scene, *self.screen, "--frames", f"1-{self.asked.frames}", "--filter", "none",
                            "--exr-pixels", "float", "--quiet", "--seed", str(seed), *options, "-o", folder / "f.####.exr"], check=True)
            (folder / "done").touch()
        return luminances(folder, self.asked.frames)

    def classes(self, of_class):
        for band in range(len(BAND_ENDS_DEG) + 1):
            yield f"band {band}", self.band == band
        variance = of_class.var(axis=0)
        tenth = numpy.argsort(numpy.argsort(variance, axis=None)).reshape(variance.shape) * 10 // variance.size
        for k in range(10):
            yield f"tenth {k}", tenth == k

    def compare(self, name, scene):
        uniform = ["--sampling", "uniform", "--no-guiding", "--spp", str(self.asked.uniform_spp)]
        plain = self.frames(name, "uniform", scene, 1, *uniform)
        adaptive = self.frames(name, "adaptive", scene, 3, *shlex.split(self.asked.adaptive))
        of_class = self.frames(name, "classes", scene, 2, *uniform)
        for label, pixels in self.classes(of_class):
            if not pixels.any():
                continue
            a = adaptive[:, pixels].mean(axis=1)
            u = plain[:, pixels].mean(axis=1)
            if not u.mean() > 0:
                continue
            parts = (a.var(ddof=1) / a.size, u.var(ddof=1) / u.size)
            error = math.sqrt(sum(parts)) / u.mean()
            if error == 0:  # pixels of a light that is everywhere the same
                equal = a.mean() == u.mean()
                yield {"name": name, "label": label, "difference": a.mean() / u.mean() - 1, "half": 0, "p": 0 if equal else 1}
                continue
            freedom = sum(parts)**2 / sum(part**2 / (len(a) - 1) for part in parts)
            difference = a.mean() / u.mean() - 1
            p = stats.t.sf((self.asked.margin / 100 - abs(difference)) / error, freedom)
            yield {"name": name, "label": label, "difference": difference, "half": stats.t.isf(LEVEL, freedom) * error, "p": p}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--frames", type=int, default=512)
    parser.add_argument("--size", default="96x54")
    parser.add_argument("--ppd", type=float, default=12)
    parser.add_argument("--uniform-spp", type=int, default=16)
    parser.add_argument("--margin", type=float, default=0.5)
    parser.add_argument("--adaptive", default="--sampling adaptive --target-relmse 0.02")
    asked = parser.parse_args()
    bench = Bench(asked)
    rows = [row for text in asked.scene for row in bench.compare(*(lambda words: (words[0], words[1:]))(shlex.split(text)))]
    passed = True
    for rank, row in enumerate(sorted(rows, key=lambda row: row["p"])):
        passed = passed and row["p"] <= LEVEL / (len(rows) - rank)
        row["equivalent"] = passed
    print("| scene | pixels | difference | half of the 99 % interval | within the margin |\n| --- | --- | --- | --- | --- |")
    for row in rows:
        print(f"| {row['name']} | {row['label']} | {100 * row['difference']:+.3f} % | {100 * row['half']:.3f} % | "
              f"{'yes' if row['equivalent'] else 'not decided'} |")
    outside = sum(abs(row["difference"]) > row["half"] for row in rows)
    print(f"{sum(row['equivalent'] for row in rows)} of {len(rows)} equivalent within {asked.margin} %, largest difference "
          f"{100 * max(abs(row['difference']) for row in rows):.3f} %; {outside} intervals leave out 0")


if __name__ == "__main__":
    sys.exit(main())
