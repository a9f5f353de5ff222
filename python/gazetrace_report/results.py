# SPDX-License-Identifier: Apache-2.0
"""What a sweep has measured, as its results.json tells it."""

import json
import re
from dataclasses import dataclass, field
from pathlib import Path

from .errors import Error

FORMAT = "gazetrace-sweep-1"
REGIONS = ("fovea", "intermediate", "periphery")


@dataclass(frozen=True)
class Role:
    words: str
    color: str  # of Okabe and Ito's set, which color-blind readers can tell apart
    marker: str
    dash: tuple = (None, None)


# In the order of tables.
ROLES = {
    "test": Role("foveated", "#0072b2", "o"),
    "uniform-reference-rate": Role("uniform at the reference rate", "#5a5a5a", "s", (7, 3)),
    "equal-time": Role("uniform, equal time", "#d55e00", "^", (9, 3, 2, 3)),
    "equal-samples": Role("uniform, equal samples", "#b8860b", "D", (4, 3)),
    "low-resolution": Role("uniform at low resolution, upscaled", "#009e73", "v", (2, 3)),
    "wrong-gaze": Role("foveated about a wrong gaze", "#b0579a", "x", (1, 3)),
    "uniform-rate": Role("uniform at another rate", "#8a8a8a", "s", (1, 2)),
}
# Those that have the cost of the test they stand beside.
SAME_COST = ("equal-time", "equal-samples", "low-resolution")

NUMBER = (int, float, type(None))
WHOLE = (int,)
TEXT = (str,)
FLAG = (bool,)
ANY = (object,)
ESTIMATE = "a mean with its interval, or a mean alone"
FRAME = {"index": WHOLE, "?t_s": NUMBER, "?time_s": NUMBER, "?event": TEXT, "?gaze_px": [(int, float)], "?rings_px": [(int, float)], "?png": TEXT, "?flip_png": TEXT,
         "?scores": {"*": NUMBER}}
SCORES = {"*": {"*": ESTIMATE}}  # of each metric, of each part of the picture
# What the pages rely on: key -> kinds of values, or what is within; "?" may be missing, "*" is any key.
SCHEMA = {
    "metrics": [{"name": TEXT, "?unit": TEXT, "?better": TEXT, "?note": TEXT}],
    "scenes": [{"name": TEXT, "?reference": {"?key": TEXT, "?png": TEXT, "?floor": SCORES, "?floor_by_gaze": {"*": SCORES}}}],
    "rows": [{"id": TEXT, "scene": TEXT, "role": tuple(ROLES), "?gaze": TEXT, "?label": TEXT, "?of": TEXT, "?reference": TEXT, "?baselines": {"*": TEXT}, "?settings": {"*": ANY},
              "?scores": SCORES, "?frames": [FRAME], "?published": [{"speed_up": NUMBER, "source": TEXT}],
              **{f"?{key}": ESTIMATE for key in ("time_s", "speed_up", "reached")},
              **{f"?{key}": NUMBER for key in ("samples", "spp_mean", "rays", "peak_mib", "end_to_end", "efficiency")}}],
    **{f"?{key}": TEXT for key in ("title", "plan_file", "methods")}, "?notes": [TEXT], "?build": {"*": ANY}, "?machine": {"*": ANY},
    "?bands_deg": [(int, float)], "?band_pixel_share": {"*": [NUMBER]}, "?shares": {"*": {"*": NUMBER}}, "?pareto": {"*": {"*": [TEXT]}},
    "?fixed_quality": [{"metric": TEXT, "at": NUMBER, **{f"?{key}": TEXT for key in ("scene", "gaze", "curve", "bound", "why")}, "?speed_up": NUMBER, "?model_gain": NUMBER}],
    "?controls": [{"metric": TEXT, "sensitive": FLAG, **{f"?{key}": TEXT for key in ("scene", "gaze", "of", "wrong", "why")}, "?right_score": NUMBER, "?wrong_score": NUMBER}],
}


