# SPDX-License-Identifier: Apache-2.0
"""The add-on for Blender, inside every Blender that is there: the `blender` on the PATH, and a Python that has bpy.

GAZETRACE_BPY_PYTHON names such a Python, for bpy needs a certain version; else it is the one that runs this test. What
happens inside is in tests/blender. Camera and framing are held against pictures by Cycles.
"""

import json
import os
import shutil
import subprocess
import sys
import unittest

import harness

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
                self.assertEqual([result["frames"] for result in results], [1, 1, 10])
                for result in results:
                    print(host, result)
                    # The cube's gloss is Blender's own, and glTF's is another: 1.2 % of the mean. All else is matte.
                    model = 0.02 if result["scene"] == "cube" else 0
                    for ratio, error in zip(result["ratio"], result["error_of_ratio"]):
                        self.assertLess(error, MOST_ERROR, result)
                        self.assertLess(abs(ratio - 1), 4 * error + model, result)

    def test_the_add_on(self):
        for host in HOSTS:
            with self.subTest(host):
                self.inside(host, "addon.py")


if __name__ == "__main__":
    harness.main()
