# SPDX-License-Identifier: Apache-2.0
"""What a perception scientist writes: events of a log, logs and arrays as the gaze of a job, pieces, pictures, durations."""

import datetime
import json
import struct
import sys
import unittest
import warnings
import zlib

import numpy as np

import gazetrace
from support import COURTYARD, GAZE_LOG, ROOT, SCENE, TestCase, needs_program, run_program

sys.path.append(str(ROOT / "tests/cli"))
from exr_reader import Exr  # noqa: E402  a reader of the tests' own

SMALL = {"scene": COURTYARD, "camera": "walk", "size": (32, 18), "fps": 10, "region_samples": (1, 1, 1), "screen": "paper"}


def pixels_of(png):
    """Of a PNG without filters: 8 or 16 bits a channel."""
    at, chunks = 8, {}
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        chunks[kind] = png[at + 8:at + 8 + length]
        assert zlib.crc32(kind + chunks[kind]) == struct.unpack(">I", png[at + 8 + length:at + 12 + length])[0]
        at += length + 12
    width, height, bits, color = struct.unpack(">IIBB", chunks[b"IHDR"][:10])
    assert color == 2
    lines = np.frombuffer(zlib.decompress(chunks[b"IDAT"]), np.uint8).reshape(height, -1)
    assert not lines[:, 0].any()
    return lines[:, 1:].copy().view(f">u{bits // 8}").reshape(height, width, 3)


class EventsTest(TestCase):
    @needs_program
    def test_events_are_those_of_the_program(self):
        for method in ("auto", "idt"):
            found = gazetrace.read_gaze(GAZE_LOG).detect_events(method)
            run = run_program("gaze", "events", GAZE_LOG, "--method", method, "--json")
            expected = json.loads(run.stdout)["events"]
            self.assertEqual(list(found.movement), [event["movement"] for event in expected])
            np.testing.assert_array_equal(found.onset_ns, [event["onset_ns"] for event in expected])
            np.testing.assert_allclose(found.duration_ms, [event["duration_ms"] for event in expected])

    def test_events_are_a_table(self):
        log = gazetrace.read_gaze(GAZE_LOG)
        events = log.detect_events()
        fixations = events.fixations
        self.assertGreater(len(fixations), 3)
        self.assertEqual(set(fixations.movement), {"fixation"})
        self.assertEqual(len(fixations) + len(events.saccades) + len(events.blinks), sum(events.movement[:, None] == ["fixation", "saccade", "blink"]).sum())
        self.assertAlmostEqual(fixations.onset_s[0], (fixations.onset_ns[0] - log.t_ns[0]) * 1e-9)
        self.assertEqual(fixations[0]["duration_ms"], fixations["duration_ms"][0])
        self.assertEqual(len(fixations[fixations.duration_ms > 1e9]), 0)
        self.assertEqual([row["onset_ns"] for row in fixations[:2]], list(fixations.onset_ns[:2]))
        self.assertRegex(repr(fixations), r"<Events of \d+ rows: movement, onset_s")
        self.assertIn("<th>movement</th>", fixations._repr_html_())
        self.assertSays("unknown", "usage", log.detect_events, "ivtt")
        self.assertSays("desktop", "usage", log.detect_events, device="phone")

    @needs_program
    def test_processed_gaze_and_doubts_are_those_of_the_program(self):
        path = ROOT / "gazelogs/tx300_left.csv"
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            gazetrace.read_gaze(path).detect_events()
        self.assertEqual(len(caught), 1)
        self.assertIn("saccades for", str(caught[0].message))
        self.assertIn("`gaze_process` median:samples=5", str(caught[0].message))
        found = gazetrace.read_gaze(path).process("median:samples=5", "fill-gaps").detect_events()
        run = run_program("gaze", "events", path, "--gaze-process", "median:samples=5", "--gaze-process", "fill-gaps", "--json")
        np.testing.assert_array_equal(found.onset_ns, [event["onset_ns"] for event in json.loads(run.stdout)["events"]])
        self.assertSays("did you mean 'median'", "usage", gazetrace.read_gaze(path).process, "medn")

    def test_texts_of_messages_are_hidden(self):
        path = self.folder / "log.asc"
        lines = ["MSG\t1000 DISPLAY_COORDS 0 0 1023 767", "START\t1000 \tLEFT\tSAMPLES\tEVENTS", "SAMPLES\tGAZE\tLEFT\tRATE\t250.00\tTRACKING\tCR", "MSG\t1004 Ada Lovelace"]
        lines += [f"{1000 + 4 * i}\t 500.0\t 300.0\t 900.0\t..." for i in range(100)] + ["END\t1400 \tSAMPLES\tEVENTS\tRES\t  35.00\t  35.00"]
        path.write_text("\n".join(lines) + "\n")
        hidden, kept = gazetrace.read_gaze(path).events, gazetrace.read_gaze(path, keep_ids=True).events
        self.assertNotIn("Ada Lovelace", "".join(hidden.text))
        self.assertIn("Ada Lovelace", "".join(kept.text))
        self.assertEqual(list(hidden.type), list(kept.type))