def check(value, schema, place):
    """Fails with the place of the first value that is missing or of another kind. What may be missing and is null goes: it
    is not known."""
    if schema is ESTIMATE:
        schema = {"?mean": NUMBER, "?low": NUMBER, "?high": NUMBER, "?resolved": FLAG} if isinstance(value, dict) else NUMBER
    if isinstance(schema, dict):
        if not isinstance(value, dict):
            raise Error(f"{place} is no object", "input")
        for key in [key for key in value if value[key] is None and ("*" in schema or "?" + key in schema)]:
            del value[key]
        for key, inner in (dict.fromkeys(value, schema["*"]) if "*" in schema else schema).items():
            name = key.removeprefix("?") if "*" not in schema else key
            if name in value:
                check(value[name], inner, f"{place}.{name}" if place[-1] != " " else place + name)
            elif key == name:
                raise Error(f"{place}{'' if place[-1] == ' ' else ' '}has no '{name}'", "input")
    elif isinstance(schema, list):
        if not isinstance(value, list):
            raise Error(f"{place} is no list", "input")
        for i, item in enumerate(value):
            check(item, schema[0], f"{place}[{i}]")
    elif isinstance(schema[0], str):
        if value not in schema:
            raise Error(f"{place} is no role of a row: '{value}'", "input")
    elif not isinstance(value, schema) or (isinstance(value, bool) and bool not in schema and object not in schema):
        raise Error(f"{place} is no {'text' if schema is TEXT else 'whole number' if schema is WHOLE else 'truth value' if schema is FLAG else 'number'}", "input")


@dataclass(frozen=True)
class Estimate:
    """A mean and its 95 % interval; without bounds where it was measured once."""

    mean: float
    low: float | None = None
    high: float | None = None
    resolved: bool = True  # False: better than the reference differs from itself

    @classmethod
    def of(cls, value):
        if value is None or (isinstance(value, dict) and value.get("mean") is None):
            return None
        if not isinstance(value, dict):
            return cls(float(value))
        low, high = value.get("low"), value.get("high")
        return cls(value["mean"], *((low, high) if low is not None and high is not None else (None, None)), value.get("resolved", True))

    @property
    def tells(self):
        """Whether the interval says something: not where its bounds are apart by more than a factor of 16."""
        return self.low is not None and not (self.low > 0 and self.high > 16 * self.low)


@dataclass
class Row:
    id: str
    scene: str
    gaze: str
    role: str
    label: str
    of: str | None
    baselines: dict
    raw: dict
    name: str = ""   # tells it from the other rows of its scene and gaze
    short: str = ""  # for diagrams: what of its label the other tests do not have
    frames: list = field(default_factory=list)

    @property
    def place(self):
        return self.scene, self.gaze

    def estimate(self, key):
        return Estimate.of(self.raw.get(key))

    def score(self, metric, part="whole"):
        return Estimate.of(self.raw.get("scores", {}).get(metric, {}).get(part))


@dataclass
class Metric:
    name: str
    unit: str
    lower: bool
    note: str

    @property
    def words(self):
        return self.name if self.unit in ("", self.name) else f"{self.name} [{self.unit}]"

    @property
    def better(self):
        return "lower is better" if self.lower else "higher is better"


MOST = 1e300  # beyond it, sums of numbers are no numbers


def _finite(text):
    return float(text) if abs(float(text)) < MOST else None


def _whole(text):
    return int(text) if len(text) < 300 else None


