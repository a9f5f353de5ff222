# SPDX-License-Identifier: Apache-2.0
"""`gazetrace gaze measure` and the page that `gazetrace gaze report` makes of it."""

import csv
import io
import json
import math
import re
import xml.etree.ElementTree

import harness
import reports
from gaze_study_test import blocks

from gazetrace_report.gaze_command import main


def table(path):
    return list(csv.DictReader(io.StringIO(path.read_text()), delimiter="\t"))


def drawn_text(svg):
    return [" ".join(text.itertext()) for text in xml.etree.ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]


class GazeReport(reports.ReportTest):
    def test_one_file_that_loads_nothing(self):
        self.run_ok("gaze", "synth", "-o", "log.csv", "--duration", "5s", "--noise", "0.05")
        self.run_ok("gaze", "report", "log.csv", "-o", "page.html", "--json", "page.json", "--parts", "parts")  # by the program
        page = (self.folder / "page.html").read_text()
        self.assertNotIn("<script", page)
        self.assert_stands_alone(page)
        numbers = json.loads((self.folder / "page.json").read_text())
        self.assertAlmostEqual(numbers["quality"][0]["precision_rms_s2s"], 0.1, delta=0.015)
        self.assertGreater(numbers["events"]["fixation"]["count"], 8)
        self.assertLessEqual({"main_sequence.svg", "heat_map.svg", "scanpath.svg", "x_over_time.svg", "events.tsv", "samples.tsv"}, set(self.files("parts")))
        for name in self.files("parts"):
            if name.endswith(".svg"):
                self.assertNotRegex((self.folder / "parts" / name).read_text(), r"\b(nan|inf)\b")
        self.assertNotIn("To be checked", page)
        self.refused(main, ["log.csv", "-o", "page.html"], ["exists already"])
        self.refused(main, ["log.csv", "-o", "other.html", "--heat-sigma", "0"], ["--heat-sigma"])
        self.refused(main, ["log.csv", "-o", "log.csv", "--overwrite"], ["log.csv", "name another file"])
        self.assertEqual(self.report(main, "none.csv", "-o", "other.html")[2], 2)
        self.refused(main, ["log.csv", "-o", "other.html", "--tables", "t"], ["--tables", "--parts"])
        self.refused(main, ["log.csv", "--heat-sigma", "wide"], ["--heat-sigma", "see 'gazetrace gaze report --help'"])
        for words in ([], ["--"], ["-o", "other.html"]):
            self.refused(main, words, ["name a gaze log"])
        (self.folder / "--tables").write_text((self.folder / "log.csv").read_text())
        self.made(main, "-o", "dashes.html", "--", "--tables")
        self.assertIn(f"{numbers['quality'][0]['samples']} samples", (self.folder / "dashes.html").read_text())

    def test_the_numbers_are_those_of_the_measurement(self):
        """Both tables and the headline: each figure is that of the JSON, of one eye and of two with doubtful events."""
        self.run_ok("gaze", "synth", "-o", "log.csv", "--duration", "5s", "--noise", "0.05")
        both_eyes = harness.SOURCE / "gazelogs/bids/sub-01_task-view_recording-eye1_physio.tsv.gz"
        units = {"Sampling rate": ("sampling_rate_hz", "Hz", 4), "Effective rate": ("effective_rate_hz", "Hz", 4), "Data loss": ("data_loss", "%", 3),
                 "Accuracy, mean": ("accuracy_deg", "deg", 3), "Accuracy, worst": ("accuracy_max_deg", "deg", 3), "Precision, RMS-S2S": ("precision_rms_s2s", "deg", 3),
                 "Precision, SD": ("precision_sd", "deg", 3), "Recorded": ("duration_s", "s", 5), "Samples": ("samples", "", None)}
        for log, columns in (("log.csv", 1), (both_eyes, 3)):
            self.made(main, log, "-o", "page.html", "--json", "page.json", "--overwrite")
            page = reports.Page((self.folder / "page.html").read_text())
            numbers = json.loads((self.folder / "page.json").read_text())
            measured = json.loads(self.run_ok("gaze", "measure", log, "--json").stdout)
            self.assertEqual((measured["quality"], measured["events"]), (numbers["quality"], numbers["events"]))
            tables_left = dict(page.captioned)
            quality = tables_left.pop("Quality of the data")
            self.assertEqual(quality[0][1:], [of["of"] for of in measured["quality"]])
            self.assertEqual((len(quality[0]), [row[0] for row in quality[1:]]), (1 + columns, list(units)))

            def shows(text, name, of):
                key, unit, digits = units[name]
                if digits is None or of[key] is None:
                    self.assertEqual(text, "not known" if of[key] is None else str(of[key]))
                else:
                    figure, _, shown_unit = text.partition(" ")
                    self.assertEqual(shown_unit, unit)
                    self.assert_shows(figure, 100 * of[key] if unit == "%" else of[key], digits)

            for name, *cells in quality[1:]:
                for text, of in zip(cells, measured["quality"], strict=True):
                    shows(text, name, of)
            events = tables_left.pop(f"Events by {measured['method']}")
            self.assertEqual(events[0], ["", "count", "median duration", "middle half", "median amplitude"])
            self.assertEqual([row[0] for row in events[1:]], [name for name, of in measured["events"].items() if of["count"] and name != "unclassified"])
            for name, count, median, half, amplitude in events[1:]:
                of = measured["events"][name]
                self.assertEqual((count, median[-3:], half[-3:]), (str(of["count"]), " ms", " ms"))
                for text, key in zip((median[:-3], *half[:-3].split(" to ")), ("median", "q1", "q3"), strict=True):
                    self.assertLessEqual(abs(float(text) - of[f"duration_ms_{key}"]), 0.5)
                if of["amplitude_deg_median"] is None:
                    self.assertEqual(amplitude, "")
                else:
                    self.assertLessEqual(abs(float(amplitude.removesuffix(" deg")) - of["amplitude_deg_median"]), 0.005)
            self.assertEqual(tables_left, {}, "of these this test reads no figure")
            said = re.fullmatch(r"(\d+) samples in ([\d.]+ s), (\d+) fixations, data loss (.*)", page.headline)
            for text, name in ((said[1], "Samples"), (said[2], "Recorded"), (said[4], "Data loss")):
                shows(text, name, measured["quality"][0])
            self.assertEqual(said[3], str(measured["events"]["fixation"]["count"]))

    def test_logs_of_which_little_is_known(self):
        """One sample, none that is usable, no screen: what is not known is said to be."""
        head = "# gazetrace-gaze 1\n# display_px 1920 1080\n# display_mm 510 287\n# distance_mm 650\nt[ns],u[1],v[1],valid,eye\n"
        for name, rows in (("one", ["0,0.5,0.5,ok,cyclopean"]), ("lost", [f"{i * 10_000_000},,,lost,cyclopean" for i in range(50)]),
                           ("still", [f"{i * 10_000_000},0.5,0.5,ok,cyclopean" for i in range(50)]), ("two", ["0,0.5,0.5,ok,cyclopean", "10000000,,,lost,cyclopean"])):
            self.write(f"{name}.csv", head + "\n".join(rows) + "\n")
            out, err, code = self.report(main, f"{name}.csv", "-o", f"{name}.html")
            self.assertEqual(code, 0, err)
            self.assertNotIn("nan", out)
            page = (self.folder / f"{name}.html").read_text()
            self.assertNotRegex(re.sub(r"<svg.*?</svg>", "", page, flags=re.S), r"\b(nan|inf|None)\b")
        self.assertIn("data loss 100", self.report(main, "lost.csv", "-o", "lost.html", "--overwrite")[0])

    def test_doubts_are_said(self):
        self.run_ok("gaze", "synth", "-o", "noisy.csv", "--duration", "20s", "--noise", "0.5", "--rate", "300")
        self.made(main, "noisy.csv", "-o", "noisy.html")
        page = (self.folder / "noisy.html").read_text()
        self.assertTrue(re.search(r"<li>events by ivt: noise of .*these events are not to be relied on; ", page, re.S))
        self.assertFalse(re.findall(".{30}`", page))
        self.assertIn("6000 samples in 20 s, ", reports.Page(page).headline)
        self.assertTrue(reports.Page(page).headline.endswith(" fixations, data loss 0 %"), reports.Page(page).headline)  # none is missing
        self.assertTrue("<code>--gaze-process</code> one-euro" in page)
        self.write("<b>&.csv", (self.folder / "noisy.csv").read_text())
        self.made(main, "<b>&.csv", "-o", "named.html")
        self.assertFalse("<b>&.csv" in (self.folder / "named.html").read_text())

    def test_the_heat_map_is_where_and_as_long_as_fixations_were(self):
        """Half a second on each of two places: two peaks of seconds / (2 pi sigma^2) there."""
        self.write("log.csv", "# gazetrace-gaze 1\n# display_px 1600 900\n# display_mm 640 360\n# distance_mm 600\nt[ns],u[1],v[1],valid,eye\n" +
                   "".join(f"{i * 4_000_000},{0.25 if i < 125 else 0.75},{0.4 if i < 125 else 0.6},ok,cyclopean\n" for i in range(250)))
        measured = json.loads(self.run_ok("gaze", "measure", "log.csv", "--json", "--tables", "t").stdout)
        import pandas
        from gazetrace_report import gaze_diagrams
        read = {name: pandas.read_csv(self.folder / "t" / name, sep="\t", na_values="n/a") for name in ("events.tsv", "samples.tsv")}
        recording = gaze_diagrams.Recording(measured, read["events.tsv"], read["samples.tsv"], heat_sigma_deg=2)
        fixations = gaze_diagrams._fixations(recording, -1, 9)
        self.assertEqual(len(fixations), 2)
        heat = gaze_diagrams.heat(recording, fixations)
        self.assertEqual(heat.shape, (135, 240))
        for u, v, seconds in ((0.25, 0.4, fixations.duration_ms.iloc[0] / 1000), (0.75, 0.6, fixations.duration_ms.iloc[1] / 1000)):
            self.assertAlmostEqual(heat[int(135 * v), int(240 * u)], seconds / (2 * math.pi * 4), delta=0.01 * seconds)
        # 4 degrees to the side of straight ahead, half of the peak is left of a spot that has its half width there.
        x = math.tan(math.atan((0.25 - 0.5) * 640 / 600) + math.radians(2 * math.sqrt(2 * math.log(2)))) * 600 / 640 + 0.5
        self.assertAlmostEqual(heat[54, int(240 * x)] / heat[54, 60], 0.5, delta=0.06)

    def test_each_trial_has_its_own_places(self):
        self.write("blocks.asc", blocks(3))
        self.made(main, "blocks.asc", "--screen-cm", "40,30", "--screen-distance-cm", "60", "-o", "page.html", "--json", "page.json", "--parts", "parts")
        counts = [int(count) for count in re.findall(r"(\d+) fixations, area by duration", (self.folder / "page.html").read_text())]
        self.assertEqual(len(counts), 3)
        self.assertEqual(sum(counts), json.loads((self.folder / "page.json").read_text())["events"]["fixation"]["count"])
        names = self.files("parts")
        self.assertEqual([name for name in names if name.startswith("scanpath")], [f"scanpath_trial_00{n}.svg" for n in (1, 2, 3)])
        self.assertEqual(len([name for name in names if name.startswith("heat_map")]), 3)
        self.assertIn("Scanpath, trial 2", drawn_text((self.folder / "parts/scanpath_trial_002.svg").read_text()))
        self.made(main, "blocks.asc", "--trial", "2", "-o", "two.html", "--parts", "two")
        self.assertIn("scanpath.svg", self.files("two"))
        self.assertIn("blocks.asc, trial 2", (self.folder / "two.html").read_text())
        # Names of trials are texts of the recording, which are shown where they are asked for.
        self.run_ok("gaze", "import", "blocks.asc", "--trial-start", "TRIALID *", "--keep-ids", "-o", "named.csv")
        options = ["named.csv", "-o", "named.html", "--overwrite"]
        self.made(main, *options)
        self.assertNotIn("TRIALID", (self.folder / "named.html").read_text())
        self.made(main, *options, "--keep-ids")
        self.assertIn("trial 2: TRIALID 2", (self.folder / "named.html").read_text())

    def test_lines_over_time_end_where_nothing_was_recorded(self):
        """However many samples there are; and no excursion is lost."""
        import numpy
        from gazetrace_report import gaze_diagrams
        for count in (400, 9000):
            seconds = numpy.arange(count) * 0.001
            seconds[count // 2:] += 2
            values = numpy.linspace(0, 1, count)
            values[7] = 5
            times, drawn = gaze_diagrams.course(seconds, values)
            self.assertLess(len(times), 3000)
            self.assertEqual((numpy.nanmax(drawn), numpy.nanmin(drawn)), (5, 0))
            inside = numpy.flatnonzero(numpy.diff(times) > 1)
            self.assertEqual(len(inside), 1)
            self.assertTrue(numpy.isnan(drawn[inside[0]]) or numpy.isnan(drawn[inside[0] + 1]))
            self.assertEqual(numpy.isnan(drawn).sum(), 1)

    def test_numbers_of_a_scanpath_stand_clear(self):
        """Of each other and of the discs, where there is room; all fixations of a head that turns are on its axes."""
        import numpy
        import pandas
        from matplotlib.text import Text
        from gazetrace_report import drawing, gaze_diagrams
        with drawing.figure(4.6, 3.9) as (fig, axes):
            axes.set(xlim=(0, 1), ylim=(1, 0))
            discs = [(0.5, 0.5, 14), (0.52, 0.5, 5), (0.48, 0.53, 9), (0.8, 0.2, 3)]
            labels = drawing.Labels(fig, axes)
            for x, y, radius in discs:
                labels.keep_clear(gaze_diagrams.Estimate(x), gaze_diagrams.Estimate(y), radius)
            for number, (x, y, radius) in enumerate(discs, 1):
                labels.put(x, y, str(number), "#000000", 7, radius)
            fig.canvas.draw()
            drawn = [Text.get_window_extent(text) for text in axes.texts if text.get_text()]  # without the line to its disc
            self.assertEqual(len(drawn), 4)
            for i, box in enumerate(drawn):
                self.assertFalse([other for other in drawn[:i] if box.overlaps(other)])
                for x, y, radius in discs:
                    middle = axes.transData.transform((x, y))
                    nearest = numpy.clip(middle, (box.x0, box.y0), (box.x1, box.y1))
                    self.assertGreater(numpy.hypot(*(nearest - middle)), radius * fig.dpi / 72 * 0.8)
        azimuths = numpy.radians([150, 170, -170, -150])  # to the right, past the back
        events = pandas.DataFrame({"movement": "fixation", "onset_ns": range(4), "dx": numpy.sin(azimuths), "dy": 0.1, "dz": -numpy.cos(azimuths)})
        recording = gaze_diagrams.Recording({"first_ns": 0, "kind": "direction", "picture": None, "trials": []}, events, pandas.DataFrame({"t_ns": range(4)}))
        across = numpy.sort(gaze_diagrams._fixations(recording).x)
        numpy.testing.assert_allclose(numpy.diff(across), 20)
        (left, right), _ = gaze_diagrams._directions(recording)
        self.assertTrue(left < across[0] and across[-1] < right < left + 90)

    def test_a_picture_behind_the_places(self):
        self.run_ok("gaze", "synth", "-o", "log.csv", "--duration", "3s")
        self.write("f.png", harness.png(8, 4, lambda x, y: (30 * x, 60 * y, 90)))
        self.made(main, "log.csv", "-o", "page.html", "--frame-image", "f.png")
        page = (self.folder / "page.html").read_text()
        self.assert_stands_alone(page)
        self.assertGreater(page.count("data:image/png;base64,"), 2)
        self.write("f.txt", "no picture")
        for name in ("f.txt", "none.png"):
            self.refused(main, ["log.csv", "-o", "other.html", "--frame-image", name], [name])

    def test_vergence_of_eyes_that_look_at_a_point_of_the_screen(self):
        both = [row for i in range(300) for row in (f"{i * 10_000_000},0.5,0.5,ok,left", f"{i * 10_000_000},0.5,0.5,ok,right")]
        self.write("log.csv", "# gazetrace-gaze 1\n# display_px 1920 1080\n# display_mm 510 287\n# distance_mm 650\nt[ns],u[1],v[1],valid,eye\n" + "\n".join(both) + "\n")
        measure = ["gaze", "measure", "log.csv", "--json", "--tables", "parts", "--overwrite"]
        vergence = json.loads(self.run_ok(*measure, "--pupil-distance", "63").stdout)["vergence"]
        expected_deg = math.degrees(2 * math.atan(31.5 / 650))
        rows = table(self.folder / "parts/vergence.tsv")
        self.assertEqual(len(rows), 300)
        for row in rows:
            self.assertAlmostEqual(float(row["vergence_deg"]), expected_deg, places=3)
            self.assertAlmostEqual(float(row["distance_mm"]), 650, places=1)
            self.assertEqual(float(row["horizontal_deg"]), 0)
        self.assertAlmostEqual(vergence["angle_deg_median"], expected_deg, places=9)
        self.assertEqual([vergence["pupil_distance_mm"], vergence["pupil_distance_is"]], [63, "stated"])
        self.assertIn("pupil-distance", json.loads(self.run_ok(*measure).stdout)["vergence"]["missing"])
        self.assertEqual({r["vergence_deg"] for r in table(self.folder / "parts/vergence.tsv")}, {"n/a"})
        processed = json.loads(self.run_ok(*measure, "--pupil-distance", "63", "--gaze-process", "median:samples=3").stdout)
        self.assertIn("processing", processed["vergence"]["missing"])
        self.assert_refused([*measure, "--pupil-distance", "6.3"], ["pupil-distance", "30 to 100 mm"])
        self.made(main, "log.csv", "-o", "page.html", "--pupil-distance", "63")
        self.assertIn("Pupils 63.0 mm apart", (self.folder / "page.html").read_text())
        self.made(main, "log.csv", "-o", "page.html", "--overwrite")
        self.assertIn("No vergence: the distance between the pupils is not known", (self.folder / "page.html").read_text())

    def test_processed_gaze_and_its_durations(self):
        self.run_ok("gaze", "synth", "-o", "log.csv", "--duration", "20s", "--noise", "0.05", "--rate", "60")
        for steps in ([], ["--gaze-process", "median:samples=5"]):
            self.made(main, "log.csv", "-o", "page.html", "--json", "page.json", "--parts", "parts", "--overwrite", *steps)
            self.run_ok("gaze", "events", "log.csv", "-o", "events.tsv", "--overwrite", *steps)
            self.assertEqual((self.folder / "parts/events.tsv").read_text(), (self.folder / "events.tsv").read_text())
            rows = table(self.folder / "events.tsv")
            numbers = json.loads((self.folder / "page.json").read_text())
            for movement in ("fixation", "saccade"):
                durations = sorted(float(row["duration_ms"]) for row in rows if row["movement"] == movement)
                self.assertGreater(durations[0], 0)
                self.assertAlmostEqual(numbers["events"][movement]["duration_ms_median"], durations[len(durations) // 2 - (len(durations) % 2 == 0)], places=2)
            # The drawing shows the median that the numbers have.
            drawn = " ".join(drawn_text((self.folder / "parts/saccade_amplitudes.svg").read_text()))
            self.assertEqual(float(re.search(r"median ([0-9.e+]+)", drawn).group(1)), float(f"{numbers['events']['saccade']['amplitude_deg_median']:.3g}"))
            # The quality stays that of the recording.
            self.assertAlmostEqual(numbers["quality"][0]["precision_rms_s2s"], 0.1, delta=0.015)
        self.assertIn("median", "".join(numbers["warnings"]))


if __name__ == "__main__":
    reports.main()
