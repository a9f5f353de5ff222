# SPDX-License-Identifier: Apache-2.0
"""Mistakes of the first hour, made again: each ends in one line that says where, what is wrong and what to do."""

import json
import os
import subprocess

import harness

# What stands in the folder of each mistake: files by name, None for a folder.
USDA = '#usda 1.0\n(\n    defaultPrim = "Room"\n)\ndef Xform "Room"\n{\n}\n'
MITSUBA = '<?xml version="1.0" encoding="utf-8"?>\n<scene version="3.0.0">\n  <integrator type="path"/>\n</scene>\n'
PBRT = 'LookAt 3 4 1.5  .5 .5 0  0 0 1\nCamera "perspective" "float fov" 45\nWorldBegin\n'
OBJ = "# made by hand\nmtllib room.mtl\no Room\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
PLAN = """[common]
size = "32x18"
screen-px = [32, 18]
screen-cm = [64, 36]
screen-distance-cm = 60
frames = "1"
[[scene]]
name = "box"
path = "box.gltf"
[[gaze]]
name = "middle"
at = [0.5, 0.5]
[grid]
spp = [1]
"""
LONG = "n" * 300
JOB = ["--size", "32x18", "-o", "f.png"]

# The mistake; its files; the command; the words of the answer: place, message, remedy.
MISTAKES = [
    ("a folder as scene", {"room/room.gltf": "{}"}, ["render", "room", *JOB], ["room: ", "is a folder", "give room/room.gltf"]),
    ("a folder of folders", {"fox/glTF/fox.gltf": "{}", "fox/glTF/fox.bin": ""}, ["scene", "fox"], ["fox: ", "is a folder", "give fox/glTF/fox.gltf"]),
    ("a folder without a scene", {"room": None}, ["scene", "room"], ["room: ", "is a folder", "there is none in it"]),
    ("USD as text", {"room.usda": USDA}, ["render", "room.usda", *JOB], ["room.usda: ", "this is USD", "gazetrace import FILE -o SCENE.glb"]),
    ("USD under another name", {"room.gltf": USDA}, ["scene", "room.gltf"], ["room.gltf: ", "this is USD", "gazetrace import"]),
    ("USD, packed", {"room.usdc": b"PXR-USDC\0\7\0\0"}, ["scene", "room.usdc"], ["room.usdc: ", "this is USD", "gazetrace import FILE -o SCENE.glb"]),
    ("FBX", {"room.fbx": b"Kaydara FBX Binary  \0\x1a\0"}, ["render", "room.fbx", *JOB], ["room.fbx: ", "this is FBX", "gazetrace import"]),
    ("a Blender file", {"room.blend": b"BLENDER-v404"}, ["render", "room.blend", *JOB], ["room.blend: ", "a Blender file", "gazetrace import"]),
    ("a packed Blender file", {"room.blend": b"\x28\xb5\x2f\xfd\0"}, ["scene", "room.blend"], ["room.blend: ", "a Blender file", "gazetrace import"]),
    ("Wavefront OBJ", {"room.obj": OBJ}, ["render", "room.obj", *JOB], ["room.obj: ", "Wavefront OBJ", "gazetrace import"]),
    ("Mitsuba", {"room.xml": MITSUBA}, ["render", "room.xml", *JOB], ["room.xml: ", "a Mitsuba scene", "export .glb"]),
    ("pbrt", {"room.pbrt": PBRT}, ["render", "room.pbrt", *JOB], ["room.pbrt: ", "a pbrt scene", "export .glb"]),
    ("a page in place of a download", {"room.glb": "<!DOCTYPE html><html></html>"}, ["scene", "room.glb"], ["room.glb: ", "a web page", "download"]),
    ("an open quote", {"job.toml": 'scene = "box.gltf\nsize = "32x18"\n'}, ["render", "--config", "job.toml", "-o", "f.png"],
     ["job.toml:1: ", "a quote is opened and not closed", "close it"]),
    ("an open quote after a good one", {"job.toml": '# it\'s a "job\nsize = "32x18"\nscene = \'box.gltf\nfps = 24\n'}, ["plan", "--config", "job.toml"],
     ["job.toml:3: ", "a quote is opened and not closed", "close it"]),
    ("three quotes that stay open", {"job.toml": 'size = "32x18"\nscene = """\nbox.gltf\n'}, ["plan", "--config", "job.toml"],
     ["job.toml:2: ", "a quote is opened and not closed"]),
    ("a value by a flag", {}, ["render", "--scene", "box.gltf", *JOB], ["--scene", "is no option", "gazetrace render FILE"]),
    ("a plan by a flag", {"plan.toml": PLAN}, ["sweep", "--plan", "plan.toml"], ["--plan", "is no option", "gazetrace sweep PLAN.toml"]),
    ("a name of 300 bytes", {}, ["render", "box.gltf", "--size", "32x18", "-o", LONG + ".png"], [LONG[:50], "304 bytes", "give a shorter one"]),
    ("a folder of 300 bytes", {}, ["render", "box.gltf", "--size", "32x18", "-o", LONG + "/f.png"], [LONG[:50], "300 bytes", "give a shorter one"]),
    ("a table under a long name", {"log.csv": harness.moving_gaze()}, ["gaze", "events", "log.csv", "-o", LONG + ".tsv"], ["304 bytes", "give a shorter one"]),
    ("a folder in the place of the fourth picture", {"out/f.0004.png": None}, ["render", "box.gltf", "--size", "32x18", "--frames", "1-5", "--spp", "1",
     "--overwrite", "-o", "out/f.####.png"], ["out/f.0004.png: ", "a folder is in the place", "choose another name"]),
    ("a folder in the place of the record", {"f.run.json": None}, ["render", "box.gltf", *JOB, "--overwrite"], ["f.run.json: ", "a folder is in the place"]),
    ("a reference that tells nothing", {"plan.toml": PLAN + "[reference]\nspp = 1\n[measure]\nrepeats = 1\nmetrics = [\"fovvideovdp\"]\n"}, ["sweep", "plan.toml", "--quiet"],
     ["plan.toml: ", "the reference of box has 4 samples a pixel", "nothing better can be told", "samples would do", "go-on = true"]),
    ("a reference of no level", {"plan.toml": 'reference = "auto"\n' + PLAN + '[measure]\nmetrics = ["mse"]\n'}, ["sweep", "plan.toml", "--dry-run"],
     ["plan.toml: ", "follows a level in JOD", "fovvideovdp=9"]),
    ("fixations without gaze", {}, ["plan", "box.gltf", "--size", "32x18", "--frames", "fixations"], ["--frames: ", "no gaze log", "give --gaze"]),
    # A second twenty.
    ("a size as two words", {}, ["render", "box.gltf", "--size", "32", "18", "-o", "f.png"], ["'18' is one word too many", "an x between"]),
    ("a path with a space", {}, ["render", "my", "scenes/box.gltf", *JOB], ["'scenes/box.gltf' is one word too many", "in quotes"]),
    ("an address", {}, ["scene", "https://example.com/room.glb"], ["https://example.com/room.glb: ", "an address", "download it"]),
    ("a ~ in quotes", {}, ["render", "~/room.glb", *JOB], ["~/room.glb: ", "no such file", "leave out the quotes"]),
    ("the log as scene", {"log.csv": "t,x,y\n0,1,2\n"}, ["render", "log.csv", *JOB], ["log.csv: ", "this is a table", "--gaze"]),
    ("the scene as log", {}, ["plan", "box.gltf", "--gaze", "box.gltf", "--size", "32x18"], ["box.gltf: ", "a glTF scene", "the scene stands first"]),
    ("a packed scene as log", {"room.glb": b"glTF\2\0\0\0"}, ["gaze", "inspect", "room.glb"], ["room.glb: ", "a glTF scene", "the scene stands first"]),
    ("settings as scene", {"job.toml": 'scene = "box.gltf"\n'}, ["render", "job.toml", "-o", "f.png"], ["job.toml: ", "a settings file", "--config"]),
    ("an environment as scene", {"sky.hdr": "#?RADIANCE\n"}, ["render", "sky.hdr", *JOB], ["sky.hdr: ", "a picture", "--env"]),
    ("Python's True", {"job.toml": 'size = "32x18"\nalpha = True\n'}, ["plan", "--config", "job.toml"], ["job.toml:2: ", "write true and false in small letters"]),
    ("a path of Windows", {"job.toml": 'scene = "C:\\Users\\me\\box.gltf"\n'}, ["plan", "--config", "job.toml"], ["job.toml:1: ", "single quotes"]),
    ("YAML", {"job.toml": "scene: box.gltf\n"}, ["plan", "--config", "job.toml"], ["job.toml:1: ", "as key = value"]),
    ("JSON", {"job.toml": '{"scene": "box.gltf"}\n'}, ["plan", "--config", "job.toml"], ["job.toml:1: ", "as key = value"]),
    ("text without quotes", {"job.toml": "# a job\n\nscene = box.gltf\n"}, ["plan", "--config", "job.toml"], ["job.toml:3: ", "put text into quotes"]),
    ("a key twice", {"job.toml": 'size = "32x18"\nsize = "64x36"\n'}, ["plan", "--config", "job.toml"], ["job.toml:2: ", "give each key once"]),
    ("a screen without its distance", {}, ["render", "box.gltf", *JOB, "--gaze-at", "0.5,0.5", "--screen-cm", "52,29", "--screen-px", "1920,1080"],
     ["distance from the eye", "--screen-distance-cm"]),
    ("a job as the plan of a sweep", {"job.toml": 'size = "32x18"\nscene = "box.gltf"\n'}, ["sweep", "job.toml", "-o", "out"],
     ["job.toml:1: ", "the job of a render", "gazetrace render --config job.toml"]),
    ("settings as the folder of a demo", {"job.toml": ""}, ["demo", "job.toml"], ["job.toml: ", "a file", "--config"]),
    ("a folder by an option", {}, ["demo", "-o", "out"], ["'-o' is no option here", "gazetrace demo FOLDER"]),
    ("memory without a unit", {}, ["render", "box.gltf", *JOB, "--max-memory", "4"], ["box.gltf: ", "the limit is 4 bytes", "--max-memory"]),
    ("a lens by another name", {}, ["render", "box.gltf", *JOB, "--fstop", "2.8"], ["--fstop: ", "--aperture", "--focus-distance"]),
    ("a parameter where there is none", {}, ["render", "box.gltf", *JOB, "--sampling", "adaptive:pilot=4"], ["--sampling: ", "no parameters such as 'pilot=4'", "leave it out"]),
    ("a video in place of pictures", {}, ["render", "box.gltf", "--size", "32x18", "-o", "a:b.mp4"], ["a:b.mp4: ", "a video is made of pictures", "gazetrace video"]),
    ("a processor of graphics", {}, ["render", "box.gltf", *JOB, "--gpu"], ["--gpu: ", "runs on the processor"]),
]  # fmt: skip


