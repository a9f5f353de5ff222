# SPDX-License-Identifier: Apache-2.0
"""The reference of options is what the definitions say, and names every option that the program takes."""

import json
import re

import harness

PAGE = harness.SOURCE / "docs" / "reference-options.md"


class Reference(harness.CliTest):
    def test_the_page_in_the_manual_is_current(self):
        self.assertEqual(self.run_ok("list", "options", "--markdown").stdout, PAGE.read_text(encoding="utf-8"),
                         "write it anew: gazetrace list options --markdown > docs/reference-options.md")

    def test_every_option_of_render_is_on_it(self):
        settings = self.run_ok("render", "--print-config").stdout
        keys = re.findall(r"^(?:# )?([a-z][a-z0-9-]*) = ", settings, re.MULTILINE)
        self.assertGreater(len(keys), 100)
        page = self.run_ok("list", "options", "--markdown").stdout
        self.assertEqual(re.findall(r"^### `(?:--)?([a-z0-9-]+)", page, re.MULTILINE), keys)
        listed = json.loads(self.run_ok("list", "options", "--json").stdout)
        self.assertEqual([option["name"] for option in listed], keys)
        text = self.run_ok("list", "options").stdout
        for option in listed:
            self.assertTrue(option["touches"], option["name"])
            self.assertIn(option["name"], text)

    def test_what_is_on_by_default_says_how_it_is_turned_off(self):
        listed = json.loads(self.run_ok("list", "options", "--json").stdout)
        off = {option["name"]: option["off"] for option in listed if "off" in option}
        self.assertEqual(off.get("guiding"), "no-guiding")
        self.assertEqual(set(off), {option["name"] for option in listed if option["default"] == ["true"]})
        for name, words in off.items():
            self.assertIn(f"\n{name} = true", self.run_ok("render", "--print-config").stdout)
            self.assertIn(f"\n{name} = false", self.run_ok("render", f"--{words}", "--print-config").stdout)

    def test_only_options_are_a_page(self):
        self.assert_refused(["list", "filters", "--markdown"], ["--markdown", "list options"])


if __name__ == "__main__":
    harness.main()
