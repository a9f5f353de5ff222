#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is a filtered frame ever worse than its raw samples?

  never_below_raw.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--scenes NAME,...] [--size 240x135]
                     [--rates 0.25,0.5,...,256] [--seeds 4] [--layouts uniform,foveated] [--filter guided]
                     [--others linear] [--earlier PROGRAM] [--again FILTER,...] [--reference-spp 1024]

OPTIONS are those of `gazetrace render`. Frames are uniform, or foveated as by default with the gaze in the middle, each
scaled to a rate: so many samples a pixel on average. The camera is at rest, and every frame has samples of its own and
stands for a seed: `--seeds` of them up to 4 samples a pixel, at most 3 above and 2 from 256 on. They fill the screen `paper`.

The reference of a scene is the mean of two renders of `--reference-spp` samples with the seeds 991 and 992, by `gazetrace
merge --mean`. Half their difference is as large as the error of that mean: what the first of them scores against the mean
is the reference's floor. It is taken off the relative MSE of `none` before differences are stated in per cent.

A line is a cell: `none`, the filter, and how much the filter changes, a mean over seeds with its 95 % interval by Student's
t, of JOD, FLIP within the fovea and relative MSE. A cell is `LOST` in a metric where the whole interval lies beyond the
limit (-0.02 JOD, +1 %), and `open` where the interval holds the limit. Up to 4 samples a pixel, the share of the JOD that
the best of the others gains over `none` stands beside it; `LOST` below 0.95. `--earlier` counts the filter of another
program as one more of the others.

