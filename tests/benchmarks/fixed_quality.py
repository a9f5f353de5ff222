#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What does a stated quality cost: by raw uniform samples, by gazetrace without gaze, and by gazetrace with it?

  fixed_quality.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--display desktop|hmd|WxH@PPD] [--frames 24]
                   [--gazes "0.5,0.5 0.25,0.6 0.75,0.35"] [--targets 8.5,9,9.5] [--budgets 0.5,1,2,4,8,16]
                   [--accumulate "window --accumulate-past 340ms --accumulate-future 340ms"]
                   [--wrong-budget 4] [--wrong-seeds 4] [--moving] [--reference-spp 4096]
                   [--raw-rates 1,4,16,...,65536] [--inner 96] [--margin 32] [--stride 480] [--whole] [--paper] [--tool-in-windows]

OPTIONS are those of `gazetrace render`. `desktop` is 61 degrees wide at 28 pixels a degree, `hmd` 87 x 93 degrees at 13.
Clips have 24 frames a second. Views are at rest, and one reference stands for all frames; with `--moving`, for a camera or a
scene that moves, each frame has its own, of `--reference-spp` samples a pixel.

Rates as high as a reference needs are dear on whole frames, so references and raw samples are traced in windows only: a grid
of squares of `--inner` pixels, `--stride` apart, each of which stands for the area around it, and one at each gaze, which
stands for itself. A margin around each belongs to what FovVideoVDP sees and has no weight of its own
(`compare --pooling-weights`). Outside of the windows test and reference show the same picture. `--whole` traces and scores
whole frames instead, to see what the windows change.

References and raw samples are traced without path guiding. Raw samples are rendered once, at 64 samples a pixel, a fresh pattern for each frame. Their score at N samples is that of a
clip whose differences from the reference are divided by the root of N / 64; the line `scaling` shows how well that holds, by a
clip that was rendered at 16. Rare light is cut off by the display less the more samples there are, and samples of a sequence are
better than independent ones, so that raw samples are a little better than they are scaled to be.

Costs are processor seconds a frame, without loading; those of the tool contain the frames that it traces before and after the
clip for it. Those of raw frames follow from whole frames at 2 and 10 samples a pixel. The tool renders whole frames:
`--sampling adaptive --filter guided --accumulate ...` at each budget, with the gaze, without any, and with the gaze where it was
not (at `--wrong-budget`, by `--wrong-seeds` seeds). Costs at a target are interpolated in their logarithm between the two
budgets around it, and never beyond the smallest and the largest one. `--paper`: what the preset `paper` costs and scores, and
what the tool scores at that cost. Pictures and scores that OUT_FOLDER holds are used again. Needs numpy, scipy and OpenEXR.

`--tool-in-windows`, where whole frames are too dear: the tool chooses its rates for one whole frame (`--sampling adaptive`), and
the clip is traced with these rates in the windows only. What it would have cost follows from what tracing that whole frame took,
its pilot included, for all frames that the clip reads (those after its end as well), and from what the clip took beside its
samples, which it takes for the whole frame: learning of light, first hits, sums, filter, files. Raw frames cost what a whole
frame of one raw sample a pixel takes, in proportion.
Everything is processor time, so that other work on the machine matters less.

Beside each score stand two judges that nothing was optimised for: `cortical`, the relative squared error weighted by cortical
magnification, and `change`, by how much the relative error changes from one frame to the next.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import resource
import shlex
import shutil
import subprocess
import sys

import numpy
import OpenEXR
from scipy.stats import t as student_t
from scored_windows import OtherJudges, Windows, read_exr, write_exr, write_picture

DISPLAYS = {"desktop": (1708, 961, 28), "hmd": (1131, 1209, 13)}
FRAMES_PER_SECOND = 24
RAW_SPP = 64
OUTSIDE_SPP = 1 / 256
RAW = ["--filter", "none", "--no-guiding", "--accumulate", "off"]
METRICS = ("fovvideovdp", "flicker")


