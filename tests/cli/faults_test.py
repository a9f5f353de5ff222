# SPDX-License-Identifier: Apache-2.0
"""What must not happen unseen: films that a full disk cut, outputs that replace what is no output, signals that leave tasks
behind, farms that end well and have made nothing."""

import json
import os
import re
import shutil
import signal
import stat
import subprocess
import sys
import time
import unittest
from pathlib import Path

import harness

# Takes all frames, leaves half a film, says so and ends well, as ffmpeg 5.1 does on a full disk.
CUTS_FILMS = """#!/bin/sh
for out; do :; done
[ "$out" = pipe:1 ] && exit 1  # it is asked which frames the film holds
cat > /dev/null
printf 'half a film' > "$out"
echo 'av_interleaved_write_frame(): No space left on device' >&2
"""
STILL = [*harness.SCREEN, "--size", "64x36", "--gaze-at", "0.5,0.5"]


# Harms nothing: the film is that of the real one, which is told of an error that is none.
COMPLAINS = """#!/bin/sh
ffmpeg "$@" || exit $?
echo 'deprecated pixel format used, make sure you did set range correctly' >&2
"""
JOB = """scene = "box.gltf"
gaze = "g.csv"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
size = "64x36"
"""
SWEEP = """[common]
size = "48x27"
screen-px = [64, 36]
screen-cm = [64, 36]
screen-distance-cm = 60
fps = 12
frames = "1-2"
[[scene]]
name = "box"
path = "box.gltf"
[[gaze]]
name = "left"
log = "g.csv"
[grid]
region-samples = [[8, 4, 2]]
[reference]
spp = 4
[measure]
repeats = 1
metrics = ["mse"]
controls = false
"""


