# SPDX-License-Identifier: Apache-2.0
"""`gazetrace report` from outside: the page stands alone and stays below its limit, diagrams are well-formed."""

import csv
import html.parser
import json
import shutil
import tempfile
import xml.etree.ElementTree

import harness
import small_results


class Page(html.parser.HTMLParser):
    """Texts of scripts by their id, and everything that could lead out of the page."""

    def __init__(self, text):
        super().__init__()
        self.scripts, self.links, self.open_script = {}, [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag == "script":
            self.open_script = attributes.get("id", "")
        self.links += [attributes[name] for name in ("src", "href", "srcset", "action") if name in attributes]

    def handle_endtag(self, tag):
        if tag == "script":
            self.open_script = None

    def handle_data(self, data):
        if self.open_script is not None:
            self.scripts[self.open_script] = self.scripts.get(self.open_script, "") + data


class Report(harness.CliTest):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.mkdtemp(prefix="gazetrace_report_")
        cls.addClassCleanup(shutil.rmtree, cls.made, True)
        small_results.make(cls.made)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made, self.folder, dirs_exist_ok=True)
        self.results = json.loads((self.folder / "results.json").read_text())

    def page(self):
        return Page((self.folder / "report.html").read_text())

    def test_the_page_stands_alone(self):
        self.run_ok("report", ".")
        page = self.page()
        for link in page.links:
            self.assertRegex(link, r"^(#|data:)")
        text = (self.folder / "report.html").read_text()
        self.assertNotIn("url(", text)
        self.assertNotIn("@import", text)
        # What markup the results hold is shown, not obeyed.
        self.assertIn("Box &amp; &lt;glide&gt;", text)
        self.assertNotIn("<glide>", text)
        self.assertNotIn("<equal samples>", text)
        data = json.loads(page.scripts["data"])
        self.assertEqual([run["label"] for run in data["sets"][0]["runs"]],
                         ["reference", *(label for _, _, _, label, _ in small_results.RUNS)])
        self.assertEqual(len(data["pictures"]), 4 * 3)
        self.assertTrue(all(picture.startswith("data:image/png;base64,") for picture in data["pictures"]))
        frame = data["sets"][0]["frames"][0]
        self.assertAlmostEqual(frame["gaze"][0], self.results["rows"][0]["frames"][0]["gaze_px"][0] / 64)
        self.assertAlmostEqual(frame["rings"][1], 1 / 5)
        for row in self.results["rows"]:
            self.assertIn(f"{row['scores']['flip']['whole']['mean']:.4g}", text)
        self.assertIn("unresolved", text)
        self.assertIn("insensitive", text)

    def test_diagrams_and_their_numbers(self):
        self.run_ok("report", "results.json", "-o", "out.html", "--plots", "plots", "--csv", "out.csv")
        svgs = [name for name in self.files("plots") if name.endswith(".svg")]
        self.assertEqual(len(svgs), 3 * len(small_results.METRICS))
        for name in svgs:
            root = xml.etree.ElementTree.parse(self.folder / "plots" / name).getroot()
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertNotRegex((self.folder / "plots" / name).read_text(), r"\b(nan|inf)\b")
            with open(self.folder / "plots" / name.replace(".svg", ".csv"), newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertGreaterEqual(len(rows), 3)
        with open(self.folder / "plots/pareto_box_glide_flip.csv", newline="") as file:
            rows = {row["id"]: row for row in csv.DictReader(file)}
        self.assertAlmostEqual(float(rows["few"]["flip"]), self.results["rows"][2]["scores"]["flip"]["whole"]["mean"], 7)
        self.assertEqual({name: row["front"] for name, row in rows.items()}, {"fov": "1", "uni": "1", "few": "0"})
        with open(self.folder / "out.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 3 * len(small_results.METRICS) * 8)
        ratios = {row["id"]: row["end_to_end"] for row in self.results["rows"]}
        for row in rows:
            self.assertNotIn(None, row, "more values than columns")
            self.assertAlmostEqual(float(row["end_to_end"]) / ratios[row["id"]], 1, 7)

    def test_the_limit_is_kept_and_said(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        small_results.make(self.folder, "640x360", 4)
        self.run_ok("report", ".", "--max-mib", "64")
        everything = len((self.folder / "report.html").read_bytes())
        for limit in (1, 0.6, 0.3):
            self.run_ok("report", ".", "--max-mib", limit, "--overwrite")
            text = (self.folder / "report.html").read_text()
            self.assertLess(len(text.encode()), limit * 2**20)
            self.assertLess(len(text.encode()), everything)
            self.assertIn(f"limit is {limit:g} MiB", text)
            self.assertRegex(text, r"JPEG of quality|No picture fits")
        self.assertGreater(everything, 2**20)

    def test_missing_pictures_are_said(self):
        (self.folder / "few/p.0002.png").unlink()
        result = self.run_ok("report", ".")
        self.assertIn("few/p.0002.png", result.stderr)
        data = json.loads(self.page().scripts["data"])
        self.assertIsNone(data["sets"][0]["runs"][3]["pictures"][1])

    def test_what_is_refused(self):
        self.assert_refused(["report", "nowhere"], ["nowhere", "no such file"])
        self.write("a.json", "{")
        self.assert_refused(["report", "a.json"], ["a.json", "no JSON"])
        self.write("a.json", "{}")
        self.assert_refused(["report", "a.json"], ["gazetrace-sweep-1"])
        self.results["rows"][1]["frames"][2]["index"] = "three"
        self.write("a.json", json.dumps(self.results))
        self.assert_refused(["report", "a.json"], ["rows[1].frames[2].index", "no number"])
        self.assert_refused(["report", ".", "--max-mib", "0"], ["--max-mib"])
        self.write("report.html", "mine")
        self.assert_refused(["report", "."], ["report.html", "--overwrite"])
        self.assertEqual((self.folder / "report.html").read_text(), "mine")


if __name__ == "__main__":
    harness.main()
