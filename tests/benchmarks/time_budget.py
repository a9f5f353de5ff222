#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is `--time-budget` kept? Prints the budget and the measured wall time of every frame.

  time_budget.py GAZETRACE OUT_FOLDER --scene "NAME FILE OPTIONS" [--scene ...] [--budgets 0.5s,2s] [--size 960x540]
                 [--settings "falloff:filter ..."] [--frames 3] [--options "--gaze-at 0.5,0.5 --screen paper"]

OPTIONS are those of `gazetrace render`. The wall time of a frame is `total_ms` of timing.csv: pilots, samples, filter, view and
files. The first frame of each run is rehearsed, the others follow from those before them. Other work on the machine moves
times: the load is printed before each run, and a run that was disturbed says nothing.
"""

import argparse
import csv
import os
import pathlib
import shlex
import subprocess
import sys


def seconds(text):
    return float(text[:-2]) / 1e3 if text.endswith("ms") else float(text.removesuffix("s"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("out")
    parser.add_argument("--scene", action="append", required=True)
    parser.add_argument("--budgets", default="0.5s,2s")
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--settings", default="uniform:none uniform:guided visible:guided regions:guided")
    parser.add_argument("--options", default="--gaze-at 0.5,0.5 --screen paper")
    parser.add_argument("--frames", type=int, default=3)
    asked = parser.parse_args()
    print(f"{'scene':<14}{'fall-off':<10}{'filter':<9}{'budget':>8}{'load':>6}   seconds, off, samples a pixel of each frame")
    first, later = [], []
    for text in asked.scene:
        name, *scene = shlex.split(text)
        for setting in asked.settings.split():
            falloff, filter_name = setting.split(":")
            for budget in asked.budgets.split(","):
                folder = pathlib.Path(asked.out) / f"{name}-{falloff}-{filter_name}-{budget}"
                load = os.getloadavg()[0]
                done = subprocess.run(
                    [asked.program, "render", *scene, "--size", asked.size, *shlex.split(asked.options), "--falloff", falloff,
                     "--filter", filter_name, "--time-budget", budget, "--frames", f"1-{asked.frames}", "--quiet",
                     "--overwrite", "-o", folder / "f.####.exr"], stderr=subprocess.PIPE, text=True)
                if done.returncode != 0:
                    print(f"{name:<14}{falloff:<10}{filter_name:<9}{budget:>8} {done.stderr.strip().splitlines()[-1]}")
                    continue
                with open(folder / "timing.csv", newline="") as file:
                    rows = list(csv.DictReader(file))
                cells = []
                for i, row in enumerate(rows):
                    took = float(row["total_ms"]) / 1e3
                    off = took / seconds(budget) - 1
                    (later if i else first).append(off)
                    cells.append(f"{took:7.2f} {off:+6.1%} {int(row['samples']) / int(row['pixels']):7.2f}")
                print(f"{name:<14}{falloff:<10}{filter_name:<9}{budget:>8}{load:6.1f}  " + " |".join(cells), flush=True)
    for what, values in (("first frames", first), ("later frames", later)):
        if values:
            near = sum(abs(v) <= 0.1 for v in values)
            print(f"{what}: {near} of {len(values)} within 10 %, most off {max(values, key=abs):+.1%}")


if __name__ == "__main__":
    sys.exit(main())
