#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long a farm takes, and how long its chunks should be, for farms that are larger than ours.

    python3 tests/benchmarks/farm_model.py --table
    GAZETRACE=build/bin/gazetrace python3 tests/benchmarks/farm_model.py --measure

The model plays a farm through: N nodes take chunks from a queue in order. A chunk costs a start (the program begins, reads
its scene from a disk that all nodes share, and builds its tree) and its frames, whose costs are spread log-normally. A node
fails after an exponentially distributed time; the chunk then loses the frame in hand, waits for the queue and starts again.
In the end one machine joins: `merge` reads every file once, or the second stage of frames with history takes its time for
every frame, which no number of nodes shortens. Chunks shorter than the best one pay more starts, longer ones leave nodes
without work at the end and lose more when one fails."""

import argparse
import heapq
import math
import random
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path


@dataclass
class Farm:
    frames: int = 10_000
    frame_s: float = 60  # mean
    spread: float = 0.3  # standard deviation over the mean
    start_s: float = 10  # of a task, without reading the scene
    scene_mb: float = 1000
    disk_mb_s: float = 1000  # that all nodes share
    failures_per_node_hour: float = 1 / 720  # one a month
    requeue_s: float = 120  # Slurm's
    merge_s_per_frame: float = 0.02
    finish_s_per_frame: float = 0.0  # of a farm that traces first
    nodes: int = 100


def completion_s(farm, chunk_frames, seed=0):
    rng = random.Random(seed)
    sigma = math.sqrt(math.log(1 + farm.spread**2))
    costs = [farm.frame_s * math.exp(rng.gauss(-sigma**2 / 2, sigma)) if farm.spread > 0 else farm.frame_s for _ in range(farm.frames)]
    waiting = [(0.0, begin) for begin in range(0, farm.frames, chunk_frames)]  # from when on, and the first frame left
    ends = {begin: min(begin + chunk_frames, farm.frames) for _, begin in waiting}
    heapq.heapify(waiting)
    free = [0.0] * farm.nodes
    heapq.heapify(free)
    disk_free = last = 0.0
    while waiting:
        ready, first = heapq.heappop(waiting)
        now = max(heapq.heappop(free), ready)
        # The disk serves one reader after the other, which takes as long in all as sharing it.
        disk_free = max(disk_free, now) + farm.scene_mb / farm.disk_mb_s
        at = max(now + farm.start_s, disk_free)
        fails = now + rng.expovariate(farm.failures_per_node_hour / 3600) if farm.failures_per_node_hour > 0 else math.inf
        frame, end = first, ends[first]
        while frame < end and at + costs[frame] <= fails:
            at += costs[frame]
            frame += 1
        if frame < end:
            ends[frame] = end
            heapq.heappush(waiting, (fails + farm.requeue_s, frame))
            at = fails + farm.requeue_s  # the node is back when the queue sees it
        heapq.heappush(free, at)
        last = max(last, at)
    return last + farm.frames * (farm.merge_s_per_frame + farm.finish_s_per_frame)


def best_chunk(farm):
    """The chunk length of the shortest time, in steps of a third, by means over three farms."""
    candidates = sorted({max(1, round(1.35**k)) for k in range(25)} & set(range(1, max(2, min(400, farm.frames // 3)))))
    times = {chunk: statistics.mean(completion_s(farm, chunk, seed) for seed in range(3)) for chunk in candidates}
    best = min(times.values())
    # The longest chunk that loses less than a hundredth: fewer tasks for the queue.
    chunk = max(chunk for chunk, seconds in times.items() if seconds <= 1.01 * best)
    return chunk, times[chunk]


def table():
    print("10,000 frames of 60 s (spread 30 %), a scene of 1 GB from a disk of 1 GB/s, start 10 s, one failure a node and month\n")
    print("| nodes | frames in a chunk | hours | speed-up | part of N | with history: hours | speed-up |\n| --- | --- | --- | --- | --- | --- | --- |")
    one = completion_s(replace(Farm(), nodes=1, failures_per_node_hour=0), 10_000)
    for nodes in (10, 30, 100, 300, 1000, 3000, 10_000):
        farm = replace(Farm(), nodes=nodes)
        chunk, seconds = best_chunk(farm)
        # A finish of 0.6 s a frame: a hundredth of what a frame takes.
        _, exact_s = best_chunk(replace(farm, finish_s_per_frame=0.6, merge_s_per_frame=0))
        print(f"| {nodes} | {chunk} | {seconds / 3600:.2f} | {one / seconds:.0f} | {one / seconds / nodes:.0%} | "
              f"{exact_s / 3600:.2f} | {one / exact_s:.0f} |", flush=True)


def measure(frames):
    """Local farms on this machine, beside the model with the frame's and the start's time from one run of the job."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
    import csv

    import gliding_job
    import harness
    with tempfile.TemporaryDirectory(prefix="gazetrace_model_") as folder:
        folder = Path(folder)
        gliding_job.write_inputs(folder, frames / 24 + 1)

        def run(*words):
            begin = time.monotonic()
            done = subprocess.run([harness.PROGRAM, *map(str, words)], cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise SystemExit(done.stderr)
            return time.monotonic() - begin

        def rows(name):
            with open(folder / name / "timing.csv", newline="", encoding="utf-8") as file:
                return [float(row["total_ms"]) / 1000 for row in csv.DictReader(file)]

        def job(name):
            (folder / f"{name}.toml").write_text(gliding_job.job_toml("192x108", "512, 256, 128", frames, name, "threads = 1\n"))
            return f"{name}.toml"

        # Two at the same time, as the farms below have it: cores share what they do not have twice.
        job("beside")
        beside = subprocess.Popen([harness.PROGRAM, "render", "--config", "beside.toml", "--quiet"], cwd=folder)
        wall_s = run("render", "--config", job("one"), "--quiet")
        beside.wait()
        costs = rows("one")
        print(f"one run: {wall_s:.1f} s, {statistics.mean(costs):.3f} s a frame, spread {statistics.pstdev(costs) / statistics.mean(costs):.0%}")
        print("| processes | frames in a chunk | measured s | model s | error |\n| --- | --- | --- | --- | --- |")
        for number, (processes, chunk) in enumerate(((1, frames), (2, frames // 8), (2, frames // 20), (2, frames // 2)), 1):
            name = f"farm{number}"
            seconds = run("farm", job(name), "--chunk-frames", chunk, "--processes", processes, "--threads", "1")
            model = Farm(frames=frames, frame_s=statistics.mean(costs), spread=statistics.pstdev(costs) / statistics.mean(costs),
                         start_s=wall_s - sum(costs), scene_mb=0, failures_per_node_hour=0, requeue_s=0, merge_s_per_frame=0.001,
                         nodes=processes)
            expected = statistics.mean(completion_s(model, chunk, seed) for seed in range(5)) + 0.3  # the last looks at processes
            print(f"| {processes} | {chunk} | {seconds:.1f} | {expected:.1f} | {expected / seconds - 1:+.0%} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--frames", type=int, default=80)
    arguments = parser.parse_args()
    if arguments.measure:
        measure(arguments.frames)
    if arguments.table or not arguments.measure:
        table()


if __name__ == "__main__":
    main()