class Outputs(harness.CliTest):
    def contents(self):
        return {name: (self.folder / name).read_bytes() for name in self.files()}

    def test_no_output_takes_the_place_of_an_input(self):
        self.write("g.csv", harness.moving_gaze())
        self.write("job.toml", JOB)
        self.write("plan.toml", SWEEP)
        os.symlink("box.gltf", self.folder / "link.gltf")
        self.run_ok("render", "box.gltf", *STILL, "--frames", "1-2", "-o", "p.####.png", "-o", "p.####.exr", "--quiet")
        self.run_ok("render", "box.gltf", *STILL, "--frames", "1-2", "--chunk", "1/1", "-o", "parts/p.####.exr", "--quiet")
        self.run_ok("plan", "box.gltf", *STILL, "--frames", "1-2", "--save-camera", "c.chan")
        before = self.contents()
        still = ["box.gltf", *STILL, "--quiet", "-o", "n.png"]
        for words in (["scene", "box.gltf", "--json=box.gltf"], ["scene", "link.gltf", "--json=box.gltf"],
                      ["render", *still, "--json=box.gltf"], ["render", "--config", "job.toml", "-o", "n.png", "--json=job.toml"],
                      ["render", "--config", "job.toml", "--quiet", "-o", "n.png", "--frames", "1", "--json=g.csv"],
                      ["render", *still, "--json=n.png"], ["render", *still, "--json=n.run.json"],
                      ["render", "box.gltf", *STILL, "--env", "p.0001.exr", "--quiet", "-o", "p.0001.exr"],
                      ["plan", "--config", "job.toml", "--frames", "1", "--json=g.csv"],
                      ["plan", "box.gltf", *STILL, "--camera-path", "c.chan", "--save-camera", "./c.chan"],
                      ["gaze", "events", "g.csv", "-o", "g.csv"], ["gaze", "events", "g.csv", "--json=./g.csv"],
                      ["gaze", "measure", "g.csv", "--json=g.csv"], ["gaze", "import", "g.csv", "-o", "g.csv"],
                      ["gaze", "inspect", "g.csv", "--save-columns", "g.csv"],
                      ["gaze", "objects", "--config", "job.toml", "--frames", "1", "--gaze-accuracy", "1", "--table", "box.gltf"],
                      ["compare", "p.####.exr", "p.####.exr", "--csv", "p.0002.exr"],
                      ["compare", "p.####.exr", "p.####.exr", "--json=p.run.json"],
                      ["video", "p.####.png", "-o", "v.mkv", "--json=p.0002.png"],
                      ["merge", "parts", "--json=parts/p.timing.1-2.csv"], ["merge", "parts", "--json=parts/p.0001.exr"],
                      ["merge", "--mean", "p.####.exr", "parts/p.####.exr", "-o", "p.####.exr"],
                      ["sweep", "plan.toml", "-o", "out", "--quiet", "--json=g.csv"], ["sweep", "plan.toml", "-o", "out", "--json=plan.toml"]):
            with self.subTest(words):
                self.assert_refused([*words, "--overwrite"], ["replace an input"])
                self.assertEqual(self.contents(), before)
        self.assert_refused(["gaze", "synth", "-o", "s.csv", "--truth", "./s.csv", "--overwrite"], ["two outputs"])

    def test_nothing_is_replaced_unasked(self):
        self.write("g.csv", harness.moving_gaze())
        self.write("there.json", "of a day's work")
        self.write("there.csv", "of a day's work")
        (self.folder / "folder.json").mkdir()
        os.mkfifo(self.folder / "pipe.json")
        for words in (["scene", "box.gltf", "--json="], ["plan", "--counts", *STILL, "--json="], ["gaze", "events", "g.csv", "-o"],
                      ["gaze", "measure", "g.csv", "--json="], ["gaze", "synth", "-o"], ["gaze", "inspect", "g.csv", "--save-columns"],
                      ["gaze", "import", "g.csv", "-o"], ["list", "--json="], ["version", "--json="]):
            for name, more, told in (("there.json", [], "exists already"), ("folder.json", ["--overwrite"], "folder"),
                                     ("pipe.json", ["--overwrite"], "pipe")):
                name = name if name != "there.json" or words[:2] != ["gaze", "synth"] else "there.csv"
                with self.subTest(words=words, name=name):
                    whole = [*words[:-1], words[-1] + name] if words[-1].endswith("=") else [*words, name]
                    self.assert_refused([*whole, *more], [name, told])
        self.assertEqual((self.folder / "there.json").read_text(), "of a day's work")
        self.assertTrue(stat.S_ISFIFO((self.folder / "pipe.json").stat().st_mode))


