# SPDX-License-Identifier: Apache-2.0
"""What rendering in Python costs in memory. By hand:

    PYTHONPATH=build/dev/python python3 python/benchmarks/memory.py [--renders 1000] [--size 3840x2160]

1. One frame in 4K: how much Python allocates for it (tracemalloc counts NumPy's own memory), and how far the resident
   memory grows while its arrays are taken, against the size of one copy.
2. Many short renders in one process: the resident memory as they go.
"""

import argparse
import gc
import os
import time
import tracemalloc
import warnings
from pathlib import Path

import gazetrace

SCENE = Path(__file__).resolve().parents[2] / "tests/data/package/triangle.gltf"
MIB = 2.0**20


def resident_mib():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / MIB


def one_large_frame(size):
    job = gazetrace.Job(scene=SCENE, size=size, sampling="uniform", spp=1, filter="none", aov="albedo,normal,depth")
    rendering = job.render()
    frame = next(rendering)
    rendering.close()
    gc.collect()
    tracemalloc.start()
    before = resident_mib()
    held = [frame.radiance, frame.samples, frame.variance, *(frame._core.albedo, frame._core.normal, frame._core.depth)]
    held.append(frame.sampling_map.region)
    after = resident_mib()
    allocated, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    total = sum(array.nbytes for array in held) / MIB
    print(f"one frame of {size}: arrays of {total:.0f} MiB are taken (radiance alone: {held[0].nbytes / MIB:.0f} MiB)")
    print(f"  Python allocated {allocated / MIB:.3f} MiB for them, at most {peak / MIB:.3f} MiB")
    print(f"  resident memory {before:.1f} MiB before, {after:.1f} MiB after")
    copy = held[0].copy()
    print(f"  for comparison, one copy of the radiance: {resident_mib() - after:.1f} MiB more ({copy.shape})")
    del frame, held, copy
    gc.collect()
    print(f"  once all of it is let go: {resident_mib():.1f} MiB")


def many_renders(count):
    job = gazetrace.Job(scene=SCENE, gaze_at=(0.5, 0.5), screen="paper", size=(64, 36))
    begin = time.monotonic()
    print(f"{count} renders of 64x36 in one process")
    for number in range(1, count + 1):
        job.replace(seed=number).run(lambda frame: frame.radiance.mean())
        if number in (1, 10, 50) or number % max(count // 10, 1) == 0:
            gc.collect()
            print(f"  after {number:5}: resident memory {resident_mib():.1f} MiB, {time.monotonic() - begin:.1f} s",
                  flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--renders", type=int, default=1000)
    parser.add_argument("--size", default="3840x2160")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore", gazetrace.GazetraceWarning)
    many_renders(arguments.renders)
    one_large_frame(arguments.size)
