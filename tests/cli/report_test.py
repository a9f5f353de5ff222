# SPDX-License-Identifier: Apache-2.0
"""`gazetrace report`: the page stands alone, stays below its limit and shows the numbers of results.json; diagrams are
well-formed; programs on the path are commands."""

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

from gazetrace_report import diagrams, drawing, pictures, sweep_page, tables, viewer, words
from gazetrace_report.errors import Error
from gazetrace_report.results import ROLES, Results
from gazetrace_report.sweep_command import main
from small_results import estimate, results, row


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


if __name__ == "__main__":
    reports.main()
