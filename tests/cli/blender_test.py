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
LOST = {"obj": ["without cameras"], "fbx": ["area lights"], "abc": ["without lights"], "ply": ["without cameras"]}


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
                same = f"{name.partition('.')[0]}.glb"
                # Blender's own exporter has frame f at f / 24 s, and the import in the middle of the video's frame f.
                start = ["--start", "20833333ns", "--camera-extrapolation", "hold"]
                if moves:
                    ours, theirs = self.cameras("i.glb"), self.cameras(same, *start)
                    for a, b in zip(ours, theirs, strict=True):
                        self.assertAlmostEqual(a["yfov_deg"], b["yfov_deg"], places=3)
                        for x, y in zip(a["position_m"] + a["orientation_xyzw"], b["position_m"] + b["orientation_xyzw"]):
                            self.assertAlmostEqual(x, y, delta=2e-4)
                (a, noise_a), (b, noise_b) = self.patch("i.glb", *options), self.patch(same, *options, *start)
                print(name, a, noise_a, b, noise_b)
                self.assertGreater(a, 0.05)
                self.assertLess(abs(a - b), 4 * math.hypot(noise_a, noise_b))

    def cameras(self, scene, *options):
        told = self.run_ok("plan", scene, "--size", "64x36", "--fps", "24", "--frames", "1-5", *options, "--json", "-").stdout
        return [frame["camera"] for frame in json.loads(told)["frames"]]

    def patch(self, scene, *options):
        """The mean green light of a patch, and its standard error, by two renders."""
        values = []
        for seed in ("1", "2"):
            self.run_ok("render", scene, "-o", "patch.exr", "--overwrite", "--size", "64x36", "--fps", "24", "--frames", "2", "--spp", "64",
                        "--exr-compression", "zip", "--sampling", "uniform", "--filter", "none", "--diffuse", "lambert", "--seed", seed, *options)
            green = Exr(self.folder / "patch.exr").channel("G")
            values.append([value for row in green[10:26] for value in row[20:44]])
        a, b = values
        noise = math.sqrt(sum((x - y) ** 2 for x, y in zip(a, b))) / 2 / len(a)
        return (sum(a) + sum(b)) / 2 / len(a), noise

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
