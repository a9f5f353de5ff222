#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do gazetrace and Mitsuba 3 compute the same light? Window means of independent renders, tested at one family-wise level.

  compare_with_mitsuba.py --gazetrace build/release/bin/gazetrace --sponza Sponza.gltf --env FILE.hdr

Each scene is rendered with several seeds by both. A picture is cut into windows of 32 x 32 pixels; per window and channel
Welch's t over the seeds asks whether the means differ. Where the models coincide, no window may be significant at the
family-wise level of 1e-3 (Holm) over all its windows; a scene whose models differ shows by how much instead.

Prints per scene: the ratio of the whole pictures' means with its standard error, windows tested, the smallest Holm-adjusted
p, the largest difference of a window relative to the picture's mean, and the verdict. Exit code 1 if a scene of coinciding
models differs.
"""

import argparse
import math
import pathlib
import sys
import tempfile
import types

import numpy as np
import scipy.stats

import matched_scenes
from peers import read_picture, run

LEVEL = 1e-3
WINDOW = 32


def windows(picture):
    height, width = (n // WINDOW * WINDOW for n in picture.shape[:2])
    cut = picture[:height, :width].reshape(height // WINDOW, WINDOW, width // WINDOW, WINDOW, 3)
    return cut.mean((1, 3)).reshape(-1)


def compare(ours, theirs):
    """Arrays (seed, window). Smallest Holm-adjusted p, number of windows with light."""
    lit = (ours.std(0) + theirs.std(0) > 0) | (ours.mean(0) != theirs.mean(0))
    p = scipy.stats.ttest_ind(ours[:, lit], theirs[:, lit], equal_var=False).pvalue
    order = np.sort(p)
    return float(np.min(order * np.arange(len(order), 0, -1))), len(order)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--gazetrace", default="build/release/bin/gazetrace")
    parser.add_argument("--mitsuba-python", default=sys.executable)
    parser.add_argument("--sponza")
    parser.add_argument("--env", help="lat-long picture")
    parser.add_argument("--size", default="256x256")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--bounces", type=int, default=4)
    parser.add_argument("--only", help="names of scenes, comma separated")
    parser.add_argument("--keep", help="folder for the mean pictures, as .npy")
    arguments = parser.parse_args()

    failed = False
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        scenes = [("cornell", "matte", True, matched_scenes.cornell(folder)),
                  ("punctual", "matte", True, matched_scenes.punctual(folder))]
        if arguments.sponza and arguments.env:
            view = ["--eye=8,2,-0.3", "--target=-8,3,-0.3", "--yfov=50", f"--env={arguments.env}"]
            scenes.append(("sponza", "matte", True, (arguments.sponza, view)))
        if arguments.env:
            scenes.append(("conductors", "principled", False, matched_scenes.balls(folder, arguments.env, 1)))
            scenes.append(("dielectrics", "principled", False, matched_scenes.balls(folder, arguments.env, 0)))
        print(f"{arguments.size}, {arguments.spp} spp, {arguments.seeds} seeds, {arguments.bounces} bounces")
        print(f"{'scene':14}{'models':>10}{'ratio':>9}{'+-':>8}{'windows':>9}{'least p':>10}{'largest':>9}  verdict")
        for label, materials, coincide, (path, view) in scenes:
            if arguments.only and label not in arguments.only.split(","):
                continue
            options = types.SimpleNamespace(gazetrace=arguments.gazetrace, mitsuba_python=arguments.mitsuba_python,
                                            materials=materials, bounces=arguments.bounces)
            pictures = {}
            for program in ("gazetrace", "mitsuba-llvm"):
                pictures[program] = np.stack([
                    read_picture(run(program, options, path, folder, arguments.size, arguments.spp, 100 + s, view)[1])
                    for s in range(arguments.seeds)])
            ours, theirs = pictures["gazetrace"], pictures["mitsuba-llvm"]
            a, b = ours.mean((1, 2, 3)), theirs.mean((1, 2, 3))
            ratio = a.mean() / b.mean()
            error = ratio * math.hypot(a.std(ddof=1) / a.mean(), b.std(ddof=1) / b.mean()) / math.sqrt(len(a))
            ours_w, theirs_w = np.stack([windows(x) for x in ours]), np.stack([windows(x) for x in theirs])
            p, count = compare(ours_w, theirs_w)
            largest = np.max(np.abs(ours_w.mean(0) - theirs_w.mean(0))) / b.mean()
            differs = p < LEVEL
            failed |= coincide and differs
            verdict = "differ" if differs else "no difference found"
            print(f"{label:14}{materials:>10}{ratio:9.5f}{error:8.5f}{count:9d}{p:10.2g}{largest:9.4f}  {verdict}", flush=True)
            if arguments.keep:
                for program in pictures:
                    np.save(pathlib.Path(arguments.keep) / f"{label}_{program}.npy", pictures[program].mean(0))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