Pictures and scores that OUT_FOLDER holds already are used again; `--again` renders anew what a changed filter changes.
"""

import argparse
import json
import math
import pathlib
import shlex
import shutil
import statistics
import subprocess
import sys

# Two-sided 95 % points of Student's t for 1, 2, ... degrees of freedom.
STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131)
METRICS = ("fovvideovdp", "flip", "relmse")
# How much worse than `none` a filtered frame may be: in JOD, and in shares of the error.
LIMITS = {"fovvideovdp": 0.02, "flip": 0.01, "relmse": 0.01}
LAYOUTS = {"uniform": ["--sampling", "uniform"], "foveated": ["--preset", "default"]}
FEW = 4  # samples a pixel up to which nothing may be given away
LEAST_SHARE = 0.95


def run(*arguments):
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}\n{done.stderr}")


def mean_and_half(values):
    if len(values) < 2:
        return values[0], math.inf
    half = STUDENT[min(len(values) - 2, len(STUDENT) - 1)] * statistics.stdev(values) / math.sqrt(len(values))
    return statistics.fmean(values), half


class Change:
    """How much worse the filter is than `none`: in JOD, or as a share of the error of `none` without the floor."""

    def __init__(self, metric, none, filtered, floor):
        self.metric = metric
        level = statistics.fmean(none) - (floor if metric == "relmse" else 0.0)
        if metric == "fovvideovdp":
            worse = [a - b for a, b in zip(none, filtered)]
        else:
            worse = [(b - a) / level for a, b in zip(none, filtered)]
        self.worse, self.half = mean_and_half(worse)

    def verdict(self):
        limit = LIMITS[self.metric]
        if self.worse - self.half > limit:
            return " **LOST**"
        return " open" if self.worse + self.half > limit else ""

    def __str__(self):
        if self.metric == "fovvideovdp":
            return f"{-self.worse:+.3f} +- {self.half:.3f}{self.verdict()}"
        return f"{100 * self.worse:+.1f} +- {100 * self.half:.1f} %{self.verdict()}"


class Bench:
    def __init__(self, asked):
        self.asked = asked
        self.out = pathlib.Path(asked.out)
        self.lost = []
        self.open = 0
        self.cells = 0

    def render(self, program, folder, scene, *options):
        if not (folder / "done").exists():
            shutil.rmtree(folder, ignore_errors=True)
            run(program, "render", *options, "--size", self.asked.size, "--gaze-at", "0.5,0.5", "--screen", "paper",
                "--exr-pixels", "float", "--quiet", "-o", folder / "f.####.exr", *scene)
            (folder / "done").touch()
        return folder

    def reference(self, name, scene):
        """The folders of one half of the reference, and of the mean of both."""
        halves = [self.render(self.asked.program, self.out / name / f"half-{seed}", scene, "--preset", "reference", "--spp",
                              self.asked.reference_spp, "--seed", seed, "--frames", "1") for seed in ("991", "992")]
        whole = self.out / name / "reference"
        if not (whole / "done").exists():
            run(self.asked.program, "merge", "--mean", *(half / "f.####.exr" for half in halves), "-o", whole / "f.####.exr",
                "--overwrite")
            (whole / "done").touch()
        return halves[0], whole

    def scores(self, reference, picture):
        record = picture.with_suffix(".json")
        if not record.exists():
            run(self.asked.program, "compare", reference / "f.0001.exr", picture, "--metrics", ",".join(METRICS), "--anyway",
                "--json", record)
        found = {s["metric"]: s for s in json.loads(record.read_text())["sequence"][0]["scores"]}
        return {"fovvideovdp": found["fovvideovdp"]["value"], "flip": found["flip"]["regions"]["fovea"],
                "relmse": found["relmse"]["value"]}

    def seeds(self, rate):
        return self.asked.seeds if rate <= FEW else min(self.asked.seeds, 3 if rate < 256 else 2)

    def measure(self, name, scene, layout, rate, column):
        """Of a filter each metric's values by seed. `column` is a filter, or `earlier`."""
        earlier = column == "earlier"
        program = self.asked.earlier if earlier else self.asked.program
        seeds = self.seeds(rate)
        folder = self.render(program, self.out / name / f"{layout}-{rate:g}-{column}", scene, *LAYOUTS[layout],
                             "--spp", f"{rate:g}", "--filter",
                             self.asked.filter if earlier else column, "--frames", f"1-{seeds}")
        by_seed = [self.scores(self.out / name / "reference", folder / f"f.{k:04d}.exr") for k in range(1, seeds + 1)]
        return {metric: [scores[metric] for scores in by_seed] for metric in METRICS}

    def share_of_best(self, found, none):
        """Gains of the filter and of the best of the others over `none`, as text, and whether too much is given away."""
        gains = {column: statistics.fmean(f["fovvideovdp"]) - statistics.fmean(none["fovvideovdp"])
                 for column, f in found.items()}
        own = gains.pop(self.asked.filter)
        best = max(gains, key=gains.get)
        if gains[best] <= 0:
            return f"{own:+.2f}, none gains", False
        too_little = own < LEAST_SHARE * gains[best]
        return f"{own:+.2f}, {best} {gains[best]:+.2f}{' **LOST**' if too_little else ''}", too_little

    def cell(self, name, scene, layout, rate, floor):
        none = self.measure(name, scene, layout, rate, "none")
        columns = [self.asked.filter]
        if rate <= FEW:
            columns += [c for c in self.asked.others.split(",") if c] + (["earlier"] if self.asked.earlier else [])
        found = {column: self.measure(name, scene, layout, rate, column) for column in columns}
        own = found[self.asked.filter]
        cells = [name, layout, f"{rate:g}"]
        self.cells += 1
        for metric in METRICS:
            change = Change(metric, none[metric], own[metric], floor[metric])
            pattern = ".2f" if metric == "fovvideovdp" else ".4g"
            cells.append(f"{statistics.fmean(none[metric]):{pattern}}, {statistics.fmean(own[metric]):{pattern}} ({change})")
            if "LOST" in change.verdict():
                self.lost.append(f"{name}, {layout}, {rate:g} samples a pixel, {metric}: {change}")
            self.open += "open" in change.verdict()
        cells.append("")
        if len(found) > 1:
            cells[-1], too_little = self.share_of_best(found, none)
            if too_little:
                self.lost.append(f"{name}, {layout}, {rate:g} samples a pixel, gain in JOD: {cells[-1]}")
        print("| " + " | ".join(cells) + " |", flush=True)

    def scene(self, name, scene):
        half, reference = self.reference(name, scene)
        floor = self.scores(reference, half / "f.0001.exr")
        print(f"| {name} | floor | | {floor['fovvideovdp']:.2f} | {floor['flip']:.4g} | {floor['relmse']:.4g} | |", flush=True)
        for layout in self.asked.layouts.split(","):
            for rate in self.asked.rates.split(","):
                self.cell(name, scene, layout, float(rate), floor)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--scenes")
    parser.add_argument("--size", default="240x135")
    parser.add_argument("--rates", default="0.25,0.5,1,2,4,8,16,32,64,128,256")
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--layouts", default="uniform,foveated")
    parser.add_argument("--filter", default="guided")
    parser.add_argument("--others", default="linear")
    parser.add_argument("--earlier")
    parser.add_argument("--again", default="")
    parser.add_argument("--reference-spp", default="1024")
    asked = parser.parse_args()
    bench = Bench(asked)
    for column in filter(None, asked.again.split(",")):
        for folder in bench.out.glob(f"*/*-{column}"):
            shutil.rmtree(folder)
    print("| scene | layout | samples a pixel | JOD: none, filter | FLIP, fovea | relative MSE | gain in JOD, best other |\n|"
          + " --- |" * 7, flush=True)
    for scene in asked.scene:
        name, *options = shlex.split(scene)
        if not asked.scenes or name in asked.scenes.split(","):
            bench.scene(name, options)
    print(f"\n{bench.cells} cells, {len(bench.lost)} losses, {bench.open} open")
    for loss in bench.lost:
        print(f"- {loss}")


if __name__ == "__main__":
    main()
