# SPDX-License-Identifier: Apache-2.0
"""Every small scene at hand renders."""

import harness


class SmallScenes(harness.CliTest):
    def test_every_one_renders(self):
        root = harness.SHARED / "scenes" / "small"
        scenes = sorted([*root.rglob("*.gltf"), *root.rglob("*.glb")])
        if not scenes:
            self.skipTest(f"{root} is not here")
        for scene in scenes:
            with self.subTest(scene=scene.name):
                folder = scene.stem
                result = self.run_program("render", scene, "-o", f"{folder}/f.exr", "--frames", "1", "--size", "64x36",
                                          "--spp", "4", "--quiet")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertTrue((self.folder / folder / "f.exr").is_file())
                summary = self.run_program("scene", scene)
                self.assertEqual(summary.returncode, 0, summary.stderr)


if __name__ == "__main__":
    harness.main()
