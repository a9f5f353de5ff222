# SPDX-License-Identifier: Apache-2.0
"""`gazetrace report`: the page stands alone, stays below its limit and shows the numbers of results.json; diagrams are
well-formed; sentences and tables follow from the numbers."""

import copy
import csv
import json
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
import xml.etree.ElementTree

import harness
import reports
import small_results

from gazetrace_report import diagrams, drawing, findings, pictures, sweep_page, tables, viewer, words
from gazetrace_report.errors import Error
from gazetrace_report.results import ROLES, Estimate, Results
from gazetrace_report.sweep_command import main


def estimate(mean, low, high, resolved=True):
    return {"mean": mean, "low": low, "high": high, "resolved": resolved}


def row(name, role, flip):
    return {"id": name, "scene": "box", "gaze": "glide", "role": role, "of": None if role == "test" else "t", "label": f"run {name}", "settings": {},
            "time_s": {"mean": 2, "low": 1.9, "high": 2.1}, "samples": 1e6, "spp_mean": None, "rays": None, "peak_mib": None,
            "speed_up": {"mean": 4, "low": 3.8, "high": 4.2}, "efficiency": None, "scores": {"flip": {"whole": flip}}, "frames": []}


def results(*rows):
    return {"format": "gazetrace-sweep-1", "title": "a sweep", "bands_deg": [0, 2.6, 60], "metrics": [{"name": "flip", "better": "lower"}],
            "scenes": [{"name": "box", "reference": {"spp": 64, "floor": {"flip": {"whole": 0.01}}}}], "rows": list(rows)}


NOTHING = {"mean": None, "low": None, "high": None}