def run(*arguments):
    """Runs a program; processor seconds that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}\n{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def told(looks_at):
    return "nowhere" if looks_at is None else looks_at.replace(",", "_")


def of_seed(seed):
    return f"-seed{seed}" if seed else ""


def seed_options(seed):
    return ["--seed", str(seed)] if seed else []


class Scene:
    def __init__(self, bench, name, options):
        self.bench = bench
        self.asked = bench.asked
        self.options = options
        self.exposure = options[options.index("--exposure") + 1] if "--exposure" in options else "0"
        self.folder = bench.out / name
        self.folder.mkdir(parents=True, exist_ok=True)
        self.costs_path = self.folder / "costs.json"
        self.costs = json.loads(self.costs_path.read_text()) if self.costs_path.exists() else {}
        self.still_halves, self.fills = None, {}

    def render(self, name, frames, *options):
        """The folder of the frames."""
        folder = self.folder / name
        if not (folder / "done").exists() or name not in self.costs:
            shutil.rmtree(folder, ignore_errors=True)
            seconds = run(self.asked.program, "render", *self.options, "--size", self.bench.size, *self.bench.screen, "--frames",
                          frames, "--fps", FRAMES_PER_SECOND, "--exr-pixels", "half", "--quiet", "-o",
                          folder / "f.####.exr", *options)
            self.costs[name] = seconds
            self.costs_path.write_text(json.dumps(self.costs, indent=1))
            (folder / "done").touch()
        return folder

    def in_windows(self, name, frames, spp, seed):
        """Raw samples, `spp` of them a pixel within the windows."""
        if self.asked.whole:
            return self.render(name, frames, *RAW, "--sampling", "uniform", "--spp", spp, "--seed", seed)
        rates = self.folder / f"rates-{spp}.exr"
        write_exr(rates, {"Y": numpy.where(self.bench.windows.is_traced, spp, OUTSIDE_SPP)})
        return self.render(name, frames, *RAW, "--density", rates, "--seed", seed)

    def halves(self, frame):
        """Two independent references of a frame. At rest each is the mean of four frames."""
        if self.asked.moving:
            folders = [self.in_windows(f"reference-{k}", f"1-{self.asked.frames}", self.asked.reference_spp // 2, 700001 + k)
                       for k in range(2)]
            return [read_exr(folder / f"f.{frame:04d}.exr") for folder in folders]
        if self.still_halves is None:
            folders = [self.in_windows(f"reference-{k}", "1-4", self.asked.reference_spp // 8, 700001 + k) for k in range(2)]
            self.still_halves = [sum(read_exr(folder / f"f.{f:04d}.exr") for f in range(1, 5)) / 4 for folder in folders]
        return self.still_halves

    def truth(self, frame):
        return 0.5 * sum(self.halves(frame))

    def around(self, picture, frame):
        """The picture in the windows, and outside of them what test and reference both show."""
        key = frame if self.asked.moving else 1
        if key not in self.fills:
            last = self.asked.frames if self.asked.moving else 1
            folder = self.render("fill", f"1-{last}" if last > 1 else "1", "--sampling", "uniform", "--filter", "guided", "--spp", "4")
            self.fills = {key: read_exr(folder / f"f.{key:04d}.exr")}
        return numpy.where(self.bench.windows.is_traced[..., None], numpy.maximum(picture, 0), self.fills[key])

    def prepare(self):
        def with_its_error(frame):
            # A half differs from the other by twice what their mean is off in one of them: by sqrt(2) times a half's error, and
            # the mean's error is a half's over sqrt(2).
            first, second = self.halves(frame)
            return 0.5 * (first + second) + 0.5 * (first - second)

        floor = self.score("floor", self.bench.gazes[0], with_its_error)
        print(f"{self.folder.name}: the reference's own error scores {floor['fovvideovdp']:.2f} JOD at {self.bench.gazes[0]}", flush=True)

    def score(self, name, gaze, picture_of_frame):
        """Scores of a clip at a gaze; `picture_of_frame(frame)` is asked only where the clip was not scored yet."""
        record = self.folder / "scores" / f"{name}@{gaze.replace(',', '_')}.json"
        if not record.exists():
            work = self.folder / "work"
            shutil.rmtree(work, ignore_errors=True)
            work.mkdir(parents=True)
            record.parent.mkdir(exist_ok=True)
            write_picture(work / "weights.exr", numpy.repeat(self.bench.windows.weights(gaze)[..., None], 3, axis=2))
            judges = OtherJudges(self.bench.windows.weights(gaze), self.bench.windows.gaze_px[gaze], self.bench.pixels_per_degree)
            expected = None
            for frame in range(1, self.asked.frames + 1):
                if expected is None or self.asked.moving:
                    expected = self.around(self.truth(frame), frame)
                    write_picture(work / f"r.{frame:04d}.exr", expected)
                else:
                    (work / f"r.{frame:04d}.exr").symlink_to("r.0001.exr")
                picture = self.around(picture_of_frame(frame), frame)
                write_picture(work / f"t.{frame:04d}.exr", picture)
                judges.add(picture, expected)
            metrics = METRICS if self.asked.whole and self.asked.frames >= FRAMES_PER_SECOND else METRICS[:1]
            run(self.asked.program, "compare", work / "r.####.exr", work / "t.####.exr", "--metrics", ",".join(metrics), "--fps",
                FRAMES_PER_SECOND, "--frames", f"1-{self.asked.frames}", "--anyway", *self.bench.screen, "--gaze-at", gaze,
                "--exposure", self.exposure, *([] if self.asked.whole else ["--pooling-weights", work / "weights.exr"]),
                "--json", record)
            shutil.rmtree(work)
            record.with_suffix(".others").write_text(json.dumps(judges.found()))
        others = record.with_suffix(".others")
        return (json.loads(others.read_text()) if others.exists() else {}) | {s["metric"]: s["value"] for s in json.loads(record.read_text())["sequence"][0]["scores"]}

    def traced(self, name):
        """Samples and processor seconds of tracing, of all rows."""
        with open(self.folder / name / "f.timing.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        return (sum(int(row["samples"]) for row in rows), sum(float(row["trace_cpu_ms"]) for row in rows) / 1000,
                sum(int(row["pilot_samples"]) for row in rows))

    def loading(self):
        if "loading" not in self.costs:
            self.costs["loading"] = run(self.asked.program, "render", *self.options, "--size", "8x8", *RAW, "--sampling", "uniform",
                                        "--spp", "1", "--frames", "1", "--quiet", "--overwrite", "-o", self.folder / "loading.####.exr")
        return self.costs["loading"]

    def seconds_of_sample(self):
        """Of a raw whole frame's samples."""
        self.render("raw-samples", "1", *RAW, "--sampling", "uniform", "--spp", "1")
        samples, seconds, _ = self.traced("raw-samples")
        return seconds / samples

    def beside_samples(self, name, frames):
        """Processor seconds a frame that the clip took for all but its samples."""
        return max(self.costs[name] - self.traced(name)[1] - self.loading(), 0) / frames

    def rates(self, budget, looks_at, seed=0):
        """The rates that the tool chooses for a whole frame, its samples, and processor seconds of tracing it."""
        name = f"rates-of-{told(looks_at)}-{budget:g}{of_seed(seed)}"
        folder = self.render(name, "1", "--sampling", "adaptive", "--spp", f"{budget:g}", "--filter", "guided", "--max-block", "1",
                             "--map", self.folder / f"{name}.exr", "--overwrite",
                             *(["--gaze-at", looks_at] if looks_at is not None else []), *seed_options(seed))
        assert folder.exists()
        with OpenEXR.File(str(self.folder / f"{name}.exr"), separate_channels=True) as file:
            return file.channels()["samples_per_pixel"].pixels.astype(numpy.float32), *self.traced(name)[:2]

    def tool_in_windows(self, gaze, looks_at, budget, seed=0):
        name = f"in-windows-{self.asked.accumulate.replace(' ', '')}-{told(looks_at)}-{budget:g}{of_seed(seed)}"
        rates, samples_of_frame, seconds_of_frame = self.rates(budget, looks_at, seed)
        path = self.folder / f"{name}.exr"
        write_exr(path, {"Y": numpy.where(self.bench.windows.is_traced, rates, OUTSIDE_SPP)})
        frames = self.asked.frames
        folder = self.render(name, f"1-{frames}", "--density", path, "--max-block", "1", "--filter", "guided",
                             *(["--accumulate", *self.asked.accumulate.split()] if self.asked.accumulate != "off" else []),
                             *seed_options(seed))
        # How many frames were traced for those that are shown.
        in_windows = float(numpy.where(self.bench.windows.is_traced, rates, OUTSIDE_SPP).sum())
        traced_frames = self.traced(name)[0] / in_windows
        cost = seconds_of_frame * traced_frames / frames + self.beside_samples(name, frames)
        print(f"  {name}: {samples_of_frame / rates.size:.2f} samples a pixel of {traced_frames:.1f} frames for {frames}, beside samples "
              f"{self.beside_samples(name, frames) / self.seconds_of_sample() / rates.size:.2f} a pixel", flush=True)
        return cost, self.score(name, gaze, lambda frame: read_exr(folder / f"f.{frame:04d}.exr")), budget

    def frame_cost(self, name, *options):
        """Processor seconds of one of the clip's frames, and the folder. What is traced before and after the clip for it counts."""
        folder = self.render(name, f"1-{self.asked.frames}", *options)
        return (self.costs[name] - self.loading()) / self.asked.frames, folder

    def raw_curve(self, gaze):
        """(cost, scores, rate) by rate."""
        clip = self.in_windows("raw-rendered-64", f"1-{self.asked.frames}", RAW_SPP, 12)
        if self.asked.tool_in_windows:
            pixels = self.bench.windows.is_traced.size
            return self.raw_scores(gaze, clip, self.beside_samples("raw-rendered-64", self.asked.frames), pixels * self.seconds_of_sample())
        for spp in (2, 10):
            for frames in ("1", "1-3"):
                name = f"cost-{spp}-{frames}"
                if name not in self.costs:
                    shutil.rmtree(self.render(name, frames, *RAW, "--sampling", "uniform", "--spp", str(spp)))
        of_frame = {spp: (self.costs[f"cost-{spp}-1-3"] - self.costs[f"cost-{spp}-1"]) / 2 for spp in (2, 10)}
        of_sample = (of_frame[10] - of_frame[2]) / 8
        fixed = max(of_frame[2] - 2 * of_sample, 0)
        return self.raw_scores(gaze, clip, fixed, of_sample)

    def raw_scores(self, gaze, clip, fixed, of_sample):
        curve = []
        for rate in self.asked.raw_rates:
            scale = math.sqrt(RAW_SPP / rate)
            scores = self.score(f"raw-{rate:g}", gaze,
                                lambda frame, s=scale: self.scaled(clip, frame, s))
            curve.append((fixed + rate * of_sample, scores, rate))
            if scores["fovvideovdp"] > self.asked.targets[-1] + 0.1:
                break
        return curve

    def scaled(self, clip, frame, by):
        truth = self.truth(frame)
        return truth + by * (read_exr(clip / f"f.{frame:04d}.exr") - truth)

    def check_scaling(self, gaze):
        clip = self.in_windows("raw", f"1-{self.asked.frames}", 16, 11)
        rendered = self.score("raw-rendered-16", gaze, lambda frame: read_exr(clip / f"f.{frame:04d}.exr"))["fovvideovdp"]
        scaled = self.score("raw-16", gaze, None)["fovvideovdp"]
        print(f"scaling: raw 16 samples a pixel score {rendered:.3f} JOD as rendered, {scaled:.3f} as scaled from {RAW_SPP}", flush=True)

    def tool_curve(self, gaze, looks_at):
        """(cost, scores, rate) by budget. `looks_at`: the gaze that the tool is told; None: none."""
        curve = []
        for budget in self.asked.budgets:
            curve.append(self.tool(gaze, looks_at, budget))
            if curve[-1][1]["fovvideovdp"] > self.asked.targets[-1] + 0.1:
                break
        return curve

    def tool(self, gaze, looks_at, budget, seed=0):
        if self.asked.tool_in_windows:
            return self.tool_in_windows(gaze, looks_at, budget, seed)
        name = f"tool-{self.asked.accumulate.replace(' ', '')}-{told(looks_at)}-{budget:g}{of_seed(seed)}"
        options = ["--sampling", "adaptive", "--spp", f"{budget:g}", "--filter", "guided", "--max-block", "1", *seed_options(seed)]
        options += ["--accumulate", *self.asked.accumulate.split()] if self.asked.accumulate != "off" else []
        options += ["--gaze-at", looks_at] if looks_at is not None else []
        cost, folder = self.frame_cost(name, *options)
        return cost, self.score(name, gaze, lambda frame: read_exr(folder / f"f.{frame:04d}.exr")), budget


