#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is the mean of renders with different seeds as good, for a sample, as one long render?

  mean_of_seeds.py GAZETRACE OUT_FOLDER [--splits 16x4,4x16,4x64,4x256] [--seeds 16] [--size 160x90]
                   [--scene "FILE OPTIONS"]

A split KxN takes K renders of N samples a pixel, joins them by `gazetrace merge --mean`, and holds the mean against one
render of K x N samples. Both estimate the same light, so that the variance over `--seeds` repetitions is their error; it
is divided by the square of the light (plus 0.01) and averaged over the pixels but for the 0.5 % with the largest. Frames
of a view at rest are repetitions, since seed and frame together choose the samples. A line is a split and the error of
the mean over that of the long render, with its 95 % interval (two sided, by the spread of the repetitions). Renders that
OUT_FOLDER holds already are used again. It needs the Python packages numpy and OpenEXR.
"""

import argparse
import math
import pathlib
import shlex
import subprocess

import numpy
import OpenEXR

STUDENT_30 = 2.042  # two-sided 95 % point for 2 x (16 - 1) degrees of freedom
COURTYARD = "scenes/courtyard/courtyard.gltf --env scenes/courtyard/dusk.hdr --camera still"


def luminance(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        red, green, blue = (file.channels()[c].pixels.astype(numpy.float64) for c in "RGB")
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


class Bench:
    def __init__(self, asked):
        self.asked = asked
        self.out = pathlib.Path(asked.out)

    def run(self, folder, *arguments):
        if not (folder / "done").exists():
            subprocess.run([self.asked.program, *map(str, arguments), "-o", folder / "f.####.exr", "--overwrite"], check=True,
                           stdout=subprocess.DEVNULL)
            (folder / "done").touch()
        return numpy.stack([luminance(folder / f"f.{k:04d}.exr") for k in range(1, self.asked.seeds + 1)])

    def render(self, samples, seed):
        return self.run(self.out / f"{samples}-{seed}", "render", *shlex.split(self.asked.scene), "--sampling", "uniform",
                        "--filter", "none", "--exr-pixels", "float", "--size", self.asked.size, "--exposure", "0", "--fps", "24",
                        "--frames", f"1-{self.asked.seeds}", "--quiet", "--spp", samples, "--seed", seed)

    def split(self, count, samples):
        for seed in range(1, count + 1):
            self.render(samples, seed)
        parts = [self.out / f"{samples}-{seed}/f.####.exr" for seed in range(1, count + 1)]
        mean = self.run(self.out / f"mean-{count}x{samples}", "merge", "--mean", *parts)
        long = self.render(count * samples, 1000)
        light = (mean.mean(axis=0) + long.mean(axis=0)) / 2
        scale = 1 / (light ** 2 + 0.01)
        spread = (mean.var(axis=0) + long.var(axis=0)) * scale
        kept = spread <= numpy.quantile(spread, 0.995)
        errors = [(((frames - frames.mean(axis=0)) ** 2 * scale)[:, kept]).mean(axis=1) for frames in (mean, long)]
        ratio = errors[0].mean() / errors[1].mean()
        relative = math.hypot(*(e.std(ddof=1) / math.sqrt(e.size) / e.mean() for e in errors))
        print(f"| {count} x {samples} | {ratio:.3f} +- {STUDENT_30 * relative * ratio:.3f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--splits", default="16x4,4x16,4x64,4x256")
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--size", default="160x90")
    parser.add_argument("--scene", default=COURTYARD)
    bench = Bench(parser.parse_args())
    print("| renders x samples | error of the mean / of one long render |\n| --- | --- |")
    for split in bench.asked.splits.split(","):
        bench.split(*(int(n) for n in split.split("x")))


if __name__ == "__main__":
    main()
