# SPDX-License-Identifier: Apache-2.0
"""What goes wrong on a farm: files that are lost or changed, inputs that change, side files that are cut, signals and
limits of time."""

import csv
import json
import os
import shutil
import signal
import subprocess
import time
import zlib
from pathlib import Path

import harness
from gliding_job import job_toml, write_inputs

JOB_TOML = job_toml(more="quiet = true\n")
JOB = ["--config", "job.toml"]


def outputs(folder):
    return ["-o", f"{folder}/f.####.exr", "-o", f"{folder}/f.####.png"]


class Farm(harness.CliTest):
    def setUp(self):
        super().setUp()
        write_inputs(self.folder)
        self.write("job.toml", JOB_TOML)

    def render(self, folder, *more):
        return self.run_ok("render", *JOB, *outputs(folder), *more)

    def parts(self, folder, *more):
        for frames in ("1-3", "4-6"):
            self.render(folder, "--frames", frames, "--chunk", "1/1", *more)

    def record(self, path):
        return json.loads((self.folder / path).read_text())

    def rows(self, path):
        with open(self.folder / path, newline="", encoding="utf-8") as file:
            return {int(row["frame"]): row for row in csv.DictReader(file)}

    def times(self, folder):
        return {path.name: path.stat().st_mtime_ns for path in (self.folder / folder).glob("f.[0-9]*")}


class MergeLooksAtFiles(Farm):
    def test_each_bad_file_is_named_and_rendered_again(self):
        self.parts("out")
        whole = self.pictures("out")
        out = self.folder / "out"
        (out / "f.0001.exr").unlink()
        (out / "f.0002.png").unlink()
        (out / "f.0003.exr").write_bytes(whole["f.0003.exr"][:1000])
        shutil.copyfile(out / "f.0006.exr", out / "f.0005.exr")
        changed = bytearray(whole["f.0006.png"])
        changed[-100] ^= 1
        (out / "f.0006.png").write_bytes(changed)
        merged = self.run_program("merge", "out")
        self.assertEqual(merged.returncode, 2, merged.stdout + merged.stderr)
        for words in ("f.0001.exr: is missing", "f.0002.png: is missing", "f.0003.exr: has 1000 bytes in place of",
                      "f.0005.exr: holds frame 6", "f.0006.png: has another content", "5 files are not as recorded",
                      "frames 1-3,5-6"):
            self.assertIn(words, merged.stderr)
        self.assertFalse((out / "f.run.json").exists())
        # What is there is joined without them where that is asked for.
        partly = self.run_ok("merge", "out", "--allow-missing")
        self.assertIn("2 parts joined, frames 4\n", partly.stdout)
        before = self.times("out")
        self.parts("out", "--resume")
        self.assertEqual(self.pictures("out"), whole)
        made = {name for name, stamp in self.times("out").items() if before.get(name) != stamp}
        self.assertEqual(made, {f"f.{frame:04d}.{suffix}" for frame in (1, 2, 3, 5, 6) for suffix in ("exr", "png")})
        self.assertIn("2 parts joined, frames 1-6", self.run_ok("merge", "out", "--overwrite").stdout)
        self.assertEqual(len(self.record("out/f.run.json")["files"]), 12)

    def test_files_can_be_trusted(self):
        self.parts("out")
        (self.folder / "out/f.0001.png").unlink()
        self.assertEqual(self.run_program("merge", "out").returncode, 2)
        self.run_ok("merge", "out", "--trust-files")

    def test_a_part_that_ended_before_its_table_began_is_missing(self):
        self.parts("out")
        (self.folder / "out/f.timing.4-6.csv").unlink()
        self.assert_refused(["merge", "out"], ["frames are missing: 4-6"])

    def test_parts_of_different_outputs_are_no_sequence(self):
        self.render("out", "--frames", "1-2", "--chunk", "1/1")
        self.run_ok("render", *JOB, "-o", "out/f.####.exr", "--frames", "3-4", "--chunk", "1/1")
        refused = self.run_program("merge", "out")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("f.run.3-4.json: lists no 'f.0003.png', and frame 1 has a file like that", refused.stderr)
        # Numbers that are not the frame's do not matter.
        for folder, name in (("two", "f2.####.exr"), ("one", "f.####.v001.exr"), ("both", "p2.####_s2.png"), ("each", "%04d/f1.%04d.exr")):
            for frames in ("1-2", "3-4"):
                self.run_ok("render", *JOB, "-o", f"{folder}/{name}", "--frames", frames, "--chunk", "1/1")
            self.run_ok("merge", folder)

    def test_a_division_that_is_gone(self):
        self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-6", "--chunk", "1/3")
        next((self.folder / "out").glob("chunks.*.json")).unlink()
        refused = self.run_program("merge", "out")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("chunks may be missing", refused.stderr)
        self.assertIn("chunks may be missing", self.run_ok("merge", "out", "--allow-missing").stderr)

    def test_nothing_is_left_to_join(self):
        self.parts("out")
        for path in (self.folder / "out").glob("f.[0-9]*"):
            path.unlink()
        self.assert_refused(["merge", "out", "--allow-missing"], ["no frame is left to join"])

    def test_a_killed_part_knows_its_files(self):
        self.render("out", "--frames", "1-3", "--chunk", "1/1")
        record = self.record("out/f.run.1-3.json")
        lines = [f'{file["frame"]} {file["bytes"]} {file["digest"]} {name}\n' for name, file in record["files"].items()]
        record["files"] = {}
        self.write("out/f.run.1-3.json", json.dumps(record))
        self.write("out/f.run.1-3.files", "".join(lines) + "2 17 cut")
        (self.folder / "out/f.0002.exr").write_bytes(b"")
        self.assertIn("f.0002.exr: has 0 bytes in place of", self.run_program("merge", "out").stderr)
        before = self.times("out")
        self.render("out", "--frames", "1-3", "--chunk", "1/1", "--resume")
        made = {name for name, stamp in self.times("out").items() if before[name] != stamp}
        self.assertEqual(made, {"f.0002.exr", "f.0002.png"})
        self.assertFalse((self.folder / "out/f.run.1-3.files").exists())
        self.run_ok("merge", "out")


