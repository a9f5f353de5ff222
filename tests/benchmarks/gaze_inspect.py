#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long `gazetrace gaze inspect` takes for an hour of binocular gaze at 1000 Hz, 3.6 million samples, and how much
memory at most. Makes the logs itself: EyeLink ASC, gazetrace CSV with a row for each eye, the same with a row for the
mean as well (as `gaze import` writes it), and a TSV of one's own.

  tests/benchmarks/gaze_inspect.py build/dev/bin/gazetrace [--seconds 3600] [--folder build/gaze_hour]
"""

import argparse
import json
import math
import os
import random
import subprocess
import time
from pathlib import Path

RATE_HZ = 1000
BLOCK_S = 20  # of movements, which then repeat
CSV_HEAD = ("# gazetrace-gaze 1\n# display_px 1920 1080\n# display_mm 510 287\n# distance_mm 650\n"
            "t[ns],u[1],v[1],valid,eye,pupil\n")


def movements(seed=7):
    """x, y of both eyes in pixels of 1920 x 1080 and pupils; None in a blink. Fixations, saccades, drift and noise."""
    rng = random.Random(seed)
    x, y = 960.0, 540.0
    samples = []
    while len(samples) < BLOCK_S * RATE_HZ:
        for _ in range(rng.randint(180, 420)):
            x += rng.gauss(0, 0.05)
            y += rng.gauss(0, 0.05)
            samples.append((x + rng.gauss(0, 0.4), y + rng.gauss(0, 0.4), x + 8 + rng.gauss(0, 0.4), y + 3 + rng.gauss(0, 0.4)))
        if rng.random() < 0.05:
            samples.extend([None] * rng.randint(90, 180))
        to_x, to_y = rng.uniform(200, 1720), rng.uniform(150, 930)
        steps = int(20 + math.hypot(to_x - x, to_y - y) / 20)
        for i in range(1, steps + 1):
            share = 0.5 - 0.5 * math.cos(math.pi * i / steps)
            at = (x + share * (to_x - x), y + share * (to_y - y))
            samples.append((at[0], at[1], at[0] + 8, at[1] + 3))
        x, y = to_x, to_y
    return samples[: BLOCK_S * RATE_HZ]


def write_blocks(path, head, tails, seconds, line):
    """`line(time in ms, tail)`; the tails of a block repeat."""
    with open(path, "w", encoding="ascii", newline="\n") as file:
        file.write(head)
        for first in range(0, seconds * RATE_HZ, len(tails)):
            file.write("".join([line(5_000_000 + first + i, tail) for i, tail in enumerate(tails)]))


def make_logs(folder, seconds):
    folder.mkdir(parents=True, exist_ok=True)
    block = movements()
    logs = {}
    asc = []
    both = []
    mean = []
    tsv = []
    for sample in block:
        if sample is None:
            asc.append("\t   .\t   .\t    0.0\t   .\t   .\t    0.0\t.....\n")
            both.append((",,,lost,left,\n", ",,,lost,right,\n"))
            mean.append((",,,lost,cyclopean,\n", *both[-1]))
            tsv.append("\t\t\t\t\t\n")
            continue
        lx, ly, rx, ry = sample
        asc.append(f"\t {lx:6.1f}\t {ly:6.1f}\t 1103.0\t {rx:6.1f}\t {ry:6.1f}\t 1085.0\t.....\n")
        both.append((f",{lx / 1920:.6f},{ly / 1080:.6f},ok,left,1103\n", f",{rx / 1920:.6f},{ry / 1080:.6f},ok,right,1085\n"))
        mean.append((f",{(lx + rx) / 3840:.6f},{(ly + ry) / 2160:.6f},ok,cyclopean,1094\n", *both[-1]))
        tsv.append(f"\t{lx:.2f}\t{ly:.2f}\t{rx:.2f}\t{ry:.2f}\t3.41\n")

    logs["EyeLink ASC"] = (folder / "hour.asc", [])
    write_blocks(logs["EyeLink ASC"][0],
                 "** CONVERTED FROM hour.edf\n** TYPE: EDF_FILE BINARY EVENT SAMPLE TAGGED\n** VERSION: EYELINK II 1\n"
                 "MSG\t4999000 GAZE_COORDS 0.00 0.00 1919.00 1079.00\n"
                 "START\t5000000 \tLEFT\tRIGHT\tSAMPLES\tEVENTS\nPRESCALER\t1\nVPRESCALER\t1\nPUPIL\tAREA\n"
                 "SAMPLES\tGAZE\tLEFT\tRIGHT\tRATE\t1000.00\tTRACKING\tCR\tFILTER\t2\n",
                 asc, seconds, lambda t, tail: f"{t}{tail}")
    with open(logs["EyeLink ASC"][0], "a", encoding="ascii") as file:
        file.write(f"END\t{5_000_000 + seconds * RATE_HZ} \tSAMPLES\tEVENTS\tRES\t  36.00\t  36.00\n")

    logs["gazetrace CSV, a row an eye"] = (folder / "hour.csv", [])
    write_blocks(logs["gazetrace CSV, a row an eye"][0], CSV_HEAD, both, seconds,
                 lambda t, tail: f"{t}000000{tail[0]}{t}000000{tail[1]}")

    logs["gazetrace CSV, three rows a time"] = (folder / "hour3.csv", [])
    write_blocks(logs["gazetrace CSV, three rows a time"][0], CSV_HEAD, mean, seconds,
                 lambda t, tail: f"{t}000000{tail[0]}{t}000000{tail[1]}{t}000000{tail[2]}")

    logs["TSV with a column map"] = (folder / "hour.tsv", ["--columns", str(folder / "map.json"), "--screen-px", "1920,1080"])
    (folder / "map.json").write_text(json.dumps({
        "time": "clock", "time_unit": "ms", "position_unit": "px",
        "left": {"x": "left x", "y": "left y", "pupil": "pupil"}, "right": {"x": "right x", "y": "right y", "pupil": "pupil"}}))
    write_blocks(logs["TSV with a column map"][0], "clock\tleft x\tleft y\tright x\tright y\tpupil\n", tsv, seconds,
                 lambda t, tail: f"{t}.0{tail}")
    return logs


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--seconds", type=int, default=3600)
    parser.add_argument("--folder", type=Path, default=Path("build/gaze_hour"))
    arguments = parser.parse_args()
    measure(arguments, make_logs(arguments.folder, arguments.seconds))


def measure(arguments, logs):
    print(f"{'log':<33} {'MiB':>7} {'samples':>9} {'s':>7} {'CPU s':>7} {'peak MiB':>9}")
    for name, (path, flags) in logs.items():
        begin = time.perf_counter()
        process = subprocess.Popen([arguments.program, "gaze", "inspect", path, *flags, "--json"], stdout=subprocess.PIPE)
        text = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - begin
        if status != 0:
            raise SystemExit(f"{name}: failed")
        report = json.loads(text)
        accused = [finding for finding in report["findings"] if finding["kind"] != "note"]
        print(f"{name:<33} {path.stat().st_size / 2**20:7.0f} {report['samples']:9} {seconds:7.2f} {usage.ru_utime + usage.ru_stime:7.2f} {usage.ru_maxrss / 1024:9.0f}"
              f"{'  ' + report['verdict'] if accused else ''}")


if __name__ == "__main__":
    main()
