# SPDX-License-Identifier: Apache-2.0
import gc
import os
import tracemalloc
import unittest

from support import TestCase, small_job


def resident_mib():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


class MemoryTest(TestCase):
    """In small; python/benchmarks/memory.py measures the same with a 4K frame and with 1,000 renders."""

    def test_taking_a_frame_copies_nothing(self):
        rendering = small_job(size=(640, 360), sampling="uniform", spp=1, filter="none").render()
        frame = next(rendering)
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        held = [frame.radiance, frame.samples, frame.variance, frame.sampling_map.region]
        allocated, _ = tracemalloc.get_traced_memory()
        self.assertGreater(sum(array.nbytes for array in held), 4_000_000)
        self.assertLess(allocated, 40_000)
        frame.radiance.copy()  # what a copy would have been, since NumPy tells tracemalloc of its memory
        self.assertGreater(tracemalloc.get_traced_memory()[1], 2_000_000)

    def test_renders_leave_nothing_behind(self):
        for seed in range(20):
            small_job(seed=seed).run()
        gc.collect()
        before = resident_mib()
        for seed in range(60):
            small_job(seed=seed).run()
        gc.collect()
        self.assertLess(resident_mib() - before, 8)


if __name__ == "__main__":
    unittest.main()