class Report(reports.ReportTest):
    @classmethod
    def setUpClass(cls):
        cls.made_once = tempfile.mkdtemp(prefix="gazetrace_report_")
        cls.addClassCleanup(shutil.rmtree, cls.made_once, True)
        small_results.make(cls.made_once)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.made_once, self.folder, dirs_exist_ok=True)
        self.results = json.loads((self.folder / "results.json").read_text())

    def page_of(self, most_mib=5):
        """A page without diagrams, and its warnings."""
        return sweep_page.make(Results(self.folder), [], most_mib)

    def page(self):
        return reports.Page((self.folder / "report.html").read_text())

    def test_the_page_stands_alone(self):
        self.run_ok("report", ".")  # by the program, which starts the one that makes the page
        page = self.page()
        self.assert_stands_alone(page.text)
        # What markup the results hold is shown, not obeyed.
        self.assertIn("Box &amp; &lt;glide&gt;", page.text)
        self.assertNotIn("<glide>", page.text)
        self.assertNotIn("<equal samples>", page.text)
        data = json.loads(page.scripts["data"])
        self.assertEqual([run["label"] for run in data["sets"][0]["runs"]], ["reference", *(label for _, _, _, label, _ in small_results.RUNS)])
        self.assertEqual(len(data["pictures"]), 4 * 3)
        self.assertTrue(all(picture.startswith("data:image/png;base64,") for picture in data["pictures"]))
        frame = data["sets"][0]["frames"][0]
        self.assertAlmostEqual(frame["gaze"][0], self.results["rows"][0]["frames"][0]["gaze_px"][0] / 64)
        self.assertAlmostEqual(frame["rings"][1], 1 / 5)
        self.assertIn("unresolved", page.text)
        self.assertIn("insensitive", page.text)
        # The picture comes first; what it was made with stands at the end.
        places = [page.text.index(text) for text in ('id="canvas"', 'id="short"', 'id="diagrams"', 'id="tables"', "version 0.1.0")]
        self.assertEqual(places, sorted(places))
        ids = [text.split('"')[0] for text in page.text.replace('\\"', '"').split(' id="')[1:]]
        self.assertEqual(len(ids), len(set(ids)), "an id is used once, also by those of drawings")

    def test_the_numbers_are_those_of_the_results(self):
        """Every table, the headline, the sentences and the frame viewer: each figure is that of results.json."""
        raw = self.results
        foveated, uniform, few = raw["rows"]
        few["reached"] = estimate(1.04321, 1.01234, 1.07654)
        for i, one in enumerate(raw["rows"]):  # what the small renderings did not measure
            one.update(rays=int(12345.6 * 987 ** i), peak_mib=321.987 * (i + 1), efficiency=2.345678 / (i + 1))
        foveated["published"] = [{"speed_up": 57.2534, "source": "Table 1"}]
        for part, score in foveated["scores"]["flip"].items():  # the same cost without foveation is better, everywhere or here
            few["scores"]["flip"][part] = {key: value if value is None or key == "resolved" else value / 10 for key, value in score.items()}
        raw["fixed_quality"] += [{"metric": "mse", "at": 0.0123456, "scene": "box", "gaze": "glide", "speed_up": 3.141593, "model_gain": 1.234567, "bound": ">"}]
        raw["controls"][0]["of"] = "fov"
        raw["controls"] += [{"scene": "box", "gaze": "glide", "metric": "flip fovea", "of": "fov", "wrong": "center", "right_score": 0.1234567, "wrong_score": 0.7654321,
                             "sensitive": True, "why": ""}]
        raw["shares"] = {"glide": {"fixation": 0.8126, "in-flight": 0.1874}}
        self.write("results.json", json.dumps(raw))
        page = reports.Page(self.page_of()[0])
        tables_left = dict(page.captioned)
        self.assertEqual(len(tables_left), len(page.tables))
        by_name = {f"{one['label']}|{ROLES[one['role']].words}": one for one in raw["rows"]}

        runs = tables_left.pop("box, gaze glide")
        self.assertEqual(runs[0], ["run", "time|s a frame", "speed-up", *(f"{name}|{better} is better" for name, better in small_results.METRICS.items())])
        for name, *cells in runs[1:]:
            name, reached = name.removesuffix(" of its time").split(": ") if "of its time" in name else (name, None)
            if name == "reference from itself|floor":
                self.assertEqual(cells[:2], ["", ""])
                for metric, cell in zip(small_results.METRICS, cells[2:]):
                    self.assert_shows(cell, raw["scenes"][0]["reference"]["floor"].get(metric, {}).get("whole"))
                continue
            one = by_name[name]
            if reached:
                self.assert_shows_estimate(reached.replace(" (", "|").rstrip(")"), one["reached"])
            values = [one["time_s"], one["speed_up"], *(one["scores"][metric]["whole"] for metric in small_results.METRICS)]
            for cell, value in zip(cells, values, strict=True):
                self.assert_shows_estimate(cell, value)
        self.assertEqual(len(runs), 1 + 3 + 1)

        costs = tables_left.pop("Cost, box, gaze glide")
        self.assertEqual(costs[0], ["run", "samples a pixel", "samples", "rays", "peak|MiB", "end-to-end|with output", "efficiency"])
        for name, *cells in costs[1:]:
            for cell, key in zip(cells, ("spp_mean", "samples", "rays", "peak_mib", "end_to_end", "efficiency"), strict=True):
                self.assert_shows(cell, by_name[name][key])
        self.assertEqual(len(costs), 1 + 3)

        shares = dict(zip(Results(self.folder).bands, raw["band_pixel_share"]["glide"]))
        for metric, better in small_results.METRICS.items():
            by_part = tables_left.pop(f"{metric}, {better} is better")
            parts = [head.split("|")[0].removesuffix(" deg") for head in by_part[0][1:]]
            self.assertLessEqual({"0-2.6", "2.6-5.2"}, set(parts))
            for head in by_part[0][1:]:
                part, _, share = head.partition(" deg|")
                if share:
                    self.assert_shows(share.removesuffix(" % of pixels"), 100 * shares[part], 3)
            for name, *cells in by_part[1:]:
                for part, cell in zip(parts, cells, strict=True):
                    self.assert_shows_estimate(cell, by_name[name]["scores"][metric].get(part))
            self.assertEqual(len(by_part), 1 + 3)

        # Verdicts, by whether intervals are apart.
        whole = {}
        for metric, better in small_results.METRICS.items():
            ours, theirs = foveated["scores"][metric]["whole"], few["scores"][metric]["whole"]
            less, more = ours["high"] < theirs["low"], theirs["high"] < ours["low"]
            whole[metric] = ("better" if less == (better == "lower") else "worse") if less or more else "not told apart"
        tally = tables_left.pop("How many foveated runs scored better or worse in whole frames, beside uniform sampling of the same cost")
        self.assertEqual([(row[1], row[2:5]) for row in tally[1:]],
                         [(metric, [str(int(came_out == verdict)) for verdict in ("better", "worse", "not told apart")]) for metric, came_out in whole.items()])
        counts = [list(whole.values()).count(verdict) for verdict in ("better", "worse", "not told apart")]
        said = re.fullmatch(r"Foveated frames were rendered ([\d.]+) times as fast .* better in (\d+) of 4 comparisons, worse in (\d+), and not told apart in (\d+)\."
                            r" The least flattering: (\w+) ([\d.]+) \(.*\) beside ([\d.]+) \(.*\), .*; box, gaze glide\.", page.headline)
        self.assertEqual([int(count) for count in said.groups()[1:4]], counts)
        gains = {}
        for metric, better in small_results.METRICS.items():
            ours, theirs = foveated["scores"][metric]["whole"], few["scores"][metric]["whole"]
            more = (ours["mean"] - theirs["mean"]) * (-1 if better == "lower" else 1)
            gains[metric] = more / (ours["high"] - ours["low"] + theirs["high"] - theirs["low"])
        self.assertEqual(said[5], min(gains, key=gains.get))
        self.assert_shows(said[6], foveated["scores"][said[5]]["whole"]["mean"])
        self.assert_shows(said[7], few["scores"][said[5]]["whole"]["mean"])
        self.assert_shows(said[1], foveated["speed_up"]["mean"])
        losses = tables_left.pop("Where uniform sampling of the same cost scored better")
        self.assertEqual(losses[0], ["metric", "in", "foveated", "uniform", "uniform run", "foveated run"])
        places = {words.part(part): part for part in foveated["scores"]["flip"]}
        for metric, part, ours, theirs, *_ in losses[1:]:
            for shown, one in ((ours, foveated), (theirs, few)):
                self.assert_shows_estimate(shown, one["scores"][metric][places[part]])
        self.assertIn("the whole frame", [row[1] for row in losses[1:] if row[0] == "flip"])

        ((place, run, here, there, where),) = tables_left.pop("Speed-up beside the published one")[1:]
        self.assertEqual((place, run, where), ("box, gaze glide", foveated["label"], "Table 1"))
        self.assert_shows_estimate(here, foveated["speed_up"])
        self.assert_shows(there, 57.2534)
        fixed = tables_left.pop("Speed-up at fixed quality")[1:]
        self.assertEqual([row[1] for row in fixed], ["flip", "mse"])
        for (_, _, at, speed, model, why), one in zip(fixed, raw["fixed_quality"], strict=True):
            self.assert_shows(at, one["at"])
            self.assert_shows(model, one.get("model_gain"))
            if one["speed_up"] is None:
                self.assertEqual((speed, why), ("not known", one["why"]))
            else:
                bound, _, value = speed.partition(" ")
                self.assertEqual(bound, one["bound"])
                self.assert_shows(value, one["speed_up"])
        head, *controls = tables_left.pop("The same settings rendered with a wrong gaze and scored with the right one")
        self.assertEqual(head, ["metric", "gaze", "right", "wrong", "does the metric notice"])  # one scene and gaze, and no reason
        for (metric, gaze, right, wrong, _), one in zip(controls, raw["controls"], strict=True):
            self.assertEqual((metric, gaze), (one["metric"], one["wrong"]))
            self.assert_shows(right, one["right_score"])
            self.assert_shows(wrong, one["wrong_score"])
        self.assertEqual(tables_left, {}, "of these this test reads no figure")

        self.assertIn("frames: fixation 81.3 % and in-flight 18.7 %.", page.text)
        self.assertIn("speed-up at mse 0.01235 is &gt; 3.142", page.text)
        self.assertIn("fovvideovdp is 9.2 when the gaze is mirrored, against 9.1 when it is right", page.text)
        for run in json.loads(page.scripts["data"])["sets"][0]["runs"][1:]:  # the script shows four digits of these
            one = next(one for one in raw["rows"] if one["label"] == run["label"])
            self.assertEqual(run["times"], [frame["time_s"] for frame in one["frames"]])
            self.assertEqual(run["scores"], [frame["scores"] for frame in one["frames"]])

    def test_diagrams_and_their_numbers(self):
        self.made(main, "results.json", "-o", "out.html", "--plots", "plots")
        svgs = [name for name in self.files("plots") if name.endswith(".svg")]
        self.assertEqual(len(svgs), 3 * len(small_results.METRICS))
        for name in svgs:
            root = xml.etree.ElementTree.parse(self.folder / "plots" / name).getroot()
            self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
            self.assertNotRegex((self.folder / "plots" / name).read_text(), r"\b(nan|inf)\b")
            self.assertEqual((self.folder / "plots" / name.replace(".svg", ".pdf")).read_bytes()[:5], b"%PDF-")
            with open(self.folder / "plots" / name.replace(".svg", ".csv"), newline="") as file:
                self.assertGreaterEqual(len(list(csv.DictReader(file))), 3)
        with open(self.folder / "plots/pareto_box_glide_flip.csv", newline="") as file:
            rows = {row["id"]: row for row in csv.DictReader(file)}
        self.assertAlmostEqual(float(rows["few"]["flip"]), self.results["rows"][2]["scores"]["flip"]["whole"]["mean"], 7)
        self.assertEqual({name: row["front"] for name, row in rows.items()}, {"fov": "1", "uni": "1", "few": "0"})
        # Each point has its name beside it.
        drawn = (self.folder / "plots/pareto_box_glide_flip.svg").read_text()
        for _, _, _, label, _ in small_results.RUNS:
            self.assertIn(label[:20].replace("<", "&lt;"), drawn)
        read = Results(self.folder)
        self.assertEqual(diagrams._pareto(read, read.places[0], read.metrics[0], False).svg, drawn)

    def test_the_limit_is_kept_and_said(self):
        shutil.rmtree(self.folder)
        self.folder.mkdir()
        small_results.make(self.folder, "320x180", 4)
        everything = len(self.page_of(64)[0].encode())
        for part in (0.7, 0.4, 0.2):
            limit = round(part * everything / 2**20, 2)
            text = self.page_of(limit)[0]
            self.assertLess(len(text.encode()), limit * 2**20)
            self.assertLess(len(text.encode()), everything)
            self.assertIn(f"limit is {limit:g} MiB", text)
            self.assertTrue("JPEG of quality" in text or "No picture fits" in text)
        self.assertGreater(everything, 2**17)
        self.assertIn("more than the limit", self.page_of(0.01)[1][0])

    def test_pictures_are_averaged_in_linear_light(self):
        from PIL import Image
        image = Image.new("RGB", (3, 1))
        image.putdata([(0, 0, 0), (255, 255, 255), (10, 20, 30)])
        self.assertEqual(list(pictures.averaged(image, 2).getdata()), [(188, 188, 188), (10, 20, 30)])  # half the light is 188
        self.assertEqual(pictures._statement(pictures.Form(1, True, 2), pictures.Embedded("", 6, 4), 4).split("; ")[1], "every second of 4 frames.")
        self.assertEqual([words.ordinal(n) for n in (4, 16)], ["fourth", "16th"])
        self.assertEqual(viewer.frame_path("r/reference.####.png", 7), "r/reference.0007.png")

    def test_missing_pictures_are_said(self):
        (self.folder / "few/p.0002.png").unlink()
        text, warnings = self.page_of()
        self.assertIn("few/p.0002.png", "".join(warnings))
        self.assertIsNone(json.loads(reports.Page(text).scripts["data"])["sets"][0]["runs"][3]["pictures"][1])
        # Where there is nothing to look at, the page says why.
        said = lambda text: re.search(r'id="viewer-none" hidden>([^<]*)', text).group(1)
        self.assertIn("No picture fits", said(self.page_of(0.01)[0]))
        for one in self.results["rows"]:
            one["frames"] = []
        self.write("results.json", json.dumps(self.results))
        self.assertIn("name no pictures", said(self.page_of()[0]))

    def test_whatever_stands_in_the_results(self):
        """Each value in turn becomes null, or something of another kind: there is a page, or one line says where it is wrong."""
        raw = results(*[{**one, "frames": one["frames"][:1]} for one in self.results["rows"][:2]])
        raw.update({key: value for key, value in self.results.items() if key not in ("format", "metrics", "rows")}, metrics=[self.results["metrics"][0]])
        raw["rows"][0]["published"] = [{"speed_up": 3, "source": "Table 1"}]
        for one in raw["rows"]:
            one["scores"] = {"flip": {part: score for part, score in one["scores"]["flip"].items() if part in ("whole", "0-2.6")}}
            one["frames"][0]["scores"] = {"flip": 0.1}
        raw["shares"] = {"glide": {"fixation": 0.8}}

        def places(value, path=()):
            yield path
            items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
            for key, inner in items:
                yield from places(inner, (*path, key))

        seen = {"pages": 0, "refused": 0}
        for path in [path for path in places(raw) if path and path[0] not in ("format", "common_settings")]:
            for value in (None, [], {}, "x", True, "1e999"):
                changed = copy.deepcopy(raw)
                at = changed
                for key in path[:-1]:
                    at = at[key]
                at[path[-1]] = value
                self.write("results.json", json.dumps(changed).replace('"1e999"', "1e999"))
                try:
                    read = Results(self.folder)
                    drawn = sweep_page.draw(read) if value is None and path[0] == "rows" else []
                    page = sweep_page.make(read, drawn, 5)[0]
                    self.assertIsNone(re.search(r"\b(?:nan|inf)\b", page), path)
                    read.to_pandas()
                    seen["pages"] += 1
                except Error as problem:
                    self.assertRegex(str(problem), "results.json: .", path)
                    self.assertEqual(problem.kind, "input")
                    seen["refused"] += 1
                except Exception as problem:
                    raise AssertionError(f"{path} = {value}: {problem!r}") from problem
        self.assertGreater(min(seen.values()), 100, seen)

    def test_places_whose_names_hold_slashes(self):
        rows = [row("a", "test", estimate(0.1, 0.09, 0.11)), row("b", "test", estimate(0.2, 0.19, 0.21))]
        rows[0].update(scene="a/b", gaze="c")
        rows[1].update(scene="a", gaze="b/c")
        self.write("results.json", json.dumps(results(*rows)))
        read = Results(self.folder)
        data = json.loads(reports.Page(sweep_page.make(read, sweep_page.draw(read), 5)[0]).scripts["data"])
        self.assertEqual([one["set"] for one in data["tests"]], ["0", "1"])
        self.assertEqual([one["id"] for one in data["sets"]], ["0", "1"])
        self.assertEqual({one["set"] for one in data["plots"]}, {"0", "1"})

    def test_nothing_is_said_of_fonts(self):
        with self.assertNoLogs("matplotlib", "WARNING"), warnings.catch_warnings():
            warnings.simplefilter("error")
            with drawing.figure() as (fig, axes):
                axes.set_title("\u6f22\u5b57 \U0001f441", fontfamily=["No Such Font", "sans-serif"])
                self.assertIn("\u6f22", drawing.svg_of(fig, "t"))
                drawing.pdf_of(fig, "t")

    def test_a_broken_picture_is_said(self):
        from PIL import Image
        Image.effect_noise((300, 300), 90).convert("RGB").save(self.folder / "few/p.0002.png")
        data = bytearray((self.folder / "few/p.0002.png").read_bytes())
        last = data.rindex(b"IDAT")
        data[last:last + 4] = bytes(4)
        (self.folder / "few/p.0002.png").write_bytes(data)
        self.assertIn("few/p.0002.png: cannot be read as a picture", "".join(self.page_of()[1]))

    def test_a_drawing_stands_twice_in_a_page(self):
        read = Results(self.folder)
        one = diagrams._pareto(read, read.places[0], read.metrics[0], False)
        ids = [set(re.findall(r' id="([^"]+)"', drawing.in_page(one.svg, one.title, n))) for n in (1, 2)]
        self.assertTrue(ids[0])
        self.assertFalse(ids[0] & ids[1])
        for n in (1, 2):
            self.assertLessEqual(set(re.findall(r'(?:url\(#|href="#)([^")]+)', drawing.in_page(one.svg, one.title, n))), ids[n - 1])

    def test_one_frame_has_no_course(self):
        for one in self.results["rows"]:
            one["frames"] = one["frames"][:1]
        self.results["metrics"] = self.results["metrics"][:1]
        self.write("results.json", json.dumps(self.results))
        self.made(main, ".")
        self.assertEqual({plot["kind"] for plot in json.loads(self.page().scripts["data"])["plots"]}, {"pareto", "bands"})

    def test_what_is_refused(self):
        refused = lambda arguments, said, code=2: self.refused(main, arguments, said, code)
        refused(["nowhere"], ["nowhere", "no such file"])
        for content, said in (("{", ["no JSON"]), ("[" * 100_000, ["no JSON"]), ("{}", ["gazetrace-sweep-1"]), ('{"format": "gazetrace-sweep-2"}', ["gazetrace-sweep-2", "gazetrace-sweep-1 only"])):
            self.write("a.json", content)
            refused(["a.json"], ["a.json", *said])
        for change, said in ((lambda r: r["rows"][1]["frames"][2].update(index="three"), ["rows[1].frames[2].index", "no whole number"]),
                             (lambda r: r["rows"][0].update(role="spare"), ["rows[0].role", "no role of a row: 'spare'"]),
                             (lambda r: r["rows"][0].pop("role"), ["rows[0] has no 'role'"]), (lambda r: r.update(rows="none"), ["rows is no list"])):
            broken = copy.deepcopy(self.results)
            change(broken)
            self.write("a.json", json.dumps(broken))
            refused(["a.json"], said)
        refused([".", "--max-mib", "0"], ["--max-mib"])
        for words in (["."] * 2, ["--bytes", "3"], [".", "--max-mib", "many"], []):
            refused(words, ["see 'gazetrace report --help'"])
        refused(["--", "--json"], ["--json", "no such file"])
        self.write("file", "no folder")
        refused([".", "-o", "file/in/it.html"], ["file/in/it.html: cannot be written"], 3)
        self.write("report.html", "mine")
        refused(["."], ["report.html", "--overwrite"])
        refused([".", "-o", "results.json", "--overwrite"], ["results.json", "name another file"])
        refused([".", "--json", "results.json", "--overwrite"], ["results.json", "name another file"])
        self.assertEqual(json.loads((self.folder / "results.json").read_text()), self.results)
        self.assertEqual((self.folder / "report.html").read_text(), "mine")

    def test_without_the_packages_one_line_says_what_to_install(self):
        # A Python that has none of them: its own library alone. A virtual environment does not see what apt installs.
        # What pip installs is found by its own Python alone: another one is not asked.
        installed = self.write("bin/gazetrace-report", "from gazetrace_report.__main__ import sweep\nsweep()\n")
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", self.folder / "venv"], check=True)
        python = self.folder / "venv/bin/python"
        for command, variables, advice in (
                (["/usr/bin/env", "python3", "-S", "-B", harness.PROGRAM + "-report"], {"GAZETRACE_REPORT_TRIED": "1"},
                 "'apt-get install python3-matplotlib python3-jinja2 python3-pandas'"),
                ([python, "-B", installed], {"PYTHONPATH": str(harness.SOURCE / "python")}, f"'{python} -m pip install matplotlib jinja2 pandas'")):
            done = subprocess.run([*command, str(self.folder)], capture_output=True, text=True, env={"PATH": "/usr/bin:/bin", **variables})
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertIn(advice, done.stderr)

    def test_the_demo_finishes_without_the_page(self):
        (self.folder / "data").mkdir()
        for name in ("scenes", "gazelogs"):
            (self.folder / "data" / name).symlink_to(harness.SOURCE / name)
        self.write("data/examples/example.toml", (harness.SOURCE / "examples/example.toml").read_text())
        self.write("data/examples/demo.toml", '[common]\nsize = "32x18"\nfps = "10"\nframes = "8"\n[[scene]]\nname = "yard"\npath = "../scenes/courtyard/courtyard.gltf"\n'
                   'camera = "walk"\n[[gaze]]\nname = "reader"\nlog = "../gazelogs/tx300_left.csv"\n[grid]\nregion-samples = [[4, 2, 1]]\n[reference]\nspp = 4\n'
                   '[measure]\nrepeats = 2\nreference-rate = 4\nmetrics = ["mse"]\nbaselines = ["none"]\ncontrols = false\n')
        self.write("bin/python3", '#!/bin/sh\nexec /usr/bin/python3 -S "$@"\n').chmod(0o755)  # its own library alone
        variables = {"PATH": f"{self.folder}/bin:/usr/bin:/bin", "GAZETRACE_REPORT_TRIED": "1"}
        for name, environment, has_page in (("with", {}, True), ("without", variables, False)):
            done = self.run_ok("demo", name, "--data", "data", "--frames", "1", "--size", "32x18", environment=environment, alone=True)
            self.assertEqual("report.html" in done.stdout, has_page, done.stdout)
            self.assertEqual((self.folder / name / "report.html").exists(), has_page)
            self.assertEqual("apt-get install python3-matplotlib" in done.stderr, not has_page)

    def test_a_program_on_the_path_is_a_command(self):
        script = self.write("bin/gazetrace-hello-there", '#!/bin/sh\nprintf "<%s>" "$@"\nexit 7\n')
        script.chmod(0o755)
        self.write("bin/gazetrace-gaze-wave", '#!/bin/sh\necho "waves $*"\n').chmod(0o755)
        path = {"PATH": f"{self.folder}/bin:/usr/bin:/bin"}
        done = self.run_program("hello-there", "a b", "--c", "", "$(d)", environment=path)
        self.assertEqual((done.stdout, done.returncode), ("<a b><--c><><$(d)>", 7))
        self.assertEqual(self.run_ok("gaze", "wave", "1", environment=path).stdout, "waves 1\n")
        self.assertEqual(self.run_ok("help", "gaze", "wave", environment=path).stdout, "waves --help\n")
        self.assert_refused(["hello-there"], ["unknown command"])
        self.assert_refused(["--config", "x.toml", "report", "here"], ["none of its options come before it"])
        self.write("first/gazetrace-gaze-wave", "not for running")
        first = {"PATH": f"{self.folder}/first:{path['PATH']}"}
        self.assertEqual(self.run_ok("gaze", "wave", "2", environment=first).stdout, "waves 2\n")
        # A closed pipe ends it, as it ends every other program.
        self.write("bin/gazetrace-signals", "#!/bin/sh\ngrep SigIgn /proc/self/status\n").chmod(0o755)
        ignored = int(self.run_ok("signals", environment=path, alone=True).stdout.split()[1], 16)
        self.assertEqual(ignored & (1 << 12 | 1 << 24), 0)
        self.assertIn("--max-mib", self.run_ok("help", "report").stdout)
        self.assertIn("report", self.run_ok("--help").stdout)


