#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the sample pattern `z-order` is worth beside `scrambled`: the same views, samples and filters, scored alike.

  sample_pattern.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--size 480x270] [--spp 0.25,1,4]
                    [--filters none,linear,guided] [--frames 6] [--reference-spp 1024] [--ppd 12,28]

OPTIONS are those of `gazetrace render`. Frames are uniform, the camera is at rest and the gaze in the middle; every frame
has samples of its own and stands for a seed. JOD is that of single frames, and last that of all of them as a clip of 24
frames a second, at each resolution in pixels a degree. Beside the two patterns stands what `z-order` changes, a mean over
frames with its 95 % interval by Student's t: in per cent of the error of `scrambled` (relative MSE, FLIP), or in JOD. A line
is printed as soon as it is measured; pictures that OUT_FOLDER holds already are used again.
"""

import argparse
import csv
import json
import math
import pathlib
import shlex
import shutil
import statistics
import subprocess
import sys

PATTERNS = ("scrambled", "z-order")
# Two-sided 95 % points of Student's t for 1, 2, ... degrees of freedom.
STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131)


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}\n{done.stderr}")


def with_interval(values, pattern):
    half = STUDENT[min(len(values) - 2, len(STUDENT) - 1)] * statistics.stdev(values) / math.sqrt(len(values))
    return f"{statistics.fmean(values):{pattern}} +- {half:{pattern.lstrip('+')}}"


class Bench:
    def __init__(self, asked):
        self.asked = asked
        self.out = pathlib.Path(asked.out)
        self.frames = range(1, asked.frames + 1)

    def render(self, folder, scene, *options):
        if not (folder / "done").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run(self.asked.program, "render", *scene, "--size", self.asked.size, "--falloff", "uniform", "--gaze-at", "0.5,0.5",
                "--screen", "paper", "--exposure", "auto", "--exr-pixels", "float", "--quiet", "-o", folder / "f.####.exr",
                *options)
            (folder / "done").touch()
        return folder

    def reference(self, folder, scene):
        """The same picture for every frame."""
        self.render(folder, scene, "--frames", "1", "--filter", "none", "--no-learn-light", "--spp", self.asked.reference_spp, "--seed", "77")
        for frame in self.frames[1:]:
            link = folder / f"f.{frame:04d}.exr"
            if not link.exists():
                link.symlink_to("f.0001.exr")
        return folder

    def score(self, reference, test, name, ppd, scores, *options):
        """Of each metric the values by frame and that of all frames; from files that are made where they are missing."""
        whole = scores.with_suffix(".json")
        if not whole.exists():
            run(self.asked.program, "compare", reference / name, test / name, "--anyway", "--screen-px",
                self.asked.size.replace("x", ","), "--screen-ppd", ppd, "--gaze-at", "0.5,0.5", "--overwrite", "--csv", scores,
                "--json", whole, *options)
        found = {}
        with open(scores, newline="") as file:
            for row in csv.DictReader(file):
                found.setdefault(row["metric"], []).append(float(row["value"]))
        pooled = json.loads(whole.read_text())["sequence"][0]["scores"]
        return found, {score["metric"]: score["value"] for score in pooled}

    def scores_of(self, reference, test):
        width, height = self.asked.size.split("x")
        rect = ["--frame-rect", f"0,0,{width},{height}"]
        found, _ = self.score(reference, test, "f.####.exr", "28", test / "errors.csv", "--metrics", "relmse,flip", *rect)
        for ppd in self.asked.ppd.split(","):
            _, clip = self.score(reference, test, "f.####.exr", ppd, test / f"clip-{ppd}.csv", "--metrics", "fovvideovdp", *rect)
            found[f"clip {ppd}"] = clip["fovvideovdp"]
            found[f"still {ppd}"] = [
                self.score(reference, test, f"f.{frame:04d}.exr", ppd, test / f"still-{ppd}-{frame}.csv", "--metrics",
                           "fovvideovdp", *rect)[1]["fovvideovdp"] for frame in self.frames]
        return found

    def measure(self, name, scene):
        reference = self.reference(self.out / name / "reference", scene)
        for filter_name in self.asked.filters.split(","):
            for spp in self.asked.spp.split(","):
                old, new = (self.scores_of(reference, self.render(
                    self.out / name / f"{filter_name}-{spp}-{pattern}", scene, "--frames", f"1-{self.asked.frames}",
                    "--budget-spp", spp, "--filter", filter_name, "--sample-pattern", pattern)) for pattern in PATTERNS)
                cells = [name, filter_name, spp]
                for metric in ("relmse", "flip"):
                    level = statistics.fmean(old[metric])
                    change = [100 * (b - a) / level for a, b in zip(old[metric], new[metric])]
                    cells.append(f"{statistics.fmean(old[metric]):.4g} {statistics.fmean(new[metric]):.4g} "
                                 f"({with_interval(change, '+.1f')} %)")
                for ppd in self.asked.ppd.split(","):
                    a, b = old[f"still {ppd}"], new[f"still {ppd}"]
                    cells.append(f"{statistics.fmean(a):.2f} {statistics.fmean(b):.2f} "
                                 f"({with_interval([y - x for x, y in zip(a, b)], '+.3f')})")
                    cells.append(f"{old[f'clip {ppd}']:.2f} {new[f'clip {ppd}']:.2f}")
                print("| " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--spp", default="0.25,1,4")
    parser.add_argument("--filters", default="none,linear,guided")
    parser.add_argument("--frames", type=int, default=6)
    parser.add_argument("--reference-spp", default="1024")
    parser.add_argument("--ppd", default="12,28")
    asked = parser.parse_args()
    heads = ["scene", "filter", "spp", "relative MSE", "FLIP"]
    for ppd in asked.ppd.split(","):
        heads += [f"JOD, {ppd} ppd", f"clip, {ppd} ppd"]
    print("| " + " | ".join(heads) + " |\n|" + " --- |" * len(heads), flush=True)
    bench = Bench(asked)
    for scene in asked.scene:
        name, *options = shlex.split(scene)
        bench.measure(name, options)


if __name__ == "__main__":
    main()