class ResumeLosesNothing(Farm):
    def test_a_changed_input_is_said_and_nothing_rendered_over(self):
        self.render("out", "--frames", "1-4")
        before = self.times("out")
        scene = harness.box_gltf(camera_seconds=1.0)
        scene["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = 0.9
        self.write("glide.gltf", json.dumps(scene))
        again = ["render", *JOB, *outputs("out"), "--frames", "1-4", "--resume"]
        self.assert_refused(again, ["f.run.json", "4 finished frames, 1-4", "glide.gltf has changed", "--overwrite"])
        self.assertEqual(self.times("out"), before)
        (self.folder / "out/f.0001.exr").unlink()
        (self.folder / "out/f.0001.png").unlink()
        self.assert_refused(again, ["3 finished frames, 2-4"])
        self.run_ok(*again, "--overwrite")
        self.assertTrue(all(before[name] != stamp for name, stamp in self.times("out").items()))

    def test_a_changed_option_is_named(self):
        self.render("out", "--frames", "1-2", "--seed", "3")
        again = ["render", *JOB, *outputs("out"), "--frames", "1-2", "--resume"]
        self.assert_refused([*again, "--seed", "4"], ["2 finished frames", "--seed was 3 and is 4"])
        self.run_ok(*again, "--seed", "3")
        # Without a record the pictures alone say that they are others.
        (self.folder / "out/f.run.json").unlink()
        self.assert_refused([*again, "--seed", "4"], ["2 finished frames", "no record"])


class DigestsOfParts(Farm):
    def test_how_a_run_was_cut_is_not_in_its_files(self):
        self.render("whole", "--frames", "1-6")
        for frames in ("1-3", "4-6"):
            self.render("parts", "--frames", frames, "--chunk", "1/1")
        self.assertEqual(self.pictures("parts"), self.pictures("whole"))
        self.run_ok("merge", "parts")
        whole, parts = self.record("whole/f.run.json"), self.record("parts/f.run.json")
        self.assertEqual(parts["settings_digest"], whole["settings_digest"])
        self.assertEqual(parts["files"], whole["files"])
        self.assertEqual(parts["part_digests"], [])


class DamagedSideFiles(Farm):
    def test_a_resumed_run_makes_them_anew(self):
        self.render("out", "--frames", "1-3")
        before, record = self.times("out"), (self.folder / "out/f.run.json").read_bytes()
        good = self.rows("out/f.timing.csv")
        for name, content in (("f.timing.csv", b""), ("f.timing.csv", b"frame,plan"), ("f.timing.csv", b"a,b\n1,2\n"),
                              ("f.run.json", record[:len(record) // 2]), ("f.run.json", b"")):
            with self.subTest(name=name, content=content[:20]):
                self.write(f"out/{name}", content)
                result = self.render("out", "--frames", "1-3", "--resume")
                self.assertEqual(self.times("out"), before)
                rows = self.rows("out/f.timing.csv")
                self.assertEqual(list(rows), [1, 2, 3])
                self.assertEqual([row["exposure_ev"] for row in rows.values()], [row["exposure_ev"] for row in good.values()])
                self.assertEqual(len(self.record("out/f.run.json")["files"]), 6)
                self.assertTrue(all(len(line) < 700 for line in result.stderr.splitlines()), result.stderr)

    def test_pictures_of_a_lost_record_tell_their_own_damage(self):
        """Without a record, each picture is believed by what is in it, and a damaged one is made again."""
        self.render("out", "--frames", "1-4", "--chunk", "1/1")
        whole = self.pictures("out")
        for name in ("f.0002.exr", "f.0003.png"):
            path = self.folder / "out" / name
            content = bytearray(path.read_bytes())
            content[len(content) * 3 // 4] ^= 16
            path.write_bytes(content)
        (self.folder / "out/f.run.1-4.json").write_bytes((self.folder / "out/f.run.1-4.json").read_bytes()[:500])
        times = self.times("out")
        self.render("out", "--frames", "1-4", "--chunk", "1/1", "--resume")
        self.assertEqual(self.pictures("out"), whole)
        kept = [name for name, time_ns in self.times("out").items() if time_ns == times[name]]
        self.assertEqual(sorted(kept), ["f.0001.exr", "f.0001.png", "f.0004.exr", "f.0004.png"])
        self.run_ok("merge", "out")

    def test_a_cut_record_of_a_part_is_one_short_line(self):
        self.parts("out")
        record = (self.folder / "out/f.run.1-3.json").read_bytes()
        self.write("out/f.run.1-3.json", record[:len(record) // 2])
        self.assertLess(len(self.assert_refused(["merge", "out"], ["f.run.1-3.json", "--resume"])), 700)
        self.render("out", "--frames", "1-3", "--chunk", "1/1", "--resume")
        self.run_ok("merge", "out")


class Names(Farm):
    def test_messages_are_bounded(self):
        scene = harness.box_gltf()
        scene["extensionsRequired"] = ["A" * 10_000_000]
        self.write("long.gltf", json.dumps(scene))
        self.assertLess(len(self.assert_refused(["scene", "long.gltf"], ["long.gltf", "more bytes"])), 4000)
        scene = harness.box_gltf()
        scene["extensionsRequired"] = ["red \x1b[31m text"]
        self.write("escape.gltf", json.dumps(scene))
        self.assertNotIn("\x1b", self.assert_refused(["scene", "escape.gltf"], ["red"]))

    def test_a_damaged_png_has_one_line(self):
        png = harness.png(8, 8, lambda x, y: (x, y, 0))
        at = png.index(b"IDAT") + 8
        data = bytearray(png)
        data[at] ^= 0xFF
        length = int.from_bytes(png[at - 8 - 4:at - 8], "big")
        data[at - 4 + length:at + length] = zlib.crc32(bytes(data[at - 8:at - 4 + length])).to_bytes(4, "big")
        self.write("broken.png", bytes(data))
        scene = harness.box_gltf()
        scene["images"] = [{"uri": "broken.png"}]
        scene["textures"] = [{"source": 0}]
        scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        self.write("textured.gltf", json.dumps(scene))
        self.assert_refused(["scene", "textured.gltf"], ["broken.png", "damaged"])

    def test_folders_of_frames(self):
        self.run_ok("render", *JOB, "-o", "out/%04d/%04d.exr", "--frames", "1-2")
        self.assertEqual(self.files("out"), ["0001/0001.exr", "0002/0002.exr", "run.json", "timing.csv"])
        self.run_ok("compare", "out/%04d/%04d.exr", "out/%04d/%04d.exr", "--metrics", "mse")
        self.assert_refused(["render", *JOB, "-o", ""], ["--output", "empty"])


class Chunks(Farm):
    def test_chunks_are_the_whole(self):
        self.render("whole", "--frames", "1-7")
        for number in (3, 1, 2):
            self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-7", "--chunk", f"{number}/3")
        [written] = (self.folder / "out").glob("chunks.3.*.json")
        borders = json.loads(written.read_text())
        self.assertEqual([name for name in self.files("out") if name.startswith("f.run.")],
                         sorted(f"f.run.{frames}.json" for frames in borders["chunks"]))
        self.assertIn("frames 1-7", self.run_ok("merge", "out").stdout)
        self.assertEqual(self.pictures("out"), self.pictures("whole"))
        told = json.loads(self.run_ok("plan", *JOB, "--frames", "1-7", "--chunks", "3", "--json",
                                      "--rate-from", "whole/f.timing.csv").stdout)
        self.assertEqual([chunk["frames"] for chunk in told], borders["chunks"])
        self.assertEqual([chunk["samples"] for chunk in told], borders["samples"])
        self.assertTrue(all(chunk["minutes"] > 0 for chunk in told))

    def test_borders_that_are_written_down_stay(self):
        self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-6", "--chunk", "1/2")
        [written] = (self.folder / "out").glob("chunks.2.*.json")
        borders = json.loads(written.read_text())
        borders["chunks"] = ["1-4", "5-6"]
        written.write_text(json.dumps(borders))
        self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-6", "--chunk", "2/2")
        self.assertIn("f.run.5-6.json", self.files("out"))

    def test_more_chunks_than_frames(self):
        for number in range(1, 4):
            self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-3", "--chunk", f"{number}/4")
        self.assertIn("3 parts joined, frames 1-3", self.run_ok("merge", "out").stdout)
        late = self.run_ok("render", *JOB, *outputs("out"), "--frames", "1-3", "--chunk", "4/4")
        self.assertIn("chunk 4 has none of the 3 frames", late.stderr)

    def test_what_is_no_chunk(self):
        for options, words in ((["--chunk", "3"], "--chunk"), (["--chunk", "4/3"], "4/3"), (["--chunk", "0/3"], "0/3"),
                               (["--chunk-frames", "3"], "this option is gone")):
            self.assert_refused(["render", *JOB, *outputs("bad"), *options], [words])


class Running(Farm):
    SLOW = ["--frames", "1-4", "--size", "640x360", "--region-samples", "400,400,400", "--threads", "1"]

    def start(self, *more):
        process = subprocess.Popen([harness.PROGRAM, "render", *JOB, *outputs("out"), *more], cwd=self.folder,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(lambda: (process.poll() is None and process.kill(), process.wait(), process.stderr.close()))
        return process

    def wait_for(self, condition, process):
        deadline = time.monotonic() + 120
        while not condition() and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        self.assertTrue(condition())

    @staticmethod
    def processor_seconds(process):
        """That the process has used so far."""
        # The name of the program stands in brackets and may hold blanks; user and system time are the 12th and 13th field after it.
        fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Signals(Running):
    """The frame in hand is finished or given up, the run says what is left, and goes on to the same bits."""

    LONG = ["--frames", "1-24", "--size", "160x90", "--region-samples", "60,60,60", "--threads", "1"]

    def interrupt(self, folder_ready, number, *more):
        process = self.start(*more)
        self.wait_for(folder_ready, process)
        process.send_signal(number)
        self.assertEqual(process.wait(timeout=120), 4)
        line = process.stderr.read().splitlines()[-1]
        self.assertIn("interrupted by", line)
        self.assertIn("go on with --resume", line)
        return line

    def test_each_signal_and_on_to_the_same_bits(self):
        self.run_ok("render", *JOB, *outputs("whole"), *self.LONG)
        for count, number in enumerate((signal.SIGTERM, signal.SIGUSR1, signal.SIGINT, signal.SIGXCPU)):
            ready = self.folder / f"out/f.{2 + 3 * count:04d}.exr"
            line = self.interrupt(ready.exists, number, *self.LONG, *(["--resume"] if count else []))
            self.assertIn(f"signal {number.name[3:]}", line)
            record = self.record("out/f.run.json")
            done = len(list((self.folder / "out").glob("f.*.exr")))
            self.assertEqual(record["facts"]["state"], "interrupted")
            self.assertEqual(len(record["files"]), 2 * done)
            self.assertEqual(list(self.rows("out/f.timing.csv")), list(range(1, done + 1)))
            self.assertEqual(sorted(name for name in self.files("out") if name.endswith((".lock", ".files"))), [])
        result = self.run_ok("render", *JOB, *outputs("out"), *self.LONG, "--resume", "--json")
        summary = json.loads(result.stdout)
        self.assertFalse(summary["interrupted"])
        self.assertGreater(summary["skipped"], 0)
        whole = self.pictures("whole")
        self.assertEqual(self.pictures("out"), whole)

    def test_a_frame_that_the_grace_time_does_not_allow_is_given_up(self):
        slow = [*self.SLOW, "--grace", "0s"]
        line = self.interrupt((self.folder / "out/f.run.json").exists, signal.SIGTERM, *slow)
        self.assertIn("0 of 4 frames are done, 1-4 left", line)
        self.assertEqual([name for name in self.files("out") if name.startswith("f.0")], [])

    def test_the_time_is_up(self):
        result = self.run_program("render", *JOB, *outputs("out"), *self.SLOW, "--max-time", "1s", "--grace", "0.5s")
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertIn("interrupted by --max-time", result.stderr)
        self.assertEqual(self.record("out/f.run.json")["facts"]["state"], "interrupted")

    def test_a_second_interrupt_ends_at_once(self):
        # A frame must outlast that second and both interrupts on any machine.
        slowest = [option.replace("400", "9000") for option in self.SLOW]
        process = self.start(*slowest, "--grace", "10min")
        self.wait_for((self.folder / "out/f.run.json").exists, process)
        # An interrupt before the first frame ends the run in good order, with nothing to wait for. This run is of tiny inputs, so that
        # a second of processor time after its record can only be spent in that frame.
        began = self.processor_seconds(process)
        self.wait_for(lambda: self.processor_seconds(process) > began + 1, process)
        # Two that arrive before the program has looked are one to the kernel, so that more may be needed.
        start = time.monotonic()
        while process.poll() is None and time.monotonic() < start + 60:
            process.send_signal(signal.SIGINT)
            time.sleep(0.3)
        self.assertEqual(process.wait(timeout=60), -signal.SIGINT)


if __name__ == "__main__":
    harness.main()
