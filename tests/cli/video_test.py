# SPDX-License-Identifier: Apache-2.0
"""`gazetrace video` from outside, its files read back by ffprobe and ffmpeg where they are installed."""

import json
import shutil
import signal
import subprocess
import unittest

import harness

FFMPEG = shutil.which("ffmpeg") and shutil.which("ffprobe")
NEEDS_FFMPEG = unittest.skipUnless(FFMPEG, "ffmpeg and ffprobe are not installed")


class Video(harness.CliTest):
    def sequence(self, name="p", width=48, height=32, frames=5, pixel=lambda n, x, y: (40 * n, 4 * x, 6 * y)):
        for n in range(1, frames + 1):
            self.write(f"{name}.{n:04}.png", harness.png(width, height, lambda x, y: pixel(n, x, y)))

    def render(self, folder, *more):
        self.write("gaze.csv", harness.moving_gaze())
        self.run_ok("render", "box.gltf", "--gaze", "gaze.csv", "--size", "128x72", "--frames", "1-4", "--fps", "30000/1001",
                    "-o", f"{folder}/p.####.exr", "-o", f"{folder}/p.####.png", "--quiet", *harness.SCREEN, *more)

    def probe(self, name):
        text = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_streams", "-show_format", "-of", "json", name],
                              cwd=self.folder, capture_output=True, check=True).stdout
        result = json.loads(text)
        return result["streams"][0], result["format"]

    def pixels(self, name, width, height):
        raw = subprocess.run(["ffmpeg", "-v", "error", "-i", name, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], cwd=self.folder,
                             capture_output=True, check=True).stdout
        size = 3 * width * height
        return [raw[at:at + size] for at in range(0, len(raw), size)]

    @NEEDS_FFMPEG
    def test_ffv1_gives_back_every_bit(self):
        self.sequence()
        self.run_ok("video", "p.####.png", "-o", "out.mkv", "--codec", "ffv1", "--fps", "24")
        frames = self.pixels("out.mkv", 48, 32)
        self.assertEqual(len(frames), 5)
        for n, frame in enumerate(frames, 1):
            self.assertEqual(frame, bytes(c for y in range(32) for x in range(48) for c in (40 * n, 4 * x, 6 * y)))
        stream, _ = self.probe("out.mkv")
        self.assertEqual((stream["codec_name"], stream["color_primaries"], stream["color_transfer"]), ("ffv1", "bt709", "iec61966-2-1"))

    @NEEDS_FFMPEG
    def test_h264_and_hevc_say_their_colors_and_rate(self):
        # Gray and primaries at full size: the matrix and range of the decoder undo those of the encoder.
        colors = [(128, 128, 128), (220, 30, 30), (30, 220, 30), (30, 30, 220), (255, 255, 255), (0, 0, 0)]
        self.sequence(width=96, height=64, frames=3, pixel=lambda n, x, y: colors[x // 16])
        for codec, name in (("h264", "h264"), ("hevc", "hevc")):
            with self.subTest(codec):
                self.run_ok("video", "p.####.png", "-o", f"{codec}.mp4", "--codec", codec, "--fps", "30000/1001", "--crf", "1")
                stream, _ = self.probe(f"{codec}.mp4")
                self.assertEqual(stream["codec_name"], name)
                self.assertEqual((stream["color_space"], stream["color_primaries"], stream["color_transfer"], stream["color_range"]),
                                 ("bt709", "bt709", "iec61966-2-1", "tv"))
                self.assertEqual((stream["r_frame_rate"], stream["nb_read_frames"]), ("30000/1001", "3"))
                frame = self.pixels(f"{codec}.mp4", 96, 64)[1]
                for i, color in enumerate(colors):
                    at = 3 * (32 * 96 + 16 * i + 8)
                    for given, got in zip(color, frame[at:at + 3]):
                        self.assertLessEqual(abs(given - got), 4, f"{codec} {color}")

    @NEEDS_FFMPEG
    def test_odd_sizes_grow_by_a_repeated_edge(self):
        self.sequence(width=47, height=31)
        self.run_ok("video", "p.####.png", "-o", "out.mp4", "--fps", "24")
        stream, _ = self.probe("out.mp4")
        self.assertEqual((stream["width"], stream["height"]), (48, 32))
        self.run_ok("video", "p.####.png", "-o", "out.mkv", "--codec", "ffv1", "--fps", "24")
        stream, _ = self.probe("out.mkv")
        self.assertEqual((stream["width"], stream["height"]), (47, 31))

    @NEEDS_FFMPEG
    def test_every_second_frame_keeps_time(self):
        self.sequence()
        self.run_ok("video", "p.####.png", "-o", "out.mkv", "--fps", "24", "--frames", "1-5x2")
        stream, _ = self.probe("out.mkv")
        self.assertEqual((stream["r_frame_rate"], stream["nb_read_frames"]), ("12/1", "3"))

    @NEEDS_FFMPEG
    def test_a_run_gives_rate_colors_gaze_and_a_warning_to_viewers(self):
        self.render("fov")
        self.render("uni", "--sampling", "uniform", "--spp", "2")
        result = self.run_ok("video", "fov/p.####.exr", "-o", "plain.mkv", "--codec", "ffv1")
        self.assertIn("viewers look elsewhere", result.stdout)
        stream, container = self.probe("plain.mkv")
        self.assertEqual(stream["r_frame_rate"], "30000/1001")
        tags = {name.lower(): text for name, text in container["tags"].items()}
        self.assertIn("viewers look elsewhere", tags["comment"])
        plain = self.pixels("plain.mkv", 128, 72)
        # The pictures that the run wrote itself, but for the half floats of the .exr files.
        self.run_ok("video", "fov/p.####.png", "-o", "png.mkv", "--codec", "ffv1")
        for from_png, from_exr in zip(self.pixels("png.mkv", 128, 72), plain, strict=True):
            self.assertLessEqual(max(abs(a - b) for a, b in zip(from_png, from_exr, strict=True)), 1)
        # The ring moves with the gaze: 0.2 + 0.6 t, t in the middle of a frame, the last sample before it.
        self.run_ok("video", "fov/p.####.exr", "-o", "gaze.mkv", "--codec", "ffv1", "--show-gaze")
        for n, (with_ring, without) in enumerate(zip(self.pixels("gaze.mkv", 128, 72), plain)):
            differing = [i // 3 % 128 for i in range(0, len(without), 3) if with_ring[i:i + 3] != without[i:i + 3]]
            t = (n + 0.5) * 1001 / 30000
            self.assertAlmostEqual(sum(differing) / len(differing) + 0.5, 128 * (0.2 + 0.6 * t), delta=1.5)
        # Display pictures know the gaze as well.
        self.run_ok("video", "fov/p.####.png", "-o", "png_gaze.mkv", "--codec", "ffv1", "--show-gaze")
        self.assertNotEqual(self.pixels("png_gaze.mkv", 128, 72), self.pixels("png.mkv", 128, 72))
        for mark in ("--show-rings", "--fixation-mark"):
            self.run_ok("video", "fov/p.####.exr", "-o", "mark.mkv", "--codec", "ffv1", mark, "--overwrite")
            self.assertNotEqual(self.pixels("mark.mkv", 128, 72), plain)
        self.run_ok("video", "fov/p.####.exr", "uni/p.####.exr", "-o", "both.mkv", "--codec", "ffv1")
        both = self.pixels("both.mkv", 256, 72)
        self.assertEqual(b"".join(both[0][3 * 256 * y:3 * (256 * y + 128)] for y in range(72)), plain[0])
        result = self.run_ok("video", "uni/p.####.exr", "-o", "uni.mp4")
        self.assertNotIn("viewers", result.stdout)

    @NEEDS_FFMPEG
    def test_labels_say_what_is_shown(self):
        """White dots on a dark ground in the corner of each sequence, of the letters and nothing else."""
        self.sequence("a", 96, 64, 1, lambda n, x, y: (100, 100, 100))
        self.sequence("b", 96, 64, 1, lambda n, x, y: (100, 100, 100))
        self.run_ok("video", "a.####.png", "b.####.png", "-o", "a:b.mkv", "--codec", "ffv1", "--fps", "24", "--labels", "L, t-")
        frame = self.pixels("./a:b.mkv", 192, 64)[0]
        white = {(i // 3 % 192, i // 3 // 192) for i in range(0, len(frame), 3) if frame[i:i + 3] == b"\xff\xff\xff"}
        column, row = 4 + 2, 4 + 2
        letter_l = {(column, row + y) for y in range(7)} | {(column + x, row + 6) for x in range(5)}
        column += 96
        letter_t = {(column + x, row) for x in range(5)} | {(column + 2, row + y) for y in range(7)}
        dash = {(column + 6 + x, row + 3) for x in range(5)}
        self.assertEqual(white, letter_l | letter_t | dash)
        self.assert_refused(["video", "a.####.png", "-o", "c.mkv", "--fps", "24", "--labels", "one,two"], ["--labels", "2 for 1 sequence"])

    @NEEDS_FFMPEG
    def test_insets_show_gaze_and_periphery_three_times_as_large(self):
        """Every pixel of a picture of its own color, so that each pixel below tells which it shows."""
        self.sequence("a", 96, 72, 1, lambda n, x, y: (2 * x, 3 * y, 77))
        self.run_ok("video", "a.####.png", "-o", "i.mkv", "--codec", "ffv1", "--fps", "24", "--gaze-at", "0.25,0.5", "--insets",
                    "--screen-px", "96,72", "--screen-cm", "96,72", "--screen-distance-cm", "60")
        frame = self.pixels("i.mkv", 96, 72 + 24)[0]
        at = lambda x, y: tuple(frame[3 * (96 * y + x):3 * (96 * y + x) + 3])
        # 16 x 8 pixels about (24, 36), and 45 % of the width beside them; below the labels nothing covers them.
        for left, shown in ((16, 0), (59, 48)):
            for x in range(48):
                for y in range(16, 24):
                    self.assertEqual(at(shown + x, 72 + y), (2 * (left + x // 3), 3 * (32 + y // 3), 77), (x, y))
        framed = {x for x in range(96) if at(x, 36)[2] > 100}
        self.assertEqual(framed, {16, 31, 59, 74})
        self.assert_refused(["video", "a.####.png", "-o", "c.mkv", "--fps", "24", "--insets"], ["where the gaze was", "--gaze"])

    @NEEDS_FFMPEG
    def test_a_failure_leaves_nothing(self):
        self.sequence()
        self.write("p.0004.png", harness.png(16, 16, lambda x, y: (0, 0, 0)))
        result = self.run_program("video", "p.####.png", "-o", "out.mp4", "--fps", "24")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("16x16", result.stderr)
        self.assertEqual([name for name in self.files() if "out" in name], [])

    def test_a_program_that_fails_is_quoted(self):
        self.sequence()
        program = self.write("broken", """#!/bin/sh
for last; do :; done
echo half > "$last"
cat > /dev/null
echo first >&2; echo 'no such encoder' >&2
exit 3
""")
        program.chmod(0o755)
        result = self.run_program("video", "p.####.png", "-o", "out.mp4", "--fps", "24", "--ffmpeg", str(program))
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("no such encoder", result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)
        self.assertEqual([name for name in self.files() if "out" in name], [])
        # A caller that ignores SIGCHLD hands that on, and a process that does so is not told how its children ended.
        command = [harness.PROGRAM, "video", "p.####.png", "-o", "out.mp4", "--fps", "24", "--ffmpeg", str(program)]
        ignoring = subprocess.run(command, cwd=self.folder, capture_output=True, check=False,
                                  preexec_fn=lambda: signal.signal(signal.SIGCHLD, signal.SIG_IGN))
        self.assertEqual(ignoring.returncode, 3, ignoring.stderr)
        self.assertEqual([name for name in self.files() if "out" in name], [])

    def test_what_is_refused(self):
        self.sequence()
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--fps", "24", "--ffmpeg", "no-such-ffmpeg"],
                            ["no-such-ffmpeg", "not found", "apt-get install ffmpeg"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4"], ["--fps"])
        self.assert_refused(["video", "p.####.png"], ["--output"])
        self.assert_refused(["video", "p.####.png", "-o", "out.avi", "--fps", "24"], [".mkv"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--codec", "ffv1", "--fps", "24"], [".mkv"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--codec", "h265", "--fps", "24"], ["hevc"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--crf", "60", "--fps", "24"], ["0 to 51"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--color", "pq", "--fps", "24"], ["rec709"])
        self.assert_refused(["video", "p.0001.png", "-o", "out.mp4", "--fps", "24"], ["no sequence"])
        self.assert_refused(["video", "q.####.png", "-o", "out.mp4", "--fps", "24"], ["no such pictures"])
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--fps", "24", "--show-rings"], ["--show-rings"])
        self.write("out.mp4", "mine")
        self.assert_refused(["video", "p.####.png", "-o", "out.mp4", "--fps", "24"], ["--overwrite"])


if __name__ == "__main__":
    harness.main()