class Faults(harness.CliTest):
    def start(self, *words, before=None):
        self.addCleanup(lambda: process.poll() is None and process.kill())
        log = open(self.folder / "log", "wb")  # the child's, too
        process = subprocess.Popen([harness.PROGRAM, *map(str, words)], cwd=self.folder, stdout=log, stderr=log, preexec_fn=before)
        log.close()
        return process

    def wait_for(self, is_there, seconds=60):
        limit = time.time() + seconds
        while not is_there():
            self.assertLess(time.time(), limit, (self.folder / "log").read_text())
            time.sleep(0.02)

    def test_a_film_that_a_full_disk_cut_is_none(self):
        self.run_ok("render", "box.gltf", *STILL, "--frames", "1-2", "-o", "p.####.png", "--quiet")
        cutter = self.write("cutter", CUTS_FILMS)
        cutter.chmod(0o755)
        video = ["video", "p.####.png", "-o", "v.mp4", "--fps", "24", "--ffmpeg", str(cutter)]
        self.assert_refused(video, ["v.mp4", "No space left"], code=3)
        self.write("v.mp4", "a good one")
        self.assert_refused([*video, "--overwrite"], ["v.mp4"], code=3)
        self.assertEqual((self.folder / "v.mp4").read_text(), "a good one")

    @unittest.skipIf(shutil.which("ffmpeg") is None, "no ffmpeg")
    def test_an_error_that_harms_nothing_costs_no_film(self):
        self.run_ok("render", "box.gltf", *STILL, "--frames", "1-3", "-o", "p.####.png", "--quiet")
        self.write("complainer", COMPLAINS).chmod(0o755)
        for name in ("v.mp4", "v.mkv"):
            self.run_ok("video", "p.####.png", "-o", name, "--fps", "24", "--ffmpeg", str(self.folder / "complainer"))
        # The same words, and a film that lacks its end.
        for name in ("cut.mp4", "cut.mkv"):
            cut = self.write("cutter", COMPLAINS + "for out; do :; done\n[ -f \"$out\" ] && truncate -s -40 \"$out\" || :\n")
            cut.chmod(0o755)
            self.assert_refused(["video", "p.####.png", "-o", name, "--fps", "24", "--ffmpeg", str(cut)], [name, "deprecated"], code=3)

    def test_a_pipe_stays_one(self):
        os.mkfifo(self.folder / "pipe")
        for more in ([], ["--overwrite"]):
            self.assert_refused(["plan", "--counts", *STILL, "--json", "pipe", *more], ["pipe: "])
            self.assertTrue(stat.S_ISFIFO((self.folder / "pipe").stat().st_mode))

    def test_a_camera_file_is_replaced_only_where_that_is_asked_for(self):
        self.write("c.chan", "of a day's work\n")
        save = ["plan", "box.gltf", *STILL, "--save-camera", "c.chan"]
        self.assert_refused(save, ["c.chan", "--overwrite"])
        self.assertEqual((self.folder / "c.chan").read_text(), "of a day's work\n")
        self.run_ok(*save, "--overwrite")
        self.assertNotIn("work", (self.folder / "c.chan").read_text())

    def test_settings_that_are_nested_without_end_are_refused(self):
        for text in (".".join("a" * 30_000) + " = 1\n", "[" + ".".join("a" * 30_000) + "]\n"):
            self.write("deep.toml", text)
            self.assert_refused(["plan", "--config", "deep.toml"], ["deep.toml:1", "too deep"])

    def long_render(self):
        return ["render", "box.gltf", *STILL, "--size", "320x180", "--frames", "1-200", "--spp", "16", "--accumulate", "off",
                "--threads", "1", "-o", "out/f.####.exr"]

    def test_a_terminal_that_closes_ends_a_run_like_a_queue_does(self):
        run = self.start(*self.long_render())
        self.wait_for((self.folder / "out/f.0001.exr").exists)
        run.send_signal(signal.SIGHUP)
        self.assertEqual(run.wait(timeout=60), 4, (self.folder / "log").read_text())
        self.assertIn("HUP", (self.folder / "log").read_text())

    def test_a_run_under_nohup_does_not_mind(self):
        run = self.start(*self.long_render(), before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.wait_for((self.folder / "out/f.0001.exr").exists)
        run.send_signal(signal.SIGHUP)
        self.wait_for((self.folder / "out/f.0003.exr").exists)
        self.assertIsNone(run.poll())

    def test_a_farm_that_is_told_to_end_takes_its_tasks_along(self):
        for name, number in (("a", signal.SIGTERM), ("b", signal.SIGINT)):
            with self.subTest(signal=number):
                (self.folder / name).mkdir()
                (self.folder / name / "j.toml").write_text(
                    f'scene = "{self.folder}/box.gltf"\nfps = "10"\nsize = "320x180"\nspp = 16\naccumulate = "off"\n'
                    f'frames = "1-60"\noutput = ["{self.folder}/{name}/f.####.exr"]\n')
                farm = self.start("farm", f"{name}/j.toml", "--chunks", "3", "--processes", "1", "--threads", "1")
                self.wait_for(lambda: list((self.folder / name).glob("f.*.exr")))
                farm.send_signal(number)
                self.assertEqual(farm.wait(timeout=60), 4, (self.folder / "log").read_text())
                left = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True, check=True).stdout
                self.assertFalse([line for line in left.splitlines() if str(self.folder) in line])

    def test_who_is_told_to_end_before_the_first_frame_ends_in_order(self):
        self.write("g.csv", harness.moving_gaze())
        self.write("plan.toml", SWEEP.replace("1-2", "1-8").replace("spp = 4", "spp = 4096"))
        self.write("farm.toml", JOB + 'fps = 24\nframes = "1-60"\nspp = 4096\noutput = ["farm/f.####.exr"]\n')
        for name, words in (("render", [*self.long_render(), "--overwrite"]), ("sweep", ["sweep", "plan.toml", "-o", "out"]),
                            ("farm", ["farm", "farm.toml", "--chunks", "2"])):
            for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
                with self.subTest(command=name, signal=number):
                    run = self.start(*words)
                    self.wait_for(lambda process=run, bit=1 << (number - 1): self.held(process) & bit)
                    run.send_signal(number)
                    self.assertEqual(run.wait(timeout=120), 4, (self.folder / "log").read_text())

    @staticmethod
    def held(process):
        """The signals that its first thread holds back, as bits."""
        return int(re.search(r"SigBlk:\s*(\w+)", Path(f"/proc/{process.pid}/status").read_text())[1], 16)

    def test_a_farm_whose_tasks_make_nothing_does_not_end_well(self):
        self.write("g.csv", harness.moving_gaze())
        self.write("farm.toml", JOB + 'fps = 24\nframes = "1-2"\noutput = ["farm/f.####.exr"]\n')
        done = self.run_program("farm", "farm.toml", "--chunks", "2", "--program", "true")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("files are missing", done.stderr)

    def test_a_farm_is_denoised_by_one_library(self):
        self.write("g.csv", harness.moving_gaze())
        self.write("farm.toml", JOB + 'fps = 24\nframes = "1-2"\nspp = 1\nfilter = "guided"\noutput = ["farm/f.####.exr"]\n')
        self.run_ok("farm", "farm.toml", "--chunks", "2", "--engine", "slurm")
        plan = json.loads((self.folder / "farm/farm/farm.json").read_text())
        self.assertEqual((plan["filter"], plan["denoiser"]), ("guided", ""))
        plan.update(filter="oidn", denoiser="Open Image Denoise 2.3.3, quality high, built-in weights, avx2")
        self.write("farm/farm/farm.json", json.dumps(plan))
        script = ["sh", str(self.folder / "farm/farm/task.sh"), "1"]
        told = subprocess.run(script, capture_output=True, text=True, check=False)
        self.assertEqual(told.returncode, 2, told.stderr)
        self.assertIn("Open Image Denoise 2.3.3", told.stderr)
        self.assertFalse(list(self.folder.glob("farm/f.*.exr")))
        self.run_ok("farm", "farm.toml", "--chunks", "2", "--engine", "slurm")
        self.assertEqual(subprocess.run(script, check=False, capture_output=True).returncode, 0)

    def test_no_mean_is_made_of_two_denoisers(self):
        for seed in ("1", "2"):
            self.run_ok("render", "box.gltf", "--sampling", "uniform", "--spp", "1", "--size", "32x18", "--filter", "guided", "--seed", seed,
                        "-o", f"s{seed}/f.exr", "--quiet")
        record = json.loads((self.folder / "s2/f.run.json").read_text())
        self.write("s2/f.run.json", json.dumps({**record, "denoiser": "Open Image Denoise 2.3.3"}))
        mean = ["merge", "--mean", "s1/f.exr", "s2/f.exr", "-o", "m.exr"]
        self.assert_refused(mean, ["s2/f.run.json", "Open Image Denoise 2.3.3"])
        self.write("s2/f.run.json", json.dumps(record))
        self.run_ok(*mean)


