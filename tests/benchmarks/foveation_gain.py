#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What foveation itself gains, apart from what a filter gains: against uniform rendering through the same filter.

  foveation_gain.py GAZETRACE SCENE --gaze 0.5,0.5 [--gaze U,V ...] [--models regions,acuity] [--filters linear,guided]
                    [--budget 1] [--seeds 4] [--size 960x540] [--reference-spp 1024] [options of `gazetrace render` ...]

Every frame is rendered with the same samples in all (--budget, on average a pixel) by

  the model       foveated at each gaze position
  equal samples   uniform, with as many samples in all
  equal time      uniform, with as many samples as fit into the time that planning, guides, tracing and reconstruction of
                  the foveated frame took
  low resolution  uniform with the same samples in a frame of half the width and height, enlarged bilinearly

and scored by `gazetrace compare` against a reference of other seeds: the mean of four scramblings. `floor` is the score of
two of them against the other two: nothing smaller is claimed. Prints, for each eccentricity band (degrees of ray angle from the
gaze), the model's share of the frame's pixels and, against each rival, the ratio of relative MSE and the differences of FLIP
(less is better) and of FovVideoVDP (JOD, more is better), with 95 % intervals: bootstrap over gaze positions and seeds.
Needs numpy, Pillow and OpenEXR.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR
from PIL import Image

METRICS = ("relmse", "flip", "fovvideovdp")
BANDS = ("0-2.6", "2.6-5.2", "5.2-8.5", "8.5-17", "17-30", "30-60")
STAGES = ("plan_ms", "guides_ms", "trace_ms", "reconstruct_ms")
RIVALS = ("equal samples", "equal time", "low resolution")


def run(words):
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done.stdout


def read_exr(path):
    channels = OpenEXR.File(str(path)).channels()
    picture = channels["RGB"].pixels if "RGB" in channels else np.dstack([channels[c].pixels for c in "RGB"])
    return np.asarray(picture, np.float32)[:, :, :3]


def write_exr(path, picture):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": np.ascontiguousarray(picture, np.float32)}).write(str(path))