class GazeOfAJobTest(TestCase):
    def gaze_of_frames(self, gaze, **options):
        plan = gazetrace.Job(gaze=gaze, frames=range(1, 5), **{**SMALL, **options}).plan()
        return np.stack([plan.u, plan.v])

    def test_a_log_is_the_file_it_was_read_from(self):
        expected = self.gaze_of_frames(GAZE_LOG)
        np.testing.assert_array_equal(self.gaze_of_frames(gazetrace.read_gaze(GAZE_LOG)), expected)
        self.assertTrue(np.isfinite(expected).any())

    def test_arrays_and_tables(self):
        t = np.arange(100) * 0.005
        u, v = 0.3 + 0.4 * t, 0.5 + 0.1 * t
        # Frames of 10 Hz are seen in their middle; the gaze is a straight line.
        middles = (np.arange(4) + 0.5) / 10
        expected = np.stack([0.3 + 0.4 * middles, 0.5 + 0.1 * middles])
        for gaze in (np.c_[t, u, v], {"t_s": t, "u": u, "v": v}, {"t_ns": (t * 1e9).astype(int), "u": u, "v": v}):
            np.testing.assert_allclose(self.gaze_of_frames(gaze), expected, atol=2e-3)
        self.assertSays("three columns", "usage", gazetrace.Job, gaze=np.zeros((4, 2)))
        nowhere = gazetrace.Job(**{**SMALL, "screen": None}, gaze=np.array([[0, 0.5, 0.5], [1, 0.5, 0.5]]))
        for method in (nowhere.plan, nowhere.outlines, nowhere.render):  # no message names the temporary file
            with self.assertRaisesRegex(gazetrace.Error, "^`gaze`: gaze on a screen needs"):
                method()
        self.assertSays("columns t_s", "usage", gazetrace.Job, gaze={"u": u, "v": v})
        job = gazetrace.Job(gaze=np.c_[t, u, v], frames=1, **SMALL).replace(frames=range(1, 3))
        self.assertEqual(len(job.plan()), 2)
        self.assertIn("gaze=<gaze of 100 samples>, ", repr(job))
        self.assertIn("gaze=<GazeLog saccades_blinks.csv: ", repr(gazetrace.Job(gaze=gazetrace.read_gaze(GAZE_LOG))))
        self.assertSays("row 50 is at 0 s after 0.245 s; sort the rows", "usage", gazetrace.Job, gaze=np.c_[t % 0.25, u, v])
        self.assertSays("far beside it, such as 640, 360; divide pixels", "usage", gazetrace.Job, gaze=np.c_[t, 0 * t + 640, 0 * t + 360])

    def test_durations(self):
        job = gazetrace.Job(gaze_latency=0.05, gaze_start=datetime.timedelta(milliseconds=250))
        other = gazetrace.Job(gaze_latency="50ms", gaze_start="250ms")
        self.assertEqual((job["gaze_latency"], job["gaze_start"]), (other["gaze_latency"], other["gaze_start"]))
        self.assertEqual(gazetrace.Job(gaze_start=np.timedelta64(250, "ms"))["gaze_start"], job["gaze_start"])

    def test_names_are_checked_when_they_are_given(self):
        for options, words in (({"filter": "gidued"}, "did you mean 'guided'"), ({"gaze_process": "medn"}, "did you mean 'median'"),
                               ({"aov": "albeod"}, "did you mean 'albedo'"), ({"screen": "papre"}, "did you mean 'paper'")):
            self.assertSays(words, "usage", gazetrace.Job, **options)
            self.assertSays(words, "usage", gazetrace.Job().replace, **options)

    def test_names_of_columns_are_checked(self):
        log = gazetrace.read_gaze(GAZE_LOG)
        events, plan = log.detect_events(), gazetrace.Job(gaze=log, frames=range(1, 4), **SMALL).plan()
        for error, call, words in ((KeyError, lambda: events["duration"], "did you mean 'duration_ms'?"), (AttributeError, lambda: events.fixatons, "did you mean 'fixations'?"),
                                   (AttributeError, lambda: events.fixations.duration, "did you mean 'duration_ms'?"), (KeyError, lambda: log["pupl"], "did you mean 'pupil'?"),
                                   (KeyError, lambda: plan["gaze_true"], "did you mean 'gaze_true_"), (IndexError, lambda: plan[3], "no row 3: there are 3"),
                                   (IndexError, lambda: plan.sampling_map(3), "no row 3: there are 3"), (IndexError, lambda: events[len(events)], "there is no row")):
            with self.assertRaises(error) as raised:
                call()
            self.assertIn(words, str(raised.exception))
        self.assertEqual((plan[1]["frame"], plan[-1]["frame"], plan[1]["gaze_render_u"]), (2, 3, plan.u[1]))

    def test_commands_in_messages_are_those_of_the_program(self):
        path = self.folder / "pixels.csv"
        path.write_text("time,x,y\n" + "".join(f"{4 * i},{400 + i},{300 + i % 7}\n" for i in range(200)))
        with self.assertRaises(gazetrace.Error) as raised:
            gazetrace.read_gaze(path)
        self.assertRegex(str(raised.exception), r"gazetrace gaze import \S+pixels.csv -o gaze.csv --unit px --screen-px W,H")

    def test_one_warning_says_all(self):
        lost = np.c_[np.arange(10) / 10, np.full(10, np.nan), np.full(10, 0.5)]
        job = gazetrace.Job(gaze=lost, frames=range(1, 3), **SMALL)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            job.plan()
        self.assertEqual(len(caught), 1)
        self.assertGreater(len(str(caught[0].message).splitlines()), 1)
        self.assertEqual(caught[0].filename, __file__)  # where it was called


