# SPDX-License-Identifier: Apache-2.0
import gc
import json
import os
import signal
import threading
import time
import unittest

import numpy as np

import gazetrace
from gazetrace import _core
from support import COURTYARD, GAZE_LOG, TestCase, needs_program, run_program, small_job


class RenderTest(TestCase):
    def test_frames_come_in_order_with_everything_that_is_known_of_them(self):
        # Frames of a window count the samples of the frames that they trace on the way.
        job = small_job(frames="1-3", fps=10, aov="albedo,normal,depth", accumulate="off")
        seen = []
        for frame in job.render():
            seen.append(frame.frame)
            self.assertEqual(frame.radiance.shape, (36, 64, 3))
            self.assertEqual(frame.radiance.dtype, np.float32)
            self.assertTrue(np.isfinite(frame.radiance).all())
            self.assertEqual(frame.gaze, (0.5, 0.5, True))
            self.assertEqual(set(frame.aovs), {"albedo", "normal", "depth", "samples", "variance", "eccentricity"})
            self.assertEqual(frame.aovs["normal"].shape, (36, 64, 3))
            self.assertEqual(frame.timing["frame"], frame.frame)
            self.assertEqual(frame.timing["samples"], frame.sampling_map.samples)
            self.assertGreater(frame.timing["trace_ms"], 0)
            self.assertEqual(frame.display().dtype, np.uint8)
            self.assertEqual(frame.display(16).shape, (36, 64, 3))
        self.assertEqual(seen, [1, 2, 3])

    def test_arrays_are_the_frame_and_keep_it_alive(self):
        frame = next(small_job().render())
        self.assertTrue(np.shares_memory(frame.radiance, frame.radiance))
        self.assertFalse(frame.radiance.flags.owndata)
        radiance = frame.radiance
        expected = radiance.copy()
        self.assertIsInstance(radiance.base, _core.Frame)
        for picture in (radiance, frame.samples, frame.sampling_map.region):
            with self.assertRaises(ValueError):  # the frame is not theirs to change
                picture[0, 0] = 1
        del frame
        gc.collect()
        np.testing.assert_array_equal(radiance, expected)

    def test_two_runs_do_not_write_the_same_frames(self):
        """Of this process or, with the program, of another one, however the names are spelled."""
        first = small_job(output=[self.folder / "f.####.exr"], frames="1-3").render()
        next(first)
        again = small_job(output=[self.folder / "f.%04d.exr"], frames="3-4", chunk="1/1")
        self.assertSays("wait for it", "runtime", again.render)
        small_job(output=[self.folder / "f.####.exr"], frames="5-6", chunk="1/1").run()
        first.close()
        again.run()

    def test_without_outputs_nothing_is_written(self):
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        small_job().run()
        self.assertEqual(os.listdir(self.folder), [])

    def test_the_same_job_gives_the_same_bits(self):
        one, other = (next(small_job().render()) for _ in range(2))
        np.testing.assert_array_equal(one.radiance, other.radiance)
        scene = small_job().load_scene()
        shared = next(small_job().render(scene=scene))
        np.testing.assert_array_equal(one.radiance, shared.radiance)
        seed = next(small_job(seed=8).render())
        self.assertFalse(np.array_equal(one.radiance, seed.radiance))

    def test_a_callback_sees_each_frame(self):
        numbers = []
        rendering = small_job(frames="1-4").run(lambda frame: numbers.append(frame.frame))
        self.assertEqual(numbers, [1, 2, 3, 4])
        np.testing.assert_array_equal(rendering.timing["frame"], [1, 2, 3, 4])
        with self.assertRaises(ZeroDivisionError):
            small_job(frames="1-4").run(lambda frame: 1 / 0)

    def test_a_density_decides_where_samples_go(self):
        density = np.zeros((36, 64), dtype=np.float32)
        density[:, :32] = 1
        density[:, 32:] = 4
        frame = next(small_job(density=density, gaze_at=None).render())
        per_pixel = frame.sampling_map.samples_per_pixel
        self.assertAlmostEqual(float(per_pixel[:, :16].mean()), 1, delta=0.05)
        self.assertAlmostEqual(float(per_pixel[:, 48:].mean()), 4, delta=0.05)

    def test_densities_by_frame(self):
        densities = {1: np.full((9, 16), 2.0), 2: np.full((9, 16), 3.0)}
        totals = [frame.sampling_map.samples for frame in small_job(density=densities, frames="1-2").render()]
        self.assertEqual(totals, [64 * 36 * 2, 64 * 36 * 3])
        self.assertSays("(height, width)", "usage", small_job, density=np.zeros(3))
        self.assertSays("density", "input", lambda: small_job(density=np.full((2, 2), -1.0)).render())

    def test_errors_come_before_the_first_frame(self):
        self.assertSays("no scene was given; give `scene`", "usage", gazetrace.Job().render)
        self.assertSays("none.gltf", "input", gazetrace.Job(scene="none.gltf").render)

    def test_leaving_the_block_ends_the_sequence(self):
        pattern = self.folder / "frame.####.exr"
        with small_job(frames="1-100", output=[pattern]).render() as frames:
            next(frames)
        self.assertEqual(frames.left, list(range(2, 101)))
        record = json.loads((self.folder / "frame.run.json").read_text())
        self.assertIn("interrupted", json.dumps(record))
        rest = small_job(frames="1-3", output=[pattern], overwrite=True)
        self.assertEqual([frame.frame for frame in rest.render()], [1, 2, 3])

    def test_resume_renders_what_is_left(self):
        job = small_job(frames="1-5", output=[self.folder / "frame.####.exr"])
        with job.render() as frames:
            next(frames)
            next(frames)
        again = job.replace(resume=True).render()
        self.assertEqual([frame.frame for frame in again], [3, 4, 5])
        self.assertEqual(again.skipped, [1, 2])
        self.assertSays("this output exists already", "input", job.render)

    def test_keyboard_interrupt_in_the_middle_of_a_frame(self):
        job = gazetrace.Job(scene=COURTYARD, size=(1280, 720), sampling="uniform", spp=256)
        rendering = job.render()
        # A shell that starts this in the background has its children ignore the signal.
        self.addCleanup(signal.signal, signal.SIGINT, signal.signal(signal.SIGINT, signal.default_int_handler))
        timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            next(rendering)
        self.assertEqual(list(rendering), [])
        self.assertEqual(rendering.left, rendering.frames)

    def test_max_time_ends_a_sequence_with_an_error(self):
        rendering = gazetrace.Job(scene=COURTYARD, size=(1280, 720), sampling="uniform", spp=256,
                                  max_time="1s").render()
        self.assertSays("interrupted by `max_time`: 1 of 1 frames are left", "interrupted", next, rendering)

    def test_other_threads_run_while_a_frame_is_rendered(self):
        counted = 0
        done = threading.Event()

        def count():
            nonlocal counted
            while not done.is_set():
                counted += 1
                time.sleep(0.001)

        thread = threading.Thread(target=count)
        thread.start()
        before = counted
        next(small_job(size=(320, 180), spp=64, sampling="uniform").render())
        after = counted
        done.set()
        thread.join()
        self.assertGreater(after, before)

    @needs_program
    def test_equals_the_program_to_the_bit(self):
        options = {"camera": "walk", "gaze": GAZE_LOG, "size": "96x54", "frames": "1-3", "fps": "10", "seed": "5",
                   "aov": "albedo,normal,depth,variance,samples,eccentricity", "accumulate": "window",
                   "filter": "guided", "exr_pixels": "float"}  # each may find another denoiser, or none
        flags = [text for name, value in options.items() for text in (f"--{name.replace('_', '-')}", value)]
        run_program("render", COURTYARD, *flags, "-o", self.folder / "frame.####.exr", "-o",
                    self.folder / "frame.####.png", "--quiet")
        job = gazetrace.Job(scene=COURTYARD, **options)
        timing = []
        for frame in job.render():
            written = _core.read_picture(str(self.folder / f"frame.{frame.frame:04d}.exr"))
            np.testing.assert_array_equal(frame.radiance, written.pixels)
            shown = _core.read_picture(str(self.folder / f"frame.{frame.frame:04d}.png"))
            np.testing.assert_array_equal(frame.display(), np.rint(shown.pixels * 255))
            timing.append(frame.timing)
        header, *rows = (self.folder / "frame.timing.csv").read_text().splitlines()
        for row, ours in zip(rows, timing, strict=True):
            theirs = dict(zip(header.split(","), row.split(",")))
            for name in ("samples", "rays_primary", "rays_bounce", "fovea_samples", "gaze_event"):
                self.assertEqual(str(ours[name]), theirs[name])

    @needs_program
    def test_writes_the_files_of_the_program(self):
        common = ["--gaze-at", "0.5,0.5", "--screen", "paper", "--size", "64x36", "--seed", "7", "--frames", "1-2",
                  "--filter", "guided"]
        theirs, ours = self.folder / "theirs", self.folder / "ours"
        run_program("render", small_job()["scene"], *common, "-o", theirs / "frame.####.exr", "--map",
                    theirs / "map.####.exr", "--quiet")
        small_job(frames="1-2", filter="guided", output=[ours / "frame.####.exr"], map=ours / "map.####.exr").run()
        self.assertEqual(sorted(os.listdir(ours)), sorted(os.listdir(theirs)))
        for name in os.listdir(theirs):
            if name.endswith(".exr"):
                self.assertEqual((ours / name).read_bytes(), (theirs / name).read_bytes(), name)


if __name__ == "__main__":
    unittest.main()
