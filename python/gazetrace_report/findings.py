# SPDX-License-Identifier: Apache-2.0
"""What the numbers say: tables of comparisons, and sentences. Two values count as different where their intervals do not
overlap, which is stricter than a test of their difference."""

import math

import pandas

from . import words
from .results import ROLES, SAME_COST

VERDICTS = ("better", "worse", "not told apart", "under the reference's noise")


def verdict(ours, theirs, lower):
    if ours is None or theirs is None:
        return None
    if not ours.resolved and not theirs.resolved:
        return "under the reference's noise"
    if ours.low is None or theirs.low is None:
        return "not told apart"
    if ours.high < theirs.low:
        return "better" if lower else "worse"
    if theirs.high < ours.low:
        return "worse" if lower else "better"
    return "not told apart"


def comparisons(results):
    """A row for each test, uniform run of the same cost, metric and part of the picture."""
    rows = []
    for test in results.tests:
        for baseline in results.family(test):
            if baseline.role not in SAME_COST:
                continue
            for metric in results.metrics:
                for part in ("whole", *results.parts):
                    ours, theirs = test.score(metric.name, part), baseline.score(metric.name, part)
                    came_out = verdict(ours, theirs, metric.lower)
                    if came_out:
                        rows.append((test, baseline, metric.name, part, ours, theirs, came_out, metric.lower))
    return pandas.DataFrame(rows, columns=["test", "baseline", "metric", "part", "ours", "theirs", "verdict", "lower"])


def tally(compared):
    """How comparisons of whole frames came out, by the role of the baseline and the metric."""
    whole = compared[compared.part == "whole"]
    if whole.empty:
        return pandas.DataFrame()
    whole = whole.assign(beside=[ROLES[row.role].words for row in whole.baseline])
    counts = whole.pivot_table(index=["beside", "metric"], columns="verdict", aggfunc="size", fill_value=0, sort=False)
    return counts.reindex(columns=VERDICTS, fill_value=0)


def beside(row):
    """What a run is, and of one of equal time how near it came."""
    reached = row.estimate("reached")
    return ROLES[row.role].words + (f": {words.with_interval(reached)} of its time" if reached else "")


def losses(compared):
    """Where a uniform run of the same cost is better."""
    lost = compared[compared.verdict == "worse"]
    return pandas.DataFrame({  # what a phone shows without scrolling comes first
        "metric": lost.metric,
        "in": [words.part(part) for part in lost.part],
        "foveated": lost.ours,
        "uniform": lost.theirs,
        "uniform run": [beside(row) for row in lost.baseline],
        "foveated run": [test.name for test in lost.test],
        "scene and gaze": [words.place(*test.place) for test in lost.test],
    })


def least_flattering(compared):
    """Of whole frames beside uniform sampling of the same cost, the comparison in which foveation does worst: by how much of the
    widths of both intervals it is better. None where no comparison has both intervals."""
    def gain(row):
        width = sum(estimate.high - estimate.low for estimate in (row.ours, row.theirs))
        better_by = row.theirs.mean - row.ours.mean if row.lower else row.ours.mean - row.theirs.mean
        return better_by / width if width > 0 else math.copysign(math.inf, better_by) if better_by else 0.0

    whole = [row for row in compared.itertuples() if row.part == "whole" and None not in (row.ours.low, row.theirs.low)]
    return min(whole, key=gain) if whole else None


def headline(results, compared):
    speeds = [speed for speed in (test.estimate("speed_up") for test in results.tests) if speed]
    if not speeds:
        return "No foveated run has been measured beside uniform sampling."
    least, most = (words.number(f(speed.mean for speed in speeds)) for f in (min, max))
    times = least if least == most else f"{least} to {most}"
    runs = f", over {len(speeds)} runs" if len(speeds) > 1 else ""
    text = f"Foveated frames were rendered {times} times as fast as uniform ones at the reference rate{runs}."
    counts = compared[compared.part == "whole"].verdict.value_counts()
    if counts.sum():
        undecided = counts.get("not told apart", 0) + counts.get("under the reference's noise", 0)
        text += (f" Over whole frames, beside uniform sampling of the same cost, they scored better in {counts.get('better', 0)} of {counts.sum()} comparisons, "
                 f"worse in {counts.get('worse', 0)}, and not told apart in {undecided}.")
    if least := least_flattering(compared):
        text += (f" The least flattering: {least.metric} {words.with_interval(least.ours)} beside {words.with_interval(least.theirs)}, "
                 f"{beside(least.baseline)}; {words.place(*least.test.place)}.")
    if not all(speed.tells for speed in speeds):
        text += " Too few repeats were made for intervals of the speed-up: more would say how sure it is."
    return text


