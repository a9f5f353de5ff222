# SPDX-License-Identifier: Apache-2.0
"""Scenes and settings that are not trusted: what leads out of their folder, and what claims more than it is."""

import json
import os
import struct
import zlib

import harness
from farm_faults_test import JOB, Farm


class Confined(Farm):
    def textured(self, uri):
        scene = harness.box_gltf()
        scene["images"] = [{"uri": uri}]
        scene["textures"] = [{"source": 0}]
        scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        return json.dumps(scene)

    def test_uris_stay_in_the_scene_s_folder(self):
        secret = self.write("secret/picture.png", harness.png(2, 2, lambda x, y: (1, 2, 3)))
        self.write("scene/inside.png", secret.read_bytes())
        (self.folder / "scene/link.png").symlink_to(secret)
        (self.folder / "scene/folder").symlink_to(secret.parent)
        self.write("scene/ok.gltf", self.textured("inside.png"))
        self.run_ok("scene", "scene/ok.gltf")
        for number, uri in enumerate(("../secret/picture.png", str(secret), "link.png", "folder/picture.png",
                                      "%2e%2e/secret/picture.png", "x/../../secret/picture.png")):
            with self.subTest(uri=uri):
                name = f"scene/{number}.gltf"
                self.write(name, self.textured(uri))
                self.assert_refused(["scene", name], ["images[0]", "leads outside", "--allow-outside"])
                self.assert_refused(["render", name, "-o", "o/f.exr", "--size", "16x9"], ["leads outside"])
                self.run_ok("scene", name, "--allow-outside")
        scene = harness.box_gltf()
        scene["buffers"][0]["uri"] = "../../../../../../../../../etc/passwd"
        self.write("scene/buffer.gltf", json.dumps(scene))
        self.assert_refused(["scene", "scene/buffer.gltf"], ["buffers[0]", "leads outside"])

    def test_the_root_of_a_data_set(self):
        picture = harness.png(2, 2, lambda x, y: (1, 2, 3))
        self.write("set/dataset_description.json", "{}")
        self.write("set/stimuli/shared/picture.png", picture)
        key = self.write("set/.git/annex/objects/ab/cd/KEY/KEY", picture)
        self.write("set/stimuli/scene/up.gltf", self.textured("../shared/picture.png"))
        (self.folder / "set/stimuli/scene/annexed.png").symlink_to(os.path.relpath(key, self.folder / "set/stimuli/scene"))
        self.write("set/stimuli/scene/annexed.gltf", self.textured("annexed.png"))
        self.write("set/stimuli/scene/out.gltf", self.textured("../../../outside.png"))
        self.write("outside.png", picture)
        for name in ("up", "annexed"):
            self.run_ok("scene", f"set/stimuli/scene/{name}.gltf")
        self.assert_refused(["scene", "set/stimuli/scene/out.gltf"], ["leads outside", "set'"])
        # A link in the place of an annex opens nothing.
        (self.folder / "trap/.git").mkdir(parents=True)
        (self.folder / "trap/.git/annex").symlink_to("/")
        self.write("trap/out.gltf", self.textured("../outside.png"))
        self.assert_refused(["scene", "trap/out.gltf"], ["leads outside"])
        # The annex of a data set within another lies where .git says.
        self.write("super/.git/modules/sub/annex/objects/KEY", picture)
        self.write("super/.git/modules/sub/config", "[core]\n\tworktree = ../../../sub\n")
        self.write("super/sub/.git", "gitdir: ../.git/modules/sub\n")
        (self.folder / "super/sub/annexed.png").symlink_to("../.git/modules/sub/annex/objects/KEY")
        self.write("super/sub/annexed.gltf", self.textured("annexed.png"))
        self.run_ok("scene", "super/sub/annexed.gltf")
        # A scene cannot say that another data set's annex is its own, neither by a file nor by a link.
        self.write("thief/.git", "gitdir: ../super/.git/modules/sub\n")
        (self.folder / "thief/stolen.png").symlink_to("../super/.git/modules/sub/annex/objects/KEY")
        self.write("thief/stolen.gltf", self.textured("stolen.png"))
        self.assert_refused(["scene", "thief/stolen.gltf"], ["leads outside of"])
        (self.folder / "thief/.git").unlink()
        (self.folder / "thief/.git").symlink_to("../super/.git/modules/sub")
        self.assert_refused(["scene", "thief/stolen.gltf"], ["leads outside of"])

    def test_a_link_to_a_scene_brings_its_files(self):
        self.write("real/picture.png", harness.png(2, 2, lambda x, y: (1, 2, 3)))
        self.write("real/scene.gltf", self.textured("picture.png"))
        (self.folder / "linked").mkdir()
        for name in ("scene.gltf", "picture.png"):
            (self.folder / "linked" / name).symlink_to(self.folder / "real" / name)
        self.run_ok("scene", "linked/scene.gltf")


    def test_settings_that_are_not_trusted(self):
        secret = self.write("secret/log.csv", harness.moving_gaze())
        self.write("jobs/glide.gltf", json.dumps(harness.box_gltf(camera_seconds=1.0)))
        (self.folder / "jobs/link.csv").symlink_to(secret)
        common = 'scene = "jobs/glide.gltf"\nsize = "32x18"\nscreen-px = "64,36"\nscreen-cm = "64,36"\nscreen-distance-cm = 60\n'
        for more, named in (('gaze = "secret/log.csv"', "gaze"), ('gaze = "jobs/link.csv"', "gaze"),
                            ('env = "secret/log.csv"', "env"), ('output = ["elsewhere/f.####.exr"]', "output"),
                            ('density = "secret/log.csv"', "density")):
            with self.subTest(more):
                self.write("jobs/job.toml", common + more)
                self.assert_refused(["plan", "--config", "jobs/job.toml", "--frames", "1", "--confine"], [named, "leads outside"])
        self.write("jobs/job.toml", common + "allow-outside = true\n")
        self.assert_refused(["plan", "--config", "jobs/job.toml", "--frames", "1", "--confine"], ["allow-outside"])
        self.write("jobs/job.toml", common + 'env = "sky"\noutput = ["jobs/out/f.####.exr"]\n')
        self.run_ok("plan", "--config", "jobs/job.toml", "--frames", "1", "--confine")
        # Frames of a sequence lead nowhere else either, by links in their own place or in that of their folders.
        (self.folder / "jobs/m.0001.exr").symlink_to(secret)
        (self.folder / "jobs/frames").mkdir()
        (self.folder / "jobs/frames/0001").symlink_to(self.folder / "secret")
        for more, named in (('density = "m.####.exr"', "density"),
                            ('output = ["jobs/frames/%04d/%04d.exr"]', "output")):
            with self.subTest(more):
                self.write("jobs/job.toml", common + more)
                self.assert_refused(["plan", "--config", "jobs/job.toml", "--frames", "1", "--confine"], [named, "leads outside"])
        self.write("jobs/job.toml", common)
        # What the user says himself is not the settings' word.
        self.run_ok("plan", "--config", "jobs/job.toml", "--frames", "1", "--confine", "--gaze", "secret/log.csv")

    def test_what_belongs_to_a_bids_recording(self):
        eyes = "".join(f"{i * 10_000_000},0.{400 + i},0.5,ok,{eye}\n" for i in range(20) for eye in ("left", "right"))
        self.write("both.csv", "# gazetrace-gaze 1\n# display_px 1000 500\nt[ns],u[1],v[1],valid,eye\n" + eyes)
        (self.folder / "b").mkdir()
        (self.folder / "b/dataset_description.json").write_text("{}")
        self.run_ok("gaze", "import", "both.csv", "-o", "b/sub-1_task-t_physio.tsv.gz")
        recording, other = sorted(path.name for path in (self.folder / "b").glob("*recording-eye[12]_physio.tsv.gz"))
        plan = ["plan", "glide.gltf", "--gaze", f"b/{recording}", "--frames", "1", "--screen-px", "64,36", "--screen-cm", "64,36",
                "--screen-distance-cm", "60", "--gaze-transfer", "fraction"]
        self.run_ok(*plan)
        for name in (other, other.replace(".tsv.gz", ".json")):
            with self.subTest(name):
                path = self.folder / "b" / name
                away = self.folder / name
                path.rename(away)
                path.symlink_to(away)
                self.assert_refused(plan, [name, "leads outside", "--allow-outside"])
                self.run_ok(*plan, "--allow-outside")
                path.unlink()
                away.rename(path)