def at_target(curve, target):
    """Cost and rate at which the curve first reaches a JOD; None: it does not, or it begins above."""
    for (cost0, scores0, rate0), (cost1, scores1, rate1) in zip(curve, curve[1:]):
        low, high = scores0["fovvideovdp"], scores1["fovvideovdp"]
        if low <= target <= high:
            share = (target - low) / (high - low) if high > low else 0
            return cost0 * (cost1 / cost0)**share, rate0 * (rate1 / rate0)**share
    return None


def at_cost(curve, cost):
    for (cost0, scores0, _), (cost1, scores1, _) in zip(curve, curve[1:]):
        if cost0 <= cost <= cost1:
            share = math.log(cost / cost0) / math.log(cost1 / cost0)
            return f"{scores0['fovvideovdp'] + share * (scores1['fovvideovdp'] - scores0['fovvideovdp']):.2f} JOD"
    return f"between no two of its budgets ({curve[0][0]:.2f} to {curve[-1][0]:.2f} s)"


def beyond(curve, target):
    return "below" if curve[0][1]["fovvideovdp"] > target else "not reached"


class Bench:
    def __init__(self, asked):
        self.asked = asked
        self.gazes = asked.gazes.split()
        width, height, ppd = DISPLAYS.get(asked.display) or (int(n) for n in re.fullmatch(r"(\d+)x(\d+)@(\d+)", asked.display).groups())
        self.size = f"{width}x{height}"
        self.pixels_per_degree = ppd
        self.screen = ["--screen-px", f"{width},{height}", "--screen-ppd", str(ppd)]
        self.out = pathlib.Path(asked.out) / (asked.display + ("-whole" if asked.whole else ""))
        self.windows = Windows(asked, width, height, self.gazes)
        print(f"{self.size} at {ppd} pixels a degree; windows: {100 * self.windows.is_traced.mean():.0f} % of the frame traced, "
              f"{100 * (self.windows.weights(self.gazes[0]) > 0).mean():.0f} % scored", flush=True)

    def measure(self, name, options):
        scene = Scene(self, name, options)
        scene.prepare()
        for k, gaze in enumerate(self.gazes):
            raw = scene.raw_curve(gaze)
            if k == 0 and 16 in self.asked.raw_rates:
                scene.check_scaling(gaze)
            curves = {"raw": raw, "no gaze": scene.tool_curve(gaze, None), "gaze": scene.tool_curve(gaze, gaze)}
            for which, curve in curves.items():
                for cost, scores, rate in curve:
                    others = "".join(f", {judge} {value:.3g}" for judge, value in scores.items() if judge != "fovvideovdp")
                    print(f"  {name} {gaze} {which:<8} {rate:8g} spp {cost:9.2f} s a frame {scores['fovvideovdp']:6.2f} JOD{others}",
                          flush=True)
            if self.asked.wrong_budget:
                self.wrong_gaze(scene, gaze)
            if self.asked.paper:
                self.paper(scene, gaze, curves["gaze"])
            for target in self.asked.targets:
                self.row(name, gaze, target, curves)

    def wrong_gaze(self, scene, gaze):
        """Differences of the same seed, and their 95 % interval where there are several."""
        budget, seeds = self.asked.wrong_budget, range(self.asked.wrong_seeds)
        right = [scene.tool(gaze, gaze, budget, seed)[1]["fovvideovdp"] for seed in seeds]
        for other in self.gazes:
            if other == gaze:
                continue
            lost = numpy.array([scene.tool(gaze, other, budget, seed)[1]["fovvideovdp"] for seed in seeds]) - right
            print(f"  wrong gaze: {other} for {gaze}, {budget:g} spp: {lost.mean():+.3f} JOD{self.interval(lost)}", flush=True)

    @staticmethod
    def interval(differences):
        count = len(differences)
        if count < 2:
            return ", unresolved by one seed"
        half = student_t.ppf(0.975, count - 1) * differences.std(ddof=1) / math.sqrt(count)
        which = "loses" if differences.mean() + half < 0 else "wins" if differences.mean() - half > 0 else "unresolved"
        return f" +- {half:.3f} of {count} seeds: {which}"

    @staticmethod
    def paper(scene, gaze, tool):
        cost, folder = scene.frame_cost(f"paper-{gaze.replace(',', '_')}", "--preset", "paper", "--gaze-at", gaze)
        name = folder.name
        jod = scene.score(name, gaze, lambda frame: read_exr(folder / f"f.{frame:04d}.exr"))["fovvideovdp"]
        print(f"  paper's setting: {cost:.2f} s a frame, {jod:.2f} JOD; the tool at that cost: {at_cost(tool, cost)}", flush=True)

    @staticmethod
    def row(name, gaze, target, curves):
        found = {which: at_target(curve, target) for which, curve in curves.items()}
        cells = [f"{found[which][0]:.2f} s ({found[which][1]:.3g} spp)" if found[which] else beyond(curves[which], target)
                 for which in curves]

        def ratio(a, b):
            return f"{found[a][0] / found[b][0]:.2f}" if found[a] and found[b] else "-"

        cells += [ratio("raw", "gaze"), ratio("no gaze", "gaze")]
        print(f"| {name} | {gaze} | {target:g} | " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--display", default="desktop")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--gazes", default="0.5,0.5 0.25,0.6 0.75,0.35")
    parser.add_argument("--targets", default="8.5,9,9.5")
    parser.add_argument("--budgets", default="0.5,1,2,4,8,16")
    parser.add_argument("--accumulate", default="window --accumulate-past 340ms --accumulate-future 340ms")
    parser.add_argument("--wrong-budget", type=float, default=0)
    parser.add_argument("--wrong-seeds", type=int, default=1)
    parser.add_argument("--moving", action="store_true")
    parser.add_argument("--reference-spp", type=int, default=4096)
    parser.add_argument("--raw-rates", default=",".join(str(4**k) for k in range(9)))
    parser.add_argument("--tool-in-windows", action="store_true")
    parser.add_argument("--inner", type=int, default=96)
    parser.add_argument("--margin", type=int, default=32)
    parser.add_argument("--stride", type=int, default=480)
    parser.add_argument("--whole", action="store_true")
    parser.add_argument("--paper", action="store_true")
    asked = parser.parse_args()
    if asked.moving and asked.tool_in_windows:
        parser.error("--tool-in-windows takes the rates of one frame for all, which --moving does not allow")
    asked.targets = sorted(float(t) for t in asked.targets.split(","))
    asked.budgets = sorted(float(b) for b in asked.budgets.split(","))
    asked.raw_rates = sorted(float(r) for r in asked.raw_rates.split(","))
    bench = Bench(asked)
    print("| scene | gaze | JOD | raw uniform | tool without gaze | tool with gaze | raw over tool | without over with gaze |\n|"
          + " --- |" * 8, flush=True)
    for text in asked.scene:
        name, *options = shlex.split(text)
        bench.measure(name, options)


if __name__ == "__main__":
    main()