FIELD = harness.SHARED / "field-cases" / "faults"


@unittest.skipUnless(FIELD.is_dir(), f"{FIELD} is not here (GAZETRACE_SHARED_DIR)")
class FieldCases(harness.CliTest):
    """Scripts and files after faults that were met, each with what is right in its README."""

    def told(self, name):
        done = subprocess.run(["bash", str(FIELD / name)], cwd=self.folder, capture_output=True, text=True, check=False, timeout=300,
                              env={**os.environ, "GAZETRACE": harness.PROGRAM, "PROJECT": str(harness.SOURCE), "TMPDIR": str(self.folder)})
        return done.stdout + done.stderr

    def code(self, told, word="exit code"):
        found = re.search(word + r":? (\d+)", told)
        self.assertTrue(found, told)
        return int(found[1])

    def test_a_farm_that_is_interrupted_leaves_no_tasks(self):
        told = self.told("farm_interrupt.sh")
        self.assertEqual(self.code(told), 4, told)
        left = told.split("tasks left:")[1].splitlines()  # other tests' farms may run beside it
        self.assertFalse([line for line in left if str(self.folder) in line], told)

    def test_a_chunk_that_is_lost_is_told_of_or_made_again(self):
        told = self.told("lost_chunk.sh")
        whole = self.code(told) == 0 and re.search(r"6 of 6 frames", told)
        self.assertTrue(whole or (self.code(told) in (2, 3) and re.search(r"^gazetrace: ", told, re.M)), told)

    def test_a_merge_writes_nowhere_else(self):
        told = self.told("merge_elsewhere.sh")
        self.assertNotEqual(self.code(told), 0, told)
        self.assertFalse(list(self.folder.glob("*/victim")))

    def test_a_camera_is_not_replaced(self):
        told = self.told("save_camera.sh")
        self.assertEqual(self.code(told), 2, told)
        self.assertRegex(told, r"(?m)^precious$")

    def test_two_spellings_are_one_file(self):
        told = self.told("two_spellings.sh")
        self.assertEqual((self.code(told, "second"), self.code(told, "first")), (3, 0), told)

    @unittest.skipUnless(os.geteuid() == 0, "needs root")
    def test_a_device_stays_one(self):
        told = self.told("device.sh")
        if "mknod" in told:
            self.skipTest("no device can be made here")
        self.assertEqual(self.code(told), 2, told)
        self.assertRegex(told, r"(?m)^c.* n$")

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("unshare"), "needs root and unshare")
    def test_a_run_that_is_stopped_elsewhere_loses_nothing(self):
        told = self.told("stopped_elsewhere.sh")
        if "unshare:" in told:
            self.skipTest("no other namespace can be made here")
        codes = self.code(told, "second"), self.code(told, "first")
        if codes != (3, 0):  # else the second was refused, and made no pictures
            self.assertEqual(codes, (0, 3), told)
            self.assertEqual(self.code(told, "that the first replaced"), 0, told)

    @unittest.skipUnless(os.geteuid() == 0 and shutil.which("ffmpeg"), "needs root and ffmpeg")
    def test_a_film_on_a_full_disk(self):
        told = self.told("video_full_disk.sh")
        if "mount:" in told:
            self.skipTest("no file system can be mounted here")
        self.assertEqual(self.code(told), 3, told)
        self.assertNotRegex(told, r"(?m) v\.mp4$")

    def test_files_that_are_made_to_harm(self):
        # make.py writes the two plan files before it asks for Pillow, which draws a picture that no case here reads.
        subprocess.run([sys.executable, FIELD / "make.py", self.folder / "made"], capture_output=True, check=False)
        for name in ("table_deep.toml", "key_deep.toml"):
            self.assert_refused(["render", "--config", f"made/{name}"], [name, "too deep"])
        claims = self.folder / "claims_30000x15000.hdr"
        claims.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 15000 +X 30000\n" + bytes(27_000_000))
        for path in (claims, FIELD / "env_only_Z.exr"):
            self.assert_refused(["render", "box.gltf", *STILL, "--env", str(path), "--max-memory", "1G", "-o", "a.png"], [path.name])


if __name__ == "__main__":
    harness.main()
