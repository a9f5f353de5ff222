# SPDX-License-Identifier: Apache-2.0
"""Sentences and tables of `gazetrace report` follow from the numbers of results.json."""

import json
import re
import sys

import reports

from gazetrace_report import findings, sweep_page, tables
from gazetrace_report.results import ROLES, Estimate, Results
from small_results import estimate, results, row


NOTHING = {"mean": None, "low": None, "high": None}


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