class Study:
    def __init__(self, arguments, extra, folder):
        self.arguments, self.extra, self.folder = arguments, extra, folder
        self.width, self.height = map(int, arguments.size.split("x"))
        self.count = 0

    def viewing(self, gaze):
        a = self.arguments
        return ["--screen-px", f"{self.width},{self.height}", "--screen-cm", a.screen_cm, "--screen-distance-cm", a.distance_cm,
                "--gaze-at", gaze]

    def render(self, gaze, seed, options, size=None):
        """(picture, ms of the stages that count, samples a pixel)"""
        self.count += 1
        folder = self.folder / f"r{self.count}"
        w, h = size or (self.width, self.height)
        run([self.arguments.program, "render", self.arguments.scene, *self.extra, "--size", f"{w}x{h}", *self.viewing(gaze),
             "--frames", "1", "--seed", seed, "--exr-pixels", "float", "--quiet", "-o", folder / "f.exr", *options])
        with open(next(folder.glob("timing*.csv")), newline="") as file:
            row = next(csv.DictReader(file))
        time_ms = sum(float(row.get(stage) or 0) for stage in STAGES)
        return folder / "f.exr", time_ms, float(row["samples"]) / (w * h)

    def score(self, reference, picture, gaze):
        """{metric: ({band: value}, whole frame)}"""
        out = self.folder / "score.json"
        run([self.arguments.program, "compare", reference, picture, *self.viewing(gaze), "--anyway", "--exposure",
             self.arguments.ev, "--metrics", ",".join(METRICS), "--json", out])
        scores = json.loads(out.read_text())["sequence"][0]["scores"]
        return {s["metric"]: {**s["bands"], "frame": s["value"]} for s in scores}

    def reference(self):
        """The mean of four scramblings, and two means of two."""
        spp = self.arguments.reference_spp // 4
        parts = [read_exr(self.render("0.5,0.5", 1001 + k, ["--falloff", "uniform", "--spp", spp])[0]) for k in range(4)]
        paths = [self.folder / name for name in ("reference.exr", "half_a.exr", "half_b.exr")]
        for path, members in zip(paths, (parts, parts[:2], parts[2:])):
            write_exr(path, np.mean(np.stack(members).astype(np.float64), axis=0))
        return paths

    def enlarged(self, path):
        planes = [Image.fromarray(plane).resize((self.width, self.height), Image.BILINEAR) for plane in np.moveaxis(read_exr(path), 2, 0)]
        write_exr(path, np.dstack([np.asarray(plane) for plane in planes]))
        return path

    def arms(self, model, filter_name, gaze, seed):
        """{name: picture}, and how the times and samples came out"""
        spp = self.arguments.budget
        base = ["--filter", filter_name]
        foveated, ms, samples = self.render(gaze, seed, [*base, "--falloff", model, "--budget-spp", spp])
        uniform = [*base, "--falloff", "uniform", "--budget-spp"]
        equal, equal_ms, equal_samples = self.render(gaze, seed + 100, [*uniform, samples])
        longer = max(samples * ms / equal_ms, 0.01)
        timed, timed_ms, _ = self.render(gaze, seed + 200, [*uniform, longer])
        small = self.enlarged(self.render(gaze, seed + 300, [*uniform, 4 * samples], (self.width // 2, self.height // 2))[0])
        return ({"model": foveated, "equal samples": equal, "equal time": timed, "low resolution": small},
                (samples, equal_samples / samples, timed_ms / ms))


def interval(values, statistic):
    """Value and 95 % bootstrap interval; `values`: [gaze][seed]."""
    rng = np.random.default_rng(1)
    draws = []
    for _ in range(1000):
        chosen = [values[g] for g in rng.integers(len(values), size=len(values))]
        draws.append(statistic(np.array([row[s] for row in chosen for s in rng.integers(len(row), size=len(row))])))
    flat = np.array([v for row in values for v in row])
    return statistic(flat), *np.quantile(draws, [0.025, 0.975])


def geometric(values):
    return float(np.exp(np.mean(np.log(values))))


def report(title, rows, floors):
    print(f"\n{title}")
    print(f"{'band':>8} {'rival':>15} {'relMSE':>7} {'ratio':>24} {'FLIP difference':>28} {'JOD difference':>28}")
    for band in ("frame", *BANDS):
        for rival in RIVALS:
            cells = []
            for metric in METRICS:
                # A frame may miss a band at some gaze positions.
                pairs = [[(arms["model"][metric].get(band), arms[rival][metric].get(band)) for arms in seeds] for seeds in rows]
                pairs = [kept for kept in ([p for p in seeds if None not in p] for seeds in pairs) if kept]
                if not pairs:
                    break
                if metric == "relmse":
                    own = np.mean([p[0] for seeds in pairs for p in seeds])
                    value, low, high = interval([[a / b for a, b in seeds] for seeds in pairs], geometric)
                    mark = "*" if own < floors[metric].get(band, 0) else ""
                    cells.append(f"{own:7.4f}{mark:1} {value:7.3f} ({low:6.3f} .. {high:6.3f})")
                else:
                    value, low, high = interval([[a - b for a, b in seeds] for seeds in pairs], np.mean)
                    cells.append(f"{value:+8.4f} ({low:+7.4f} .. {high:+7.4f})")
            if cells:
                print(f"{band:>8} {rival:>15} " + " ".join(cells), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scene")
    parser.add_argument("--gaze", action="append", required=True)
    parser.add_argument("--models", default="regions")
    parser.add_argument("--filters", default="linear")
    parser.add_argument("--budget", type=float, default=1.0)
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--screen-cm", default="70.848,39.852")
    parser.add_argument("--distance-cm", default="60")
    parser.add_argument("--ev", default="0", help="exposure at which pictures are judged")
    parser.add_argument("--reference-spp", type=int, default=1024)
    arguments, extra = parser.parse_known_args()

    with tempfile.TemporaryDirectory() as name:
        study = Study(arguments, extra, pathlib.Path(name))
        reference, half_a, half_b = study.reference()
        floor = study.score(half_a, half_b, arguments.gaze[0])
        print(f"{arguments.scene}, {arguments.size}, {arguments.budget} spp, {len(arguments.gaze)} gaze positions, "
              f"{arguments.seeds} seeds, reference {arguments.reference_spp} spp")
        print("floor (two scramblings against two): " + ", ".join(f"{m} {floor[m]['frame']:.4g}" for m in METRICS))
        for model in arguments.models.split(","):
            for filter_name in arguments.filters.split(","):
                rows, facts = [], []
                for gaze in arguments.gaze:
                    rows.append([])
                    for seed in range(1, arguments.seeds + 1):
                        pictures, fact = study.arms(model, filter_name, gaze, seed)
                        rows[-1].append({arm: study.score(reference, picture, gaze) for arm, picture in pictures.items()})
                        facts.append(fact)
                spp, samples, time = np.mean(facts, axis=0)
                report(f"{model}, {filter_name}: {spp:.4f} spp; rivals: {samples:.4f} of the samples, {time:.2f} of the time",
                       rows, floor)


if __name__ == "__main__":
    main()