class Findings(reports.ReportTest):
    def read(self, raw):
        self.write("results.json", json.dumps(raw))
        return Results(self.folder)

    def compared(self, *rows, better="lower"):
        raw = results(*rows)
        raw["metrics"][0]["better"] = better
        return findings.comparisons(self.read(raw))

    def test_losses_follow_from_intervals_apart(self):
        lost = lambda ours, theirs, better="lower": findings.losses(self.compared(row("t", "test", ours), row("u", "equal-time", theirs), better=better))
        one = lost(estimate(0.12, 0.11, 0.13), estimate(0.10, 0.09, 0.105))
        self.assertEqual(list(one[["uniform run", "metric", "in"]].iloc[0]), ["uniform, equal time", "flip", "the whole frame"])
        self.assertEqual((one["uniform"][0].mean, one["foveated"][0].mean), (0.10, 0.12))
        self.assertTrue(lost(estimate(0.12, 0.11, 0.13), estimate(0.10, 0.09, 0.111)).empty)  # they overlap
        self.assertTrue(lost(estimate(0.10, 0.09, 0.105), estimate(0.12, 0.11, 0.13)).empty)  # a gain
        verdict = lambda a, b, lower: findings.verdict(Estimate(*a), Estimate(*b), lower)
        for lower in (True, False):
            better, worse = ("better", "worse") if lower else ("worse", "better")
            self.assertEqual(verdict((1, 0.9, 1.1), (1.3, 1.2, 1.4), lower), better)
            self.assertEqual(verdict((1.3, 1.2, 1.4), (1, 0.9, 1.1), lower), worse)
            self.assertEqual(verdict((1, 0.9, 1.25), (1.3, 1.2, 1.4), lower), "not told apart")
            self.assertEqual(verdict((1, None, None), (1.3, 1.2, 1.4), lower), "not told apart")
        self.assertTrue(lost(estimate(0.002, 0.0019, 0.0021, False), estimate(0.001, 0.0009, 0.0011, False)).empty)
        self.assertEqual(len(lost(estimate(9.1, 9.0, 9.2), estimate(9.5, 9.4, 9.6), "higher")), 1)

    def test_the_tally_counts_every_comparison(self):
        rows = [row("t", "test", estimate(0.12, 0.11, 0.13)), row("a", "equal-time", estimate(0.10, 0.09, 0.105)), row("b", "equal-samples", estimate(0.2, 0.19, 0.21)),
                row("c", "low-resolution", estimate(0.12, 0.11, 0.13)), row("d", "uniform-reference-rate", estimate(0.01, 0.009, 0.011))]
        counts = findings.tally(self.compared(*rows))
        self.assertEqual(counts.sum().to_dict(), {"better": 1, "worse": 1, "not told apart": 1, "under the reference's noise": 0})
        rows[0]["scores"]["flip"]["whole"] = NOTHING
        self.assertTrue(findings.tally(self.compared(*rows)).empty)
        self.assertRegex("\n".join(findings.caveats(self.read(results(*rows)))), "no metric has a score")

    def test_the_least_flattering_has_both_intervals(self):
        least = lambda *rows: findings.least_flattering(self.compared(*rows))
        ours = row("t", "test", estimate(0.12, 0.11, 0.13))
        near, far = row("a", "equal-time", estimate(0.13, 0.12, 0.14)), row("b", "equal-samples", estimate(0.2, 0.19, 0.21))
        exact = row("c", "low-resolution", estimate(0.11, 0.11, 0.11))
        bare = row("d", "low-resolution", {**estimate(0.01, 0.01, 0.01), "low": None, "high": None})  # one repeat
        self.assertEqual(least(ours, near, far).baseline.id, "a")
        self.assertEqual(least(ours, near, bare).baseline.id, "a")
        self.assertIsNone(least(ours, bare))
        ours["scores"]["flip"]["whole"] = estimate(0.12, 0.12, 0.12)
        self.assertEqual(least(ours, near, exact).baseline.id, "c")  # a loss without any width
        self.assertNotIn("least flattering", findings.headline(*(lambda read: (read, findings.comparisons(read)))(self.read(results(ours, bare)))))

    def test_speed_and_what_it_is_worth(self):
        slow = row("t", "test", estimate(0.1, 0.09, 0.11))
        said = lambda raw: "\n".join(findings.caveats(self.read(raw)))
        slow["speed_up"] = estimate(0.8, 0.75, 0.85)
        self.assertRegex(said(results(slow)), "slower than uniform sampling(.|\n)*nothing is claimed for foveation")
        slow["speed_up"] = estimate(1.05, 0.95, 1.15)
        self.assertRegex(said(results(slow)), "not told apart from 1")
        self.assertNotRegex(said(results(slow)), "slower")
        raw = results(slow)
        raw["fixed_quality"] = [{"metric": "flip", "at": 0.05, "scene": "box", "gaze": "glide", "speed_up": 3, "bound": ">", "why": "uniform never reaches it"}]
        self.assertIn("is > 3, uniform never reaches it", said(raw))
        # Two repeats give intervals such as 5e-6 to 7e7, which say nothing but that there were too few.
        slow["speed_up"] = estimate(20, 5e-6, 7e7)
        few = self.read(results(slow))
        self.assertRegex(findings.headline(few, findings.comparisons(few)), "20 times as fast.*Too few repeats")
        made = tables.runs(few, few.places[0])
        self.assertIn("too few repeats for an interval", made)
        self.assertNotIn("7e+07", made)

    def test_controls_may_be_undecided(self):
        """Worse is more for some metrics and less for others; one repeat, or a loss within their spread, decides nothing."""
        raw = results(row("t", "test", estimate(0.1, 0.09, 0.11)))
        raw["metrics"].append({"name": "psnr", "better": "higher"})
        raw["rows"][0]["scores"]["psnr"] = {"whole": estimate(30, 29, 31)}
        control = lambda metric, right, wrong: {"scene": "box", "gaze": "glide", "metric": metric, "of": "t", "wrong": "mirrored", "right_score": right,
                                                "wrong_score": wrong, "sensitive": False, "why": "it was <said>"}

        def verdict(*words_of_control):
            raw["controls"] = [control(*words_of_control)]
            read = self.read(raw)
            return read.control_verdict(read.raw["controls"][0])

        self.assertEqual([verdict("flip", 0.1, 0.13), verdict("flip", 0.1, 0.09), verdict("flip weighted", 0.1, 0.13), verdict("psnr", 30, 29), verdict("psnr", 30, 31)],
                         ["undecided", "insensitive", "undecided", "undecided", "insensitive"])
        raw["rows"][0]["scores"]["psnr"]["whole"] = {"mean": 30, "low": None, "high": None, "resolved": True}
        self.assertEqual(verdict("psnr", 30, 31), "undecided")
        said = "\n".join(findings.caveats(self.read(raw)))
        self.assertIn("psnr is 31 when the gaze is mirrored, against 30 when it is right; whether it notices is undecided (it was <said>)", said)
        self.assertNotIn("insensitive", said)
        self.assertIn("it was &lt;said&gt;", tables.controls(self.read(raw)))
        raw["controls"] = [control("flip", 0.1, 0.09 if i < 40 else 0.13) for i in range(45)]
        said = findings.caveats(self.read(raw))
        self.assertIn("flip: of 45 controls with a wrong gaze it notices 0, is insensitive to 40, and 5 are undecided", "\n".join(said))
        self.assertLess(len(said), 5)
        self.assertIn("<summary>35 more</summary>", tables.controls(self.read(raw)))
        for one in raw["controls"]:
            one["sensitive"] = True
        self.assertNotIn("wrong gaze it notices", "\n".join(findings.caveats(self.read(raw))))

    def test_what_else_is_said(self):
        test, uniform = row("t", "test", estimate(0.1, 0.09, 0.11)), row("u", "uniform-reference-rate", estimate(0.1, 0.09, 0.11))
        test["spp_mean"], uniform["spp_mean"] = 31.4, 32.0
        said = lambda raw: "\n".join(findings.caveats(self.read(raw)))
        self.assertIn("it traces 31.4 samples a pixel where uniform has 32", said(results(test, uniform)))
        test["spp_mean"] = 3.0
        self.assertNotIn("samples a pixel where uniform", said(results(test, uniform)))
        raw = results(row("t", "test", NOTHING))
        for shares, end in (({"fixation": 0.5, "blink": 0.5}, "Scores are of fixations."), ({"in-flight": 1.0}, "No frame is a fixation: scores are of the others that are seen.")):
            raw["shares"] = {"glide": shares}
            self.assertIn(f"nothing is said of its quality. {end}", said(raw))
        late = row("u", "equal-time", estimate(0.1, 0.09, 0.11))
        late["reached"] = estimate(1.04, 1.01, 1.07)
        raw = results(row("t", "test", estimate(0.005, 0.004, 0.006, False)), late)
        raw["shares"] = {"glide": {"fixation": 0.75, "in-flight": 0.25, "blink": 0}}
        raw["rows"][0]["published"] = [{"speed_up": 57.25, "source": "Table <2>"}]
        raw["rows"][0]["end_to_end"] = 2.125
        read = self.read(raw)
        made = tables.runs(read, read.places[0])
        self.assertIn("<small>uniform, equal time: 1.04 (1.01 to 1.07) of its time</small>", made)
        self.assertIn('<span class="unresolved">0.005<small>unresolved</small></span>', made)
        self.assertIn(">0.01<", made)  # the floor
        self.assertEqual(tables.shares(read, read.places[0]), "fixation 75 % and in-flight 25 %")
        self.assertRegex(tables.published(read), "57.25(.|\n)*Table &lt;2&gt;")
        self.assertIn(">2.125<", tables.costs(read, read.places[0]))

    def test_runs_have_names_that_tell_them_apart(self):
        rows = [row("a", "test", estimate(0.1, 0.09, 0.11)), row("b", "test", estimate(0.2, 0.19, 0.21)), row("c", "equal-time", estimate(0.3, 0.29, 0.31))]
        for one in rows:
            one["label"] = "32 / 16 / 8"
        rows[0]["settings"], rows[1]["settings"] = {"filter": "guided"}, {"filter": "linear"}
        names = {one.id: one.name for one in self.read(results(*rows)).rows}
        self.assertEqual(len(set(names.values())), 3)
        self.assertIn("filter guided", names["a"])
        self.assertIn("filter linear", names["b"])
        rows[0]["label"], rows[1]["label"] = "region-samples 32,16,8", "region-samples 16,8,4"
        self.assertEqual([one.short for one in self.read(results(*rows)).rows][:2], ["32,16,8", "16,8,4"])

    def test_baselines_that_several_tests_share(self):
        rows = [row("t", "test", estimate(0.1, 0.09, 0.11)), row("t2", "test", estimate(0.1, 0.09, 0.11)), row("u", "uniform-reference-rate", estimate(0.1, 0.09, 0.11)),
                row("w", "low-resolution", estimate(0.1, 0.09, 0.11))]
        rows[0]["baselines"] = rows[1]["baselines"] = {"uniform-reference-rate": "u"}
        read = self.read(results(*rows))
        self.assertEqual([[one.id for one in read.family(test)] for test in read.tests], [["t", "u", "w"], ["t2", "u"]])
        self.assertEqual([one.id for one in read.rows_in_order(read.places[0])], ["u", "t", "w", "t2"])

    def test_each_reference_has_a_front_and_a_floor(self):
        raw = results()
        raw["scenes"] = [{"name": "box", "reference": {"key": f"box-{n}", "floor": {"flip": {"whole": floor}}}} for n, floor in ((2, 0.151), (1, 0.121))]
        for name, reference, time, flip in (("a", 1, 1, 0.4), ("b", 1, 2, 0.2), ("c", 2, 3, 0.8), ("d", 2, 4, 0.6), ("e", 2, 5, 0.7)):
            raw["rows"].append({**row(name, "test", estimate(flip, flip, flip)), "reference": f"box-{reference}", "time_s": estimate(time, time, time)})
        raw["pareto"] = {"flip": {"box/glide/box-1": ["a", "b"], "box/glide/box-2": ["d", "c"], "box/glider": ["e"]}}
        read = self.read(raw)
        drawn = sweep_page.draw(read)[0]
        self.assertEqual(dict(zip(drawn.numbers.id, drawn.numbers.front)), {"a": 1, "b": 1, "c": 1, "d": 1, "e": 0})
        self.assertEqual(drawn.svg.count("stroke-opacity: 0.35"), 2)
        made = tables.runs(read, read.places[0])
        self.assertRegex(made, "reference box-1 from itself(.|\n)*>0.121<")
        self.assertRegex(made, "reference box-2 from itself")

    def test_odd_results_have_pages(self):
        for raw in (results(), results(row("t", "test", NOTHING)), results(row("t", "test", estimate(0.1, -7, 8)), row("u", "equal-time", estimate(0, 0, 0)))):
            read = self.read(raw)
            page, _ = sweep_page.make(read, sweep_page.draw(read), 5)
            self.assertFalse(re.findall(r".{20}[^a-z-](?:nan|inf)[^a-z]", page))
            self.assertIn("a sweep", page)
        # Names are texts, no formulas, and what is not finite is not known.
        priced = [row("t", "test", estimate(0.1, 0.09, 0.11)), row("u", "equal-time", {"mean": float("inf")}), row("v", "uniform-rate", {"mean": float("nan")})]
        for one in priced:
            one.update(label="a$b^$c {", gaze="$\\frac{")
        read = self.read(results(*priced))
        drawn = sweep_page.draw(read)[0]
        self.assertIn("a$b^$c {", drawn.svg)
        self.assertEqual(list(drawn.numbers.id), ["t"])
        self.assertIn("a$b^$c {", sweep_page.make(read, [drawn], 5)[0])
        self.assertNotIn("matplotlib.pyplot", sys.modules, "a notebook keeps its own backend")
        rows = [row("a/b", "test", estimate(0.1, 0.09, 0.11)), row("a b", "test", estimate(0.1, 0.09, 0.11))]
        for one in rows:
            one["frames"] = [{"index": i, "t_s": i / 10, "time_s": 2, "scores": {"flip": 0.1}} for i in (1, 2)]
        self.assertEqual([one.name for one in sweep_page.draw(self.read(results(*rows)))], ["pareto_box_glide_flip", "time_a-b_flip", "time_a-b_flip-2"])
        self.assertEqual(sweep_page.script_safe({"a": "</script>"}), '{"a":"\\u003c/script>"}')
        self.assertEqual(len({role.words for role in ROLES.values()}), len(ROLES))

    def test_scores_of_parts(self):
        test = row("t", "test", estimate(0.1, 0.09, 0.11))
        self.assertEqual(self.read(results(test)).parts, [])
        test["scores"]["flip"].update({"fovea": estimate(0.0123, 0.012, 0.0126), "weighted": estimate(0.0345, 0.034, 0.035), "2.6+": estimate(0.0567, 0.056, 0.057),
                                       "0-2.6": NOTHING})
        read = self.read(results(test))
        self.assertEqual(read.bands, ["0-2.6", "2.6-60", "60+"])
        test["scores"]["flip"]["2.6-60"] = test["scores"]["flip"].pop("2.6+")
        read = self.read(results(test))
        self.assertEqual(read.parts, ["0-2.6", "2.6-60", "fovea", "weighted"])
        made = tables.bands(read, read.places[0])
        for value in ("0.0123", "0.0345", "0.0567", "2.6-60 deg"):
            self.assertIn(value, made)
        bands = next(one for one in sweep_page.draw(read) if one.kind == "bands")
        self.assertEqual(list(bands.numbers.part), ["2.6-60", "fovea", "weighted"])


if __name__ == "__main__":
    reports.main()
