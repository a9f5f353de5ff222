#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Moving clips through gazetrace and through what a user would take instead: CPU time against what the eye sees.

  rivals.py OUT --gazetrace build/release/bin/gazetrace --shared FOLDER [--clips sponza,walk] [--rates 1,2,4,8]

Needs numpy, OpenEXR, pyoidn, torch and pyfvvdp. Every picture is kept in OUT and made once, so that a run that was
stopped goes on; what is left to do is printed before it starts. Rows, interleaved by clip and rate:

  raw           uniform samples, no filter
  oidn          the same samples through Open Image Denoise, frame by frame, with the program's albedo and normal
  joined-oidn   the program's sums of a window on both sides, without a filter, through Open Image Denoise
  single        the program's own denoising, frame by frame
  causal        a window of past frames alone
  window        a window on both sides
  foveated      the last with the density acuity at the same average of samples
  cycles        Blender's Cycles (a Python with bpy: --bpy-python), adaptive sampling and OIDN on; --cycles-rates

CPU time of a frame: user and system time of the whole process with 12 frames less that with one frame, over 11, on one
thread. Both trace the frames around the clip that a window reads, so that their time cancels. Of Open Image Denoise frame
by frame: the time of a call on one thread, added to that of raw.

Scores: JOD of the clip by pyfvvdp (FovVideoVDP 1.2, foveated, gaze in the middle), every picture shown by one curve
(exposure of the clip, Reinhard, sRGB) beside a raw reference; Cycles beside one of its own where its mean is 1 %
off. `flicker`: mean absolute change, from a frame to the next, of the difference between a clip and its reference, shown.
`beside halves`: the score beside the reference less the mean of those beside its two halves, whose variance is twice as
large. About as much again would be gained beside a reference without noise. A level counts where that is below 0.1.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
import OpenEXR

from clips import FIELD_DEG, FPS, FRAMES, HEIGHT, WIDTH, clips

HERE = pathlib.Path(__file__).parent
LEVELS = (7.0, 7.5, 8.0, 8.5, 9.0)
MOST_OFF = 0.01  # of a renderer's mean light, which is then judged beside the same reference
PART_SPP = 64  # of the reference, which is made and kept in parts
WINDOW = {"causal": ("0.46s", "0s"), "window": ("0.46s", "0.46s")}
FEATURES = ["--aov", "albedo,normal"]


def options_of(row):
    """What a row adds to the command line of uniform frames; whether Open Image Denoise follows outside."""
    joined = lambda name: ["--accumulate", "window", "--accumulate-past", WINDOW[name][0], "--accumulate-future", WINDOW[name][1]]
    alone = ["--accumulate", "off"]
    return {
        "raw": (["--sampling", "uniform", "--filter", "none", *FEATURES, *alone], False),
        "oidn": (["--sampling", "uniform", "--filter", "none", *FEATURES, *alone], True),
        "joined-oidn": (["--sampling", "uniform", "--filter", "none", *FEATURES, *joined("window")], True),
        "single": (["--sampling", "uniform", "--filter", "oidn", *alone], False),
        "causal": (["--sampling", "uniform", "--filter", "oidn", *joined("causal")], False),
        "window": (["--sampling", "uniform", "--filter", "oidn", *joined("window")], False),
        "foveated": (["--sampling", "density", "--density", "acuity", "--filter", "oidn", "--gaze-at", "0.5,0.5",
                      "--screen-px", f"{WIDTH},{HEIGHT}", "--screen-ppd", f"{WIDTH / FIELD_DEG:g}", *joined("window")], False),
    }[row]


def picture_files(folder, clip):
    return [folder / f"f.{frame:04d}.exr" for frame in clip.frames]


def layer(channels, name, parts):
    whole = name or "RGB"
    if whole in channels:
        return np.asarray(channels[whole].pixels, np.float32)[..., :3]
    return np.dstack([np.asarray(channels[f"{name}.{p}" if name else p].pixels, np.float32) for p in parts])


def read(files, name="", parts="RGB"):
    return [layer(OpenEXR.File(str(f)).channels(), name, parts) for f in files]


