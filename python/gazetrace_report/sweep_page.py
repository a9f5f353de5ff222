# SPDX-License-Identifier: Apache-2.0
"""The page on a sweep: one file that opens without a network."""

import functools
import json

import jinja2

from . import diagrams, drawing, findings, pictures, tables, viewer, words

MIB = 2**20
BYTES_OF_FRAME = 400  # of a frame's gaze, times and scores, for each run


@functools.cache
def templates():
    return jinja2.Environment(loader=jinja2.PackageLoader(__package__, "data"), autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)


def script_safe(data):
    """JSON that may stand in a script element."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def facts(results):
    """What it was measured with; at the end of the page."""
    said = []
    for key in ("build", "machine"):
        said += [f"{name} {value}" for name, value in (results.raw.get(key) or {}).items() if value not in (None, "")]
    return " · ".join(said + ([f"plan {results.raw['plan_file']}"] if results.raw.get("plan_file") else []))


def make(results, drawn, max_mib):
    """The page's text, and warnings of pictures that cannot be read."""
    compared = findings.comparisons(results)
    names = {place: words.place(*place) for place in results.places}
    sets = [viewer.Set(results, place) for place in results.places]
    data = {"metrics": [metric.name for metric in results.metrics],
            "tests": [{"id": test.id, "label": test.name, "set": str(results.places.index(test.place))} for test in results.tests],
            "plots": [{"kind": one.kind, "set": str(results.places.index(one.place)), "row": one.row, "metric": one.metric, "svg": drawing.in_page(one.svg, one.title, n)}
                      for n, one in enumerate(drawn)],
            "sets": [], "pictures": []}
    values = {
        "results": results, "headline": findings.headline(results, compared), "has_tests": bool(results.tests),
        "tally": tables.tally(compared), "losses": tables.losses(compared), "caveats": findings.caveats(results),
        "places": [{"name": names[place], "shares": tables.shares(results, place), "runs": tables.runs(results, place), "costs": tables.costs(results, place),
                    "bands": tables.bands(results, place) if results.parts else ""} for place in results.places],
        "published": tables.published(results), "fixed_quality": tables.fixed_quality(results), "controls": tables.controls(results),
        "methods": results.raw.get("methods") or "The results hold no paragraph of methods.", "notes": results.raw.get("notes") or [], "facts": facts(results),
        "pictures": "", "names_pictures": True, "data": "",
    }
    template = templates().get_template("sweep.html")
    paths = [of_frame for one in sets for of_frame in one.paths()]
    other = len(template.render(values, data=script_safe(data)).encode()) + 2 * BYTES_OF_FRAME + sum(BYTES_OF_FRAME * (len(of_frame) + 1) for of_frame in paths)
    embedded = pictures.embed_all(paths, max_mib * MIB - other)
    if other > max_mib * MIB:
        embedded.warnings.append(f"tables and diagrams alone take {other / MIB:.2f} MiB, more than the limit of {max_mib:g} MiB")
    data["sets"], data["pictures"] = viewer.sets_as_data(sets, names, embedded)
    values["names_pictures"] = any(paths)
    values["pictures"] = f"{embedded.statement} The page's limit is {max_mib:g} MiB."
    return template.render(values, data=script_safe(data)), embedded.warnings


def draw(results, with_pdf=False):
    return diagrams.draw_all(results, with_pdf)