class Mistakes(harness.CliTest):
    def put(self, files):
        for name, content in files.items():
            if content is None:
                (self.folder / name).mkdir(parents=True)
            else:
                self.write(name, content)

    def test_each_is_answered_in_one_line(self):
        for what, files, command, words in MISTAKES:
            with self.subTest(what):
                self.setUp()  # a folder of its own
                self.put(files)
                if "plan.toml" in files and "--dry-run" not in command and "--plan" not in command:
                    said = self.run_program(*command, "-o", "measured")
                    self.assertEqual(said.returncode, 2, said.stderr)
                    self.assertEqual(len(said.stderr.splitlines()), 1, said.stderr)
                    for word in words:
                        self.assertIn(word, said.stderr)
                else:
                    line = self.assert_refused(command, words)
                    self.assertNotIn("JSON", line)

    def test_another_screen_is_explained_once(self):
        self.write("log.csv", harness.moving_gaze())
        job = ["--gaze", "log.csv", "--screen", "paper", "--size", "32x18", "--frames", "1-2"]
        line = self.assert_refused(["plan", "box.gltf", *job], ["log.csv: ", "--gaze-transfer", "fraction", "angle"])
        self.assertEqual(line.count("--gaze-transfer"), 1)
        for command in (["plan"], ["render", "--spp", "1", "-o", "f.####.png"]):
            said = self.run_ok(command[0], "box.gltf", *command[1:], *job, "--gaze-transfer", "fraction")
            self.assertEqual((said.stdout + said.stderr).count("carried over as a fraction"), 1, said.stderr)

    def test_help_to_a_full_disk_is_no_success(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("there is no /dev/full")
        for words in (["--help"], ["render", "--help"], ["--version"], ["help"], ["list"]):
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([harness.PROGRAM, *words], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
            self.assertEqual(done.returncode, 3, words)
            self.assertIn("No space left", done.stderr)

    def test_frames_before_the_log_are_told_of(self):
        self.write("log.csv", harness.moving_gaze())
        job = ["plan", "box.gltf", "--gaze", "log.csv", "--size", "32x18", "--frames", "1-5"]
        told = self.run_ok(*job, "--gaze-latency", "5s").stderr
        self.assertIn("5 of 5 frames lie before the first row of the gaze log: check --gaze-latency", told)
        self.assertNotIn("before the first row", self.run_ok(*job, "--gaze-latency", "30ms").stderr)

    def test_frames_after_the_log_are_told_of(self):
        """The log ends at 0.99 s. Of frames 20 to 30, at 24 a second, 25 to 30 are later, and from 27 on more than 75 ms."""
        self.write("log.csv", harness.moving_gaze())
        job = ["box.gltf", "--gaze", "log.csv", "--size", "32x18", "--fps", "24"]
        line = "4 of 11 frames, from frame 27 on, lie after the end of the gaze log and hold its last gaze: end --frames before, or give --gaze-missing"
        self.assertIn(line, self.run_ok("plan", *job, "--frames", "20-30").stderr)
        said = self.run_ok("render", *job, "--frames", "20-30", "--spp", "1", "-o", "f.####.png").stderr
        self.assertEqual(said.count(line), 1, said)
        self.assertLess(said.index(line), said.index("frame 20 done"))
        for rest in (["--frames", "20-24"], []):
            self.assertNotIn("after the end", self.run_ok("plan", *job, *rest).stderr)

    def test_a_scene_is_read_by_its_content(self):
        """JSON under any name is glTF, and no foreign name hides it."""
        self.write("box.obj", json.dumps(harness.box_gltf()))
        self.write("box.txt", "\n  " + json.dumps(harness.box_gltf()))
        for name in ("box.obj", "box.txt"):
            self.run_ok("scene", name)


if __name__ == "__main__":
    harness.main()
