#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long a farm takes, and how long its chunks should be, for farms that are larger than ours.

    python3 tests/benchmarks/farm_model.py --table
    GAZETRACE=build/bin/gazetrace python3 tests/benchmarks/farm_model.py --measure

The model plays a farm through: N nodes take chunks from a queue in order. A chunk costs a start (the program begins, reads
its scene from a disk that all nodes share, and builds its tree) and its frames, whose costs are spread log-normally. A node
fails after an exponentially distributed time; the chunk then loses the frame in hand, waits for the queue and starts again.
In the end one machine joins: `merge` reads every file once. Chunks shorter than the best one pay more starts, longer ones leave nodes
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
    return last + farm.frames * farm.merge_s_per_frame


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
    print("| nodes | frames in a chunk | hours | speed-up | part of N |\n| --- | --- | --- | --- | --- |")
    one = completion_s(replace(Farm(), nodes=1, failures_per_node_hour=0), 10_000)
    for nodes in (10, 30, 100, 300, 1000, 3000, 10_000):
        farm = replace(Farm(), nodes=nodes)
        chunk, seconds = best_chunk(farm)
        print(f"| {nodes} | {chunk} | {seconds / 3600:.2f} | {one / seconds:.0f} | {one / seconds / nodes:.0%} |", flush=True)


def measure(frames, size):
    """Local farms on this machine, beside the model. What a frame costs comes from one run of the job, with as many others at
    work as the farm has processes; what a task's start and a farm's own work cost, from two farms of a few short tasks."""
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

        def job(name, count):
            (folder / f"{name}.toml").write_text(gliding_job.job_toml(size, "512, 256, 128", count, name, "threads = 1\n"))
            return f"{name}.toml"

        def farm(name, count, chunk, processes):
            return run("farm", job(name, count), "--chunks", -(-count // chunk), "--processes", processes, "--threads", "1")

        def costs(processes):
            """Of each frame, while as many runs are at work: cores share what they do not have twice."""
            names = [f"cost-{processes}-{number}" for number in range(processes)]
            runs = [subprocess.Popen([harness.PROGRAM, "render", "--config", job(name, frames), "--quiet"], cwd=folder) for name in names]
            for one in runs:
                one.wait()
            with open(folder / names[0] / "f.timing.csv", newline="", encoding="utf-8") as file:
                return [float(row["total_ms"]) / 1000 for row in csv.DictReader(file)]

        print("| processes | frames in a chunk | a frame s | spread | a start s | measured s | model s | error |\n"
              "| --- | --- | --- | --- | --- | --- | --- | --- |")
        for processes, chunks in ((1, (frames,)), (2, (frames // 2, frames // 8, frames // 20))):
            frame_costs = costs(processes)
            frame_s = statistics.mean(frame_costs)
            few, many = 2 * processes, 8 * processes
            few_s, many_s = (statistics.median(farm(f"start-{processes}-{count}-{k}", count, 1, processes) for k in range(3))
                             for count in (few, many))
            start_s = (many_s - few_s) / (many - few) * processes - frame_s
            fixed_s = few_s - few / processes * (start_s + frame_s)
            for chunk in chunks:
                seconds = farm(f"farm-{processes}-{chunk}", frames, chunk, processes)
                model = Farm(frames=frames, frame_s=frame_s, spread=statistics.pstdev(frame_costs) / frame_s, start_s=start_s,
                             scene_mb=0, failures_per_node_hour=0, requeue_s=0, merge_s_per_frame=0, nodes=processes)
                expected = statistics.mean(completion_s(model, chunk, seed) for seed in range(5)) + fixed_s
                print(f"| {processes} | {chunk} | {frame_s:.3f} | {model.spread:.0%} | {start_s:.2f} | {seconds:.1f} | {expected:.1f} | "
                      f"{expected / seconds - 1:+.0%} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--frames", type=int, default=80)
    parser.add_argument("--size", default="320x180", help="of the frames that are measured")
    arguments = parser.parse_args()
    if arguments.measure:
        measure(arguments.frames, arguments.size)
    if arguments.table or not arguments.measure:
        table()


if __name__ == "__main__":
    main()