class Bombs(Farm):
    def textured(self, name):
        scene = harness.box_gltf()
        scene["images"] = [{"uri": name}]
        scene["textures"] = [{"source": 0}]
        scene["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        self.write("bomb.gltf", json.dumps(scene))

    def png_of_zeros(self, width, height, surplus=0):
        pack = zlib.compressobj(9)
        row = b"\0" * (1 + 3 * width)
        data = b"".join(pack.compress(row) for _ in range(height)) + pack.compress(b"\0" * surplus) + pack.flush()

        def chunk(kind, content):
            return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

        return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
                chunk(b"IDAT", data) + chunk(b"IEND", b""))

    def test_pictures(self):
        self.write("zeros.png", self.png_of_zeros(8000, 5000))
        self.textured("zeros.png")
        self.assert_refused(["scene", "bomb.gltf", "--max-memory", "1G"], ["zeros.png", "unpacks to 114 MiB", "64 MiB", "--max-memory"])
        self.run_ok("scene", "bomb.gltf", "--max-memory", "3G")
        self.assert_refused(["scene", "bomb.gltf", "--max-memory", "400M"], ["zeros.png", "25 MiB", "--max-memory"])
        self.write("surplus.png", self.png_of_zeros(4, 4, 50_000_000))
        self.textured("surplus.png")
        self.assert_refused(["scene", "bomb.gltf"], ["surplus.png", "more data than its pixels"])

    def test_nodes_and_nesting(self):
        scene = harness.box_gltf()
        scene["nodes"] += [{}] * 600_000
        self.write("nodes.gltf", json.dumps(scene))
        self.assert_refused(["scene", "nodes.gltf", "--max-memory", "8G"], ["600004 nodes", "447392", "--max-memory"])
        scene = harness.box_gltf()
        for depth in (150, 250):
            scene["extras"] = json.loads("[" * depth + "]" * depth)
            self.write(f"nested{depth}.gltf", json.dumps(scene))
        self.run_ok("scene", "nested150.gltf")
        self.assert_refused(["scene", "nested250.gltf"], ["nested more than 200 deep"])

    def test_memory_is_told_and_kept(self):
        told = json.loads(self.run_ok("scene", "glide.gltf", "--estimate", "--json").stdout)
        self.assertEqual((told["triangles"], told["nodes"]), (12, 4))
        self.assertIn("will take    about", self.run_ok("scene", "glide.gltf").stdout)
        refusal = ["glide.gltf", "will take about", "the limit is 1024 bytes", "--max-memory"]
        self.assert_refused(["scene", "glide.gltf", "--max-memory", "1K"], refusal)
        self.assert_refused(["render", *JOB, "-o", "o/f.exr", "--max-memory", "1K"], refusal)
        self.run_ok("scene", "glide.gltf", "--max-memory", "160M")
        # JSON that is small as a text and large as a tree is refused before it is parsed.
        self.write("tree.gltf", '{"asset": {"version": "2.0"}, "extras": [' + "[]," * 5_000_000 + "0]}")
        self.assert_refused(["scene", "tree.gltf", "--max-memory", "160M"], ["to be parsed", "160 MiB", "--max-memory"])
        # A file that claims more than it has, told before anything is loaded.
        scene = harness.box_gltf()
        scene["accessors"][0].pop("bufferView")
        scene["accessors"][0]["count"] = 2_000_000
        self.write("claims.gltf", json.dumps(scene))
        self.assert_refused(["scene", "claims.gltf", "--max-memory", "160M"], ["--max-memory"])


if __name__ == "__main__":
    harness.main()