class PiecesTest(TestCase):
    def test_slices(self):
        log = gazetrace.read_gaze(GAZE_LOG)
        part = log[100:200]
        np.testing.assert_array_equal(part.t_ns, log.t_ns[100:200])
        np.testing.assert_array_equal(part.u, log.u[100:200])
        np.testing.assert_array_equal(log["u"], log.u)
        self.assertEqual(len(log[-10:]), 10)
        self.assertRaises(IndexError, lambda: log[5:5])
        self.assertRaises(TypeError, lambda: log[::2])
        plan = gazetrace.Job(gaze=GAZE_LOG, frames=range(1, 7), **SMALL).plan()
        np.testing.assert_array_equal(plan[2:5].frame, [3, 4, 5])
        np.testing.assert_array_equal(plan[2:5].samples, plan.samples[2:5])
        self.assertEqual(plan[2:5].sampling_map(0).samples, plan.sampling_map(2).samples)

    def test_what_a_notebook_shows(self):
        log = gazetrace.read_gaze(GAZE_LOG)
        self.assertRegex(repr(log), rf"<GazeLog saccades_blinks\.csv: {len(log)} samples of gaze on a screen in [0-9.]+ s, [0-9.]+ Hz, [0-9.]+ % usable>")
        self.assertIn("<th>t_ns</th>", log._repr_html_())
        # The rate is that of the samples, whatever pauses there are.
        path = self.folder / "blocks.csv"
        path.write_text("# gazetrace-gaze 1\nt[ns],u[1],v[1],valid,eye\n" + "".join(f"{(i + 5000 * (i > 99)) * 2_000_000},0.5,0.5,ok,cyclopean\n" for i in range(200)))
        self.assertIn("200 samples of gaze on a screen in 10.4 s, 500 Hz", repr(gazetrace.read_gaze(path)))
        plan = gazetrace.Job(gaze=GAZE_LOG, frames=range(1, 4), **SMALL).plan()
        self.assertRegex(repr(plan), r"<Plan of 3 frames: 1 to 3, [0-9.]+ % with gaze>")
        self.assertIn("<th>frame</th>", plan._repr_html_())
        self.assertRegex(repr(plan.sampling_map(0)), r"<SamplingMap 32x18: \d+ samples in 3 regions>")
        self.assertIn("<th>samples</th>", plan.sampling_map(0)._repr_html_())

    def test_frames_are_saved(self):
        frame = next(iter(gazetrace.Job(scene=SCENE, size=(32, 18), frames=1, sampling="uniform", spp=1, gaze_at=(0.5, 0.5), screen="paper").render()))
        for bits in (8, 16):
            frame.save(self.folder / "f.png", bits)
            np.testing.assert_array_equal(pixels_of((self.folder / "f.png").read_bytes()), frame.display(bits))
        np.testing.assert_array_equal(pixels_of(frame._repr_png_()), frame.display())
        frame.save(self.folder / "f.npy")
        np.testing.assert_array_equal(np.load(self.folder / "f.npy"), frame.radiance)
        frame.save(self.folder / "f.exr")
        written = Exr(self.folder / "f.exr")
        for c, name in enumerate("RGB"):
            np.testing.assert_array_equal(np.array(written.channel(name)).reshape(18, 32), frame.radiance[..., c])
        self.assertSays(".png, .exr or .npy", "usage", frame.save, "f.gif")
        self.assertEqual(frame.eccentricity.shape, (18, 32))
        self.assertAlmostEqual(frame.t_s, frame.request["t_video_ns"] / 1e9, 12)
        self.assertLess(frame.eccentricity[9, 16], frame.eccentricity[0, 0])


if __name__ == "__main__":
    unittest.main()