class Results:
    """What a sweep measured: its rows with their times and scores, of results.json or its folder."""

    def __init__(self, path):
        path = Path(path)
        self.file = path / "results.json" if path.is_dir() else path
        self.folder = self.file.parent
        self.raw = self._read()
        self.title = self.raw.get("title") or "Sweep"
        self.metrics = [Metric(m["name"], m.get("unit", ""), m.get("better", "lower") == "lower", m.get("note", "")) for m in self.raw["metrics"]]
        self.metric_words = {metric.name: metric.words for metric in self.metrics}
        self.rows = [Row(r["id"], r["scene"], r.get("gaze", ""), r["role"], r.get("label") or r["id"], r.get("of"), r.get("baselines") or {}, r,
                         frames=r.get("frames", [])) for r in self.raw["rows"]]
        self.by_id = {row.id: row for row in self.rows}
        self.tests = [row for row in self.rows if row.role == "test"]
        self.places = list(dict.fromkeys(row.place for row in self.rows))
        self._name_rows()

    def _read(self):
        try:
            raw = json.loads(self.file.read_bytes(), parse_constant=lambda name: None, parse_float=_finite, parse_int=_whole)  # NaN and Infinity are no JSON, and nothing to draw
        except FileNotFoundError:
            raise Error(f"{self.file}: there is no such file; name results.json of a sweep, or its folder", "input") from None
        except OSError as problem:
            raise Error(f"{self.file}: cannot be read: {problem.strerror}", "input") from problem
        except (ValueError, RecursionError) as problem:
            raise Error(f"{self.file}: is no JSON: {problem}; write it again with gazetrace sweep", "input") from problem
        form = raw.get("format") if isinstance(raw, dict) else None
        if form != FORMAT:
            raise Error(f"{self.file}: " + (f"is of the format '{form}', and this version reads {FORMAT} only" if form else f"is no {FORMAT} file: it has no 'format'"))
        check(raw, SCHEMA, f"{self.file}: ")
        try:
            json.dumps(raw, ensure_ascii=False).encode()
        except UnicodeEncodeError:
            raise Error(f"{self.file}: holds half of a pair of UTF-16, which is no letter; write it again with gazetrace sweep", "input") from None
        for kind, key in (("rows", "id"), ("metrics", "name")):
            names = set()
            for i, one in enumerate(raw[kind]):
                if one[key] in names:
                    raise Error(f"{self.file}: {kind}[{i}].{key} is that of another: '{one[key]}'", "input")
                names.add(one[key])
        return raw

    def to_pandas(self):
        """A row for each run: what it is, its time and speed-up with their intervals, and its scores of whole frames."""
        import pandas
        table = []
        for row in self.rows:
            estimates = {"time_s": row.estimate("time_s"), "speed_up": row.estimate("speed_up"), **{metric.name: row.score(metric.name) for metric in self.metrics}}
            line = {"id": row.id, "role": row.role, "scene": row.scene, "gaze": row.gaze, "label": row.label, "spp_mean": row.raw.get("spp_mean")}
            for name, estimate in estimates.items():
                values = (estimate.mean, estimate.low, estimate.high) if estimate else (None,) * 3
                line.update(zip((name, f"{name}_low", f"{name}_high"), values))
            table.append(line)
        return pandas.DataFrame(table)

    def __repr__(self):
        return f"<Results of {len(self.rows)} runs in {self.folder}: {', '.join(metric.name for metric in self.metrics)}>"

    def _repr_html_(self):
        return self.to_pandas()._repr_html_()

    # Names -------------------------------------------------------------------------------------------------------

    def _name_rows(self):
        for row in self.rows:
            row.name = row.label
        self._tell_apart(lambda row: f"beside {self.by_id[row.of].label}" if row.of in self.by_id else "")
        self._tell_apart(lambda row: ", ".join(f"{name} {value}" for name, value in (row.raw.get("settings") or {}).items()))
        self._tell_apart(lambda row: ROLES[row.role].words)
        numbers = {}
        for row in self.rows:
            numbers[row.id] = numbers.get((row.place, row.label), 0) + 1
            numbers[row.place, row.label] = numbers[row.id]
        self._tell_apart(lambda row: f"#{numbers[row.id]}")
        for place in self.places:
            labels = [row.label.split(" ") for row in self.tests if row.place == place]
            common = 0
            while len(labels) > 1 and all(len(label) > common + 1 for label in labels) and len({label[common] for label in labels}) == 1:
                common += 1
            if common and any(len(label) == common + 1 and re.fullmatch(r"[\d.]+", label[common]) for label in labels):
                common -= 1  # a number alone says nothing: "spp 1"
            for row in self.rows:
                if row.place == place:
                    test = row if row.role == "test" else None if row.role.startswith("uniform-") else self.by_id.get(row.of)
                    spp = row.raw.get("spp_mean")
                    row.short = (row.label if len(labels) < 2 else " ".join(test.label.split(" ")[common:]) if test else f"{spp:.3g} spp" if spp else row.label)
        for row in self.rows:
            row.short = row.short if len(row.short) <= 28 else row.short[:27] + "…"

    def _tell_apart(self, more):
        count = {}
        for row in self.rows:
            count[row.place, row.name] = count.get((row.place, row.name), 0) + 1
        for row, name in [(row, row.name) for row in self.rows]:
            if count[row.place, name] > 1 and more(row):
                row.name = f"{name}, {more(row)}"

    # Who stands beside whom ---------------------------------------------------------------------------------------

    def family(self, test):
        """A test and the rows that stand beside it, in the order of roles."""
        named = set(test.baselines.values())
        others = [row for row in self.rows if row is not test and (row.id in named or row.of == test.id)]
        return [test, *sorted(others, key=lambda row: list(ROLES).index(row.role))]

    def rows_in_order(self, place):
        """Of a scene and gaze: first those that belong to no single test, then every test with its own."""
        tests = [test for test in self.tests if test.place == place]
        count = {}
        for test in self.tests:
            for row in self.family(test):
                count[row.id] = count.get(row.id, 0) + 1
        shared = [row for row in self.rows if row.place == place and row.role != "test" and count.get(row.id) != 1]
        return shared + [row for test in tests for row in self.family(test) if count[row.id] == 1]

    # Parts of the picture -----------------------------------------------------------------------------------------

    @property
    def bands(self):
        begins = self.raw.get("bands_deg") or []
        return [f"{a:g}-{b:g}" for a, b in zip(begins, begins[1:])] + ([f"{begins[-1]:g}+"] if begins else [])

    @property
    def parts(self):
        """Bands, regions and the weighted score, where some row has them."""
        scored = {part for row in self.rows for parts in (row.raw.get("scores") or {}).values() for part in parts}
        return [part for part in (*self.bands, *REGIONS, "weighted") if part in scored]

    # References ---------------------------------------------------------------------------------------------------

    def reference(self, row):
        keyless = None
        for scene in self.raw["scenes"]:
            key = (scene.get("reference") or {}).get("key") or ""
            if scene["name"] != row.scene or "reference" not in scene:
                continue
            if row.raw.get("reference") and key == row.raw["reference"]:
                return scene["reference"]
            if keyless is None and (not row.raw.get("reference") or not key):
                keyless = scene["reference"]
        return keyless

    def references(self, place):
        found = []
        for row in self.rows:
            one = self.reference(row) if row.place == place else None
            if one is not None and all(one is not other for other in found):
                found.append(one)
        return found

    @staticmethod
    def floor(reference, gaze, metric, part="whole"):
        """By how much a reference differs from itself."""
        by_gaze = reference.get("floor_by_gaze")
        scores = reference.get("floor") if by_gaze is None else by_gaze.get(gaze, by_gaze.get(""))
        value = ((scores or {}).get(metric) or {}).get(part)
        return value.get("mean") if isinstance(value, dict) else value

    # Controls -----------------------------------------------------------------------------------------------------

    def control_verdict(self, control):
        """Whether a metric notices a wrong gaze: "sensitive", "insensitive" or "undecided"."""
        if control["sensitive"]:
            return "sensitive"
        metric, right = self._controlled(control)
        a, b = control.get("right_score"), control.get("wrong_score")
        worse = metric is not None and a is not None and b is not None and (b > a if metric.lower else b < a)
        return "undecided" if worse or self.measured_once(control) else "insensitive"

    def measured_once(self, control):
        right = self._controlled(control)[1]
        return right is not None and right.low is None

    def _controlled(self, control):
        """A control names its metric, followed by the part where that is not the whole frame."""
        row = self.by_id.get(control.get("of"))
        for metric in self.metrics:
            if control["metric"] == metric.name or control["metric"].startswith(metric.name + " "):
                part = control["metric"][len(metric.name) + 1:] or "whole"
                return metric, row.score(metric.name, part) if row else None
        return None, None
