# SPDX-License-Identifier: Apache-2.0
"""The shipped plans are understood as they are, those of scenes that others own with a stand-in for each."""

import json
import re
import shutil

import harness


class Plans(harness.CliTest):
    def test_each_can_be_begun(self):
        for name in ("examples", "scenes", "gazelogs"):
            shutil.copytree(harness.SOURCE / name, self.folder / name, symlinks=True)
        readme = (self.folder / "examples/README.md").read_text(encoding="utf-8")
        shipped, foreign = set(), set()
        for plan in sorted((self.folder / "examples").glob("*.toml")):
            text = plan.read_text(encoding="utf-8")
            if "[[scene]]" not in text:
                continue
            files = set(re.findall(r'= "(data/[^"]+)"', text))
            for file in files:
                self.assertIn(f"| `{file}` |", readme, plan.name)
                if file.endswith(".gltf"):
                    self.write(f"examples/{file}", json.dumps(harness.box_gltf()))
                else:
                    self.write(f"examples/{file}", (self.folder / "scenes/courtyard/dusk.hdr").read_bytes())
            plan.write_text(re.sub(r'(?m)^size = "\d+x\d+"', 'size = "64x36"', text), encoding="utf-8")  # maps at 4K take long
            (foreign if files else shipped).add(plan.name)
            with self.subTest(plan.name):
                self.assertIn(" rows, ", self.run_ok("sweep", plan, "--dry-run").stdout)
        # What the page says of them.
        self.assertEqual(shipped, {"demo.toml", "trade-offs.toml", "fixed-quality.toml"})
        self.assertEqual(foreign, {"fixed-jod.toml", "fixed-jod-controls.toml", "paper.toml"})


if __name__ == "__main__":
    harness.main()