def cpu_seconds(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(words)}\nended with {done.returncode}:\n{done.stdout[-2000:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Bench:
    def __init__(self, options):
        self.options = options
        self.out = pathlib.Path(options.out)
        self.out.mkdir(parents=True, exist_ok=True)

    def gazetrace(self, clip, name, spp, seed, words):
        """Renders a clip once; the folder and the CPU seconds of a frame."""
        folder = self.out / clip.name / f"{name}-{spp}-{seed}"
        facts = folder / "cpu.json"
        if facts.exists():
            return folder, json.loads(facts.read_text())["cpu_s_a_frame"]
        folder.mkdir(parents=True, exist_ok=True)
        command = [self.options.gazetrace, "render", *clip.words(folder), "--spp", str(spp), "--seed", str(seed), "--threads", "1",
                   "--exr-pixels", "float", "--quiet", "--overwrite", *words]
        whole = cpu_seconds([*command, "-o", str(folder / "f.####.exr")])
        first = str(clip.frames[0])
        one = cpu_seconds([*command, "--frames", first, "-o", str(folder / "one" / "f.####.exr")])
        per_frame = (whole - one) / (FRAMES - 1)
        facts.write_text(json.dumps({"cpu_s_a_frame": per_frame, "whole_s": whole, "one_s": one}))
        return folder, per_frame

    def reference(self, clip):
        """Parts of different seeds, whose mean is the reference, and the means of every other part: its halves."""
        parts = self.options.reference_spp // PART_SPP
        sums = [0.0, 0.0]
        for part in range(parts):
            words = ["--sampling", "uniform", "--filter", "none", "--accumulate", "off"]
            folder, _ = self.gazetrace(clip, "reference", PART_SPP, 9001 + part, words)
            sums[part % 2] += np.stack(read(picture_files(folder, clip))).astype(np.float64)
        halves = [total / (parts // 2) for total in sums]
        return list(np.float32(0.5 * (halves[0] + halves[1]))), [list(np.float32(half)) for half in halves]

    def cycles(self, clip, spp, seed, reference=False):
        folder = self.out / clip.name / f"cycles-{'reference-' if reference else ''}{spp}-{seed}"
        facts = folder / "cpu.json"
        if not facts.exists():
            folder.mkdir(parents=True, exist_ok=True)
            eyes = {f: [*clip.eye_at(f), *clip.target_at(f)] for f in clip.frames}
            (folder / "poses.json").write_text(json.dumps(eyes))
            words = [self.options.bpy_python, str(HERE / "cycles_clip.py"), clip.scene, str(folder), "--env", clip.environment, "--yfov",
                     str(clip.yfov_deg), "--spp", str(spp), "--seed", str(seed)] + (["--raw"] if reference else [])
            cpu_seconds(words)
            facts.write_text(json.dumps({"cpu_s_a_frame": json.loads((folder / "seconds.json").read_text())["median"]}))
        return read(picture_files(folder, clip)), json.loads(facts.read_text())["cpu_s_a_frame"]

    def row(self, clip, row, spp, seed):
        """The pictures of a row and the CPU seconds of a frame."""
        if row == "cycles":
            return self.cycles(clip, spp, seed)
        words, denoised_outside = options_of(row)
        stored = "raw" if row == "oidn" else row
        folder, seconds = self.gazetrace(clip, stored, spp, seed, words)
        files = picture_files(folder, clip)
        pictures = read(files)
        if not denoised_outside:
            return pictures, seconds
        done, times = [], []
        for picture, albedo, normal in zip(pictures, read(files, "albedo"), read(files, "normal", "XYZ")):
            begin = time.process_time()
            done.append(open_image_denoise(picture, albedo, normal))
            times.append(time.process_time() - begin)
        return done, seconds + statistics.median(times)


def open_image_denoise(picture, albedo, normal):
    import pyoidn

    whole = np.ascontiguousarray
    return np.asarray(pyoidn.denoise(whole(picture), albedo=whole(np.clip(albedo, 0, 1)), normal=whole(normal), hdr=True), np.float32)


def shown(clip, pictures):
    """Height, width, channel, frame: what a display of sRGB shows, 0 to 1."""
    light = np.clip(np.stack(pictures, -1) * 2.0**clip.exposure_ev, 0, None)
    light = np.clip(1.25 * light / (1 + light), 0, 1)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * np.maximum(light, 1e-9) ** (1 / 2.4) - 0.055).astype(np.float32)


class Judge:
    def __init__(self):
        import pyfvvdp
        import torch

        torch.set_num_threads(1)
        self.torch = torch
        geometry = pyfvvdp.fvvdp_display_geometry((WIDTH, HEIGHT), fov_horizontal=FIELD_DEG, distance_m=0.6)
        self.metric = pyfvvdp.fvvdp(display_name="standard_fhd", display_geometry=geometry, foveated=True, quiet=True)

    def jod(self, test, reference):
        tensor = self.torch.tensor
        gaze = tensor([WIDTH / 2, HEIGHT / 2])
        return float(self.metric.predict(tensor(test), tensor(reference), dim_order="HWCF", frames_per_second=FPS, fixation_point=gaze)[0])


def flicker(test, reference):
    return float(np.abs(np.diff(test - reference, axis=-1)).mean())


def seconds_at(points, level):
    """The CPU seconds at which a row reaches a JOD, between its measured rates; None beyond them."""
    points = sorted(points)
    for (s0, q0), (s1, q1) in zip(points, points[1:]):
        if min(q0, q1) <= level <= max(q0, q1) and q0 != q1:
            return float(np.exp(np.interp((level - q0) / (q1 - q0), [0, 1], np.log([s0, s1]))))
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("--gazetrace", required=True)
    parser.add_argument("--shared", required=True)
    parser.add_argument("--clips", default="sponza,san-miguel,lost-empire,walk")
    parser.add_argument("--rates", default="1,2,4,8")
    parser.add_argument("--rows", default="raw,oidn,joined-oidn,single,causal,window,foveated")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--reference-spp", type=int, default=256)
    parser.add_argument("--bpy-python", help="a Python with bpy 5.0, for the row cycles")
    parser.add_argument("--cycles-rates", default="4,16,64")
    options = parser.parse_args()
    if options.reference_spp < 2 * PART_SPP or options.reference_spp % (2 * PART_SPP) != 0:
        parser.error(f"--reference-spp: give a multiple of {2 * PART_SPP}, so that the reference has two halves")
    all_clips = clips(options.shared, HERE.parents[2])
    bench, judge, rows = Bench(options), Judge(), options.rows.split(",")
    rates = [float(r) if "." in r else int(r) for r in options.rates.split(",")]
    chosen = [all_clips[name] for name in options.clips.split(",")]
    samples = sum(len(rows) * sum(rates) * options.seeds + options.reference_spp for _ in chosen) * WIDTH * HEIGHT * FRAMES
    print(f"{len(chosen)} clips, {samples / 1e6:.0f} million samples: about {samples * 6e-6 / 3600:.1f} hours of one core at 6 us each, "
          f"Cycles not counted", flush=True)
    table = []
    for clip in chosen:
        reference, halves = bench.reference(clip)
        beside = {"gazetrace": shown(clip, reference)}
        halves = [shown(clip, half) for half in halves]
        print(f"\n{clip.name}\n\n| row | spp | JOD | beside halves | flicker | CPU ms a frame |\n| --- | --- | --- | --- | --- | --- |", flush=True)
        for row in rows:
            row_rates = [int(r) for r in options.cycles_rates.split(",")] if row == "cycles" else rates
            if row == "cycles" and "cycles" not in beside:
                if not clip.eye:
                    continue  # the walk's camera is animated in its scene
                light = np.mean(bench.cycles(clip, row_rates[-1], 1)[0]) / np.mean(reference)
                own = abs(light - 1) > MOST_OFF
                print(f"(Cycles: mean {light:.4f} of gazetrace's, {'beside a reference of its own' if own else 'the same reference'})")
                beside["cycles"] = (shown(clip, bench.cycles(clip, options.reference_spp, 9001, reference=True)[0]) if own
                                    else beside["gazetrace"])
            for spp in row_rates:
                scores, gains, flickers, seconds = [], [], [], []
                for seed in range(1, options.seeds + 1):
                    pictures, cpu_s = bench.row(clip, row, spp, seed)
                    test, truth = shown(clip, pictures), beside["cycles" if row == "cycles" else "gazetrace"]
                    scores.append(judge.jod(test, truth))
                    if row != "cycles":
                        gains.append(scores[-1] - statistics.mean(judge.jod(test, half) for half in halves))
                    flickers.append(flicker(test, truth))
                    seconds.append(cpu_s)
                result = {"clip": clip.name, "row": row, "spp": spp, "jod": statistics.mean(scores), "flicker": statistics.mean(flickers),
                          "beside_halves": statistics.mean(gains) if gains else None, "cpu_s": statistics.median(seconds)}
                table.append(result)
                gain = "-" if not gains else f"{result['beside_halves']:+.2f}"
                print(f"| {row} | {spp} | {result['jod']:.2f} | {gain} | {result['flicker']:.4f} | {1000 * result['cpu_s']:.0f} |", flush=True)
    (bench.out / "table.json").write_text(json.dumps(table, indent=1))
    print("\nCPU ms a frame at a level, by interpolation between measured rates:\n")
    print("| clip | row | " + " | ".join(f"{level} JOD" for level in LEVELS) + " |\n| --- | --- |" + " --- |" * len(LEVELS))
    for clip in chosen:
        for row in rows:
            points = [(r["cpu_s"], r["jod"]) for r in table if r["clip"] == clip.name and r["row"] == row]
            times = [seconds_at(points, level) for level in LEVELS]
            print(f"| {clip.name} | {row} | " + " | ".join("-" if t is None else f"{1000 * t:.0f}" for t in times) + " |")


main()
