# SPDX-License-Identifier: Apache-2.0
"""The add-on for Blender, inside every Blender that is there: the `blender` on the PATH, and a Python that has bpy.

GAZETRACE_BPY_PYTHON names such a Python, for bpy needs a certain version; else it is the one that runs this test. What
happens inside is in tests/blender. Camera and framing are held against pictures by Cycles.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import unittest

import harness
from exr_reader import Exr

SCRIPTS = harness.SOURCE / "tests" / "blender"
# The allowed difference is half a pixel. What is measured is a few hundredths: sampling noise of both pictures.
ALLOWED_PX = 0.5
# The standard error of a ratio of means, beyond which agreement says little.
MOST_ERROR = 0.02


def has_bpy(python):
    """Whether a Python has Blender as a module."""
    finding = "import importlib.util as u, sys; sys.exit(u.find_spec('bpy') is None)"
    return subprocess.run([python, "-c", finding], capture_output=True, check=False).returncode == 0


def hosts():
    """Commands that run a script inside Blender, by what they are called."""
    found = {}
    if shutil.which("blender"):
        found["blender"] = [shutil.which("blender"), "-b", "--factory-startup", "--python-exit-code", "1", "-P"]
    python = os.environ.get("GAZETRACE_BPY_PYTHON", sys.executable)
    if has_bpy(python):
        found["bpy"] = [python, "-B"]
    return found


HOSTS = hosts()

ABOVE = ["--env", "constant:1,1,1"]
EYE = [*ABOVE, "--eye", "3,2,3", "--target", "0,0.5,0"]
IMPORTS = {"lit.blend": ["--env", "none"], "lit.usdc": ["--env", "none"], "coloured.fbx": ABOVE, "coloured.obj": EYE, "bare.abc": ABOVE,
           "bare.ply": EYE, "bare.stl": EYE}
# What the file states, where it is not the scene of its name (tests/blender/files.py).
SAME = {"lit.usdc": "warm.glb"}
LOST = {"usdc": ["strength of gloss", "6500 K"], "obj": ["without cameras"], "fbx": ["area lights"], "abc": ["without lights"], "ply": ["without cameras"]}


# A triangle with a material.
FBX = """; FBX 7.4.0 project file
FBXHeaderExtension: {{
\tFBXHeaderVersion: 1003
\tFBXVersion: 7400
}}
Creator: "by hand"
Objects: {{
\tGeometry: 1, "Geometry::g", "Mesh" {{
\t\tVertices: *9 {{
\t\t\ta: 0,0,0,1,0,0,0,1,0
\t\t}}
\t\tPolygonVertexIndex: *3 {{
\t\t\ta: 0,1,-3
\t\t}}
\t\tLayerElementMaterial: 0 {{
\t\t\tMappingInformationType: "AllSame"
\t\t\tReferenceInformationType: "IndexToDirect"
\t\t\tMaterials: *1 {{
\t\t\t\ta: 0
\t\t\t}}
\t\t}}
\t\tLayer: 0 {{
\t\t\tLayerElement: {{
\t\t\t\tType: "LayerElementMaterial"
\t\t\t\tTypedIndex: 0
\t\t\t}}
\t\t}}
\t}}
\tModel: 2, "Model::o", "Mesh" {{
\t\tVersion: 232
\t}}
\tMaterial: 3, "Material::m", "" {{
\t\tVersion: 102
\t\tShadingModel: "{model}"
\t\tProperties70: {{
\t\t\tP: "DiffuseColor", "Color", "", "A", 0.5, 0.5, 0.5
\t\t\tP: "SpecularFactor", "double", "Number", "", {factor}
\t\t}}
\t}}
}}
Connections: {{
\tC: "OO",2,0
\tC: "OO",1,2
\tC: "OO",3,2
}}
"""


@unittest.skipUnless(HOSTS, "neither Blender nor a Python with bpy is installed (GAZETRACE_BPY_PYTHON names one)")
class Blender(harness.CliTest):
    def inside(self, host, script, *arguments):
        command = [*HOSTS[host], str(SCRIPTS / script), *(["--"] if host == "blender" else []), *arguments]
        environment = {**os.environ, "GAZETRACE": harness.PROGRAM}
        if host == "blender":
            # Debian's Blender takes its modules from beside the first python3 on the PATH, which must be Debian's.
            environment["PATH"] = os.defpath
        done = subprocess.run(command, cwd=self.folder, env=environment, timeout=500, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, (done.stdout + done.stderr)[-6000:])
        return done.stdout

    def test_framing_agrees_with_cycles(self):
        for host in HOSTS:
            with self.subTest(host):
                told = self.inside(host, "framing.py", str(self.folder / host))
                results = [json.loads(line.removeprefix("RESULT ")) for line in told.splitlines() if line.startswith("RESULT ")]
                self.assertEqual(len(results), 9)
                for result in results:
                    print(host, result)
                    # A camera that stands still would prove nothing, and neither would balls that leave the picture: then
                    # their light is not centred where Blender computes them to be.
                    self.assertGreater(result["moved_px"], 2, result)
                    self.assertLess(result["computed_and_gazetrace_px"], ALLOWED_PX, result)
                    self.assertLess(result["cycles_and_gazetrace_px"], ALLOWED_PX, result)

    def test_means_agree_with_cycles(self):
        for host in HOSTS:
            with self.subTest(host):
                told = self.inside(host, "against_cycles.py", str(self.folder / host))
                results = [json.loads(line.removeprefix("RESULT ")) for line in told.splitlines() if line.startswith("RESULT ")]
                self.assertEqual([result["frames"] for result in results], [1, 1, 1, 10])
                for result in results:
                    print(host, result)
                    # The cube's gloss is Blender's own, and glTF's is another: 1.2 % of the mean, and nothing without it.
                    model = 0.02 if result["scene"] == "cube" else 0
                    for ratio, error in zip(result["ratio"], result["error_of_ratio"]):
                        self.assertLess(error, MOST_ERROR, result)
                        self.assertLess(abs(ratio - 1), 4 * error + model, result)

    @unittest.skipUnless("bpy" in HOSTS, "no Python with bpy is installed")
    def test_imports_show_what_the_same_scene_as_gltf_shows(self):
        """Cameras are where they were, and a patch in the middle, with the edge of a texture, is as bright."""
        self.inside("bpy", "files.py", str(self.folder))
        environment = {"GAZETRACE_BPY_PYTHON": HOSTS["bpy"][0]}
        for name, options in IMPORTS.items():
            with self.subTest(name):
                told = json.loads(self.run_ok("import", name, "-o", "i.glb", "--overwrite", "--json", environment=environment, alone=True).stdout)
                for sentence in LOST.get(name.rpartition(".")[2], []):
                    self.assertIn(sentence, " ".join(told["lost"]))
                moves = "--eye" not in options
                self.assertEqual((told["frames"], len(told["cameras"])), (5, 1) if moves else (1, 0))
                same = SAME.get(name, f"{name.partition('.')[0]}.glb")
                # Blender's own exporter has frame f at f / 24 s, and the import in the middle of the video's frame f.
                start = ["--start", "20833333ns", "--camera-extrapolation", "hold"]
                if moves:
                    ours, theirs = self.cameras("i.glb"), self.cameras(same, *start)
                    for a, b in zip(ours, theirs, strict=True):
                        self.assertAlmostEqual(a["yfov_deg"], b["yfov_deg"], places=3)
                        for x, y in zip(a["position_m"] + a["orientation_xyzw"], b["position_m"] + b["orientation_xyzw"]):
                            self.assertAlmostEqual(x, y, delta=2e-4)
                ours, theirs = self.patch("i.glb", *options), self.patch(same, *options, *start)
                for channel in "RGB":
                    (a, noise_a), (b, noise_b) = ours[channel], theirs[channel]
                    print(name, channel, a, noise_a, b, noise_b)
                    self.assertGreater(a, 0.05)
                    self.assertLess(abs(a - b), 4 * math.hypot(noise_a, noise_b))

    @unittest.skipUnless("bpy" in HOSTS, "no Python with bpy is installed")
    def test_an_import_lists_pictures_that_are_not_there_and_gloss_that_is_guessed(self):
        environment = {"GAZETRACE_BPY_PYTHON": HOSTS["bpy"][0]}
        self.write("s.obj", b"mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n")
        self.write("s.mtl", b"newmtl m\nKd 1 1 1\nmap_Kd -s 1 1 1 gone.png\n")
        told = json.loads(self.run_ok("import", "s.obj", "-o", "s.glb", "--json", environment=environment, alone=True).stdout)
        self.assertIn("Picture 'gone.png' is not there and is left out.", told["lost"])
        for name, model, factor, gloss, sentence in (("lambert", "lambert", 1, 0, False), ("dull", "phong", 0, 0, False), ("shiny", "phong", 0.3, 1, True)):
            with self.subTest(name):
                self.write("s.fbx", FBX.format(model=model, factor=factor).encode())
                told = json.loads(self.run_ok("import", "s.fbx", "-o", "s.glb", "--overwrite", "--json", environment=environment, alone=True).stdout)
                self.assertEqual("guess" in " ".join(told["lost"]), sentence, told)
                self.assertEqual(self.document("s.glb")["materials"][0].get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor", 1), gloss)

    @unittest.skipUnless("bpy" in HOSTS, "no Python with bpy is installed")
    def test_pictures_of_an_obj_are_listed_where_the_import_is_without_them(self):
        """Blender seeks a picture beside its MTL, too, takes quotes away, and reads the MTL of the OBJ's name whatever is named."""
        environment = {"GAZETRACE_BPY_PYTHON": HOSTS["bpy"][0]}
        self.write("wood.png", harness.png(2, 2, lambda x, y: (200, 100, 50)))
        self.write("in/wood.png", harness.png(2, 2, lambda x, y: (200, 100, 50)))
        self.write("damaged.png", b"nothing")
        faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n"
        picture = "Picture '{}' is not there and is left out."
        for library, file, words, sentence in (
                ("mtllib a.mtl", "a.mtl", '"wood.png"', None), ("mtllib a.mtl", "a.mtl", "/home/bob/tex/wood.png", None),
                ("mtllib a.mtl", "a.mtl", "in\\wood.png", None), ("mtllib a.mtl", "a.mtl", "-s 2 2 2 -clamp on wood.png", None),
                ("mtllib gone.mtl", "o.mtl", "wood.png", None), ("", "o.mtl", "gone.png", picture.format("gone.png")),
                ("mtllib a.mtl", "a.mtl", "-bm 1 in/gone one.png", picture.format("in/gone one.png")),
                ("mtllib a.mtl", "a.mtl", "damaged.png", "Picture 'damaged.png' cannot be read and is left out."),
                ("mtllib gone.mtl", "a.mtl", "wood.png", "Material 'm' is left out: 'gone.mtl' is not there.")):
            with self.subTest(f"{library} {words}"):
                (self.folder / "o.mtl").unlink(missing_ok=True)
                self.write(file, f"newmtl m\nKd 1 1 1\nmap_Kd {words}\n")
                self.write("o.obj", f"{library}\n{faces}")
                told = json.loads(self.run_ok("import", "o.obj", "-o", "o.glb", "--overwrite", "--json", environment=environment, alone=True).stdout)
                self.assertEqual([line for line in told["lost"] if "left out" in line], [sentence] if sentence else [])
                self.assertEqual("images" in self.document("o.glb"), sentence is None)

    def document(self, name):
        data = (self.folder / name).read_bytes()
        return json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])

    def cameras(self, scene, *options):
        told = self.run_ok("plan", scene, "--size", "64x36", "--fps", "24", "--frames", "1-5", *options, "--json", "-").stdout
        return [frame["camera"] for frame in json.loads(told)["frames"]]

    def patch(self, scene, *options):
        """The mean light of a patch, and its standard error, for red, green and blue, by two renders."""
        pictures = []
        for seed in ("1", "2"):
            self.run_ok("render", scene, "-o", "patch.exr", "--overwrite", "--size", "64x36", "--fps", "24", "--frames", "2", "--spp", "64",
                        "--exr-compression", "zip", "--sampling", "uniform", "--filter", "none", "--accumulate", "off", "--diffuse", "lambert", "--seed", seed,
                        *options)
            exr = Exr(self.folder / "patch.exr")
            pictures.append({name: [value for row in exr.channel(name)[10:26] for value in row[20:44]] for name in "RGB"})
        a, b = pictures
        return {name: (math.fsum(a[name] + b[name]) / 2 / len(a[name]),
                       math.sqrt(math.fsum((x - y) ** 2 for x, y in zip(a[name], b[name]))) / 2 / len(a[name])) for name in "RGB"}

    def test_the_add_on(self):
        for host in HOSTS:
            with self.subTest(host):
                self.inside(host, "addon.py")


class WithoutBlender(harness.CliTest):
    def test_an_import_without_blender_says_what_to_install(self):
        self.write("s.obj", b"v 0 0 0\n")
        environment = {"PATH": os.defpath, "GAZETRACE_BPY_PYTHON": ""}
        self.assert_refused(["import", "s.obj", "-o", "s.glb"], ["pip install bpy"], code=3, environment=environment, alone=True)


if __name__ == "__main__":
    harness.main()