def caveats(results):
    """What the measurements cannot say."""
    said = []
    for test in results.tests:
        where = f"{words.place(*test.place)}, {test.label}"
        speed = test.estimate("speed_up")
        if speed and (speed.high if speed.high is not None else speed.mean) < 1:
            said.append(f"{where}: it is slower than uniform sampling at the reference rate, speed-up {words.with_interval(speed)}.")
        elif speed and speed.low is not None and speed.low <= 1 <= speed.high:
            said.append(f"{where}: its speed-up of {words.with_interval(speed)} is not told apart from 1.")
        family = results.family(test)
        said += _nothing_saved(where, test, family)
        if not any(test.score(metric.name) for metric in results.metrics):
            said.append(f"{where}: no metric has a score, so nothing is said of its quality.{_scored_frames(results, test.gaze)}")
        if not any(row.role in SAME_COST for row in family):
            said.append(f"{where}: no uniform run of equal time or equal samples stands beside it, so nothing is claimed for foveation there.")
    for fixed in results.raw.get("fixed_quality") or []:
        if fixed.get("speed_up") is None or fixed.get("bound"):
            curve = f", {fixed['curve']}" if fixed.get("curve") else ""
            value = f"{fixed.get('bound') or ''} {words.number(fixed['speed_up'])}".strip() if fixed.get("speed_up") is not None else "not known"
            why = f", {fixed['why']}" if fixed.get("why") else ""
            said.append(f"{words.place(fixed.get('scene', ''), fixed.get('gaze', ''))}{curve}: speed-up at {results.metric_words.get(fixed['metric'], fixed['metric'])} {words.number(fixed['at'])} is {value}{why}.")
    return said + _controls(results)


def _nothing_saved(where, test, family):
    """A sampling that saves nothing is uniform sampling under another name, and its controls are the same picture."""
    ours, ours_of = test.raw.get("spp_mean"), test.raw.get("scores") or {}
    for row in family:
        theirs, theirs_of = row.raw.get("spp_mean"), row.raw.get("scores") or {}
        if row.role == "uniform-reference-rate" and ours and theirs and theirs / ours < 1.1:
            return [f"{where}: it traces {words.number(ours, 3)} samples a pixel where uniform has {words.number(theirs, 3)}, so that next to nothing is "
                    "saved at this size on this screen, and controls with a wrong gaze show the same picture. A larger frame, or another sampling, would change that."]
        scores = [(one.mean, other.mean) for metric in (ours_of.keys() & theirs_of.keys() if row.role == "equal-samples" else ())
                  if (one := test.score(metric)) and (other := row.score(metric))]
        if scores and all(one == other for one, other in scores):
            return [f"{where}: it scores exactly as uniform sampling with as many samples does, so that its picture is most likely the same: it is faster than "
                    "the reference rate because it has fewer samples, and not because of where they lie."]
    return []


def _scored_frames(results, gaze):
    shares = (results.raw.get("shares") or {}).get(gaze)
    if shares is None:
        return ""
    return " Scores are of fixations." if shares.get("fixation", 0) > 0 else " No frame is a fixation: scores are of the others that are seen."


def _controls(results):
    """In a sentence for each control that a metric does not notice, or for each metric where there are many."""
    controls = results.raw.get("controls") or []
    silent = [control for control in controls if not control["sensitive"]]
    if len(silent) > 3:
        said = []
        for metric in dict.fromkeys(control["metric"] for control in controls):
            verdicts = [results.control_verdict(control) for control in controls if control["metric"] == metric]
            counts = [verdicts.count(one) for one in ("sensitive", "insensitive", "undecided")]
            if counts[1] + counts[2]:
                said.append(f"{metric}: of {len(verdicts)} controls with a wrong gaze it notices {counts[0]}, is insensitive to {counts[1]}, and {counts[2]} are "
                            "undecided; where it does not notice, it supports no claim about foveation (each is in the table of controls).")
        return said
    said = []
    for control in silent:
        start = (f"{words.place(control.get('scene', ''), control.get('gaze', ''))}: {control['metric']} is {words.number(control.get('wrong_score'))} when the gaze is "
                 f"{control.get('wrong')}, against {words.number(control.get('right_score'))} when it is right")
        why = f" ({control['why']})" if control.get("why") else ""
        if results.control_verdict(control) == "insensitive":
            said.append(f"{start}: it is insensitive to gaze there and supports no claim about foveation{why}.")
        elif results.measured_once(control):
            said.append(f"{start}; whether it notices is undecided{why}, and it supports no claim about foveation.")
        else:
            said.append(f"{start}, which is no more than repeats differ: whether it notices is undecided, and it supports no claim about foveation.")
    return said
