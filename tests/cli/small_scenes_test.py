# SPDX-License-Identifier: Apache-2.0
"""Every small scene at hand renders or is refused with a reason; nothing ends the program by a signal."""

import harness


class SmallScenes(harness.CliTest):
    def test_renders_or_says_why_not(self):
        root = harness.SHARED / "scenes" / "small"
        scenes = sorted([*root.rglob("*.gltf"), *root.rglob("*.glb")])
        if not scenes:
            self.skipTest(f"no scenes in {root}")
        refused = []
        for scene in scenes:
            with self.subTest(scene=scene.name):
                folder = scene.stem
                result = self.run_program("render", scene, "-o", f"{folder}/f.exr", "--size", "64x36", "--spp", "4", "--quiet")
                self.assertIn(result.returncode, (0, 2), f"{result.returncode}\n{result.stderr}")
                summary = self.run_program("scene", scene)
                self.assertEqual(summary.returncode, result.returncode, summary.stderr)
                if result.returncode == 0:
                    self.assertTrue((self.folder / folder / "f.exr").is_file())
                else:
                    self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
                    self.assertIn(scene.name, result.stderr)
                    refused.append(result.stderr.strip())
        print("\n".join(refused))
        self.assertLess(len(refused), len(scenes) / 2)


if __name__ == "__main__":
    harness.main()
