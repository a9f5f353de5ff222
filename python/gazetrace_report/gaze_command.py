# SPDX-License-Identifier: Apache-2.0
"""`gazetrace gaze report`: a page on a recording, of what `gazetrace gaze measure` says of it."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from .command_line import Parser, add_json_option, check_output, json_file, say, with_json_joined, write
from .errors import Error

DESCRIPTION = """Make a page of a gaze log: quality of the data, events, heat maps and scanpaths of each trial, and the course over time.
All options of 'gazetrace gaze measure' are taken, too, such as --method, --gaze-process, --trial or --screen-px."""


def program():
    """gazetrace, beside this program or on the PATH."""
    beside = Path(sys.argv[0]).resolve().parent / "gazetrace"
    found = str(beside) if os.access(beside, os.X_OK) and beside.is_file() else shutil.which("gazetrace")
    if not found:
        raise Error("gazetrace: is neither beside this program nor on the PATH", "runtime")
    return found


def parse(words):
    parser = Parser("gazetrace gaze report", usage="gazetrace gaze report LOG [options]", description=DESCRIPTION)
    parser.add_argument("-o", "--output", type=Path, default=Path("gaze.html"), metavar="OUT.html", help="the page, one file that needs nothing else (default: gaze.html)")
    parser.add_argument("--parts", type=Path, metavar="DIR", help="writes every diagram as .svg, and as .tsv the events, samples and vergence")
    parser.add_argument("--frame-image", type=Path, metavar="FILE", help="a .png or .jpg of the stimulus, such as a rendered frame, behind scanpath and heat map")
    parser.add_argument("--heat-sigma", type=float, default=1, metavar="DEG", help="size of a fixation's spot on the heat map, its standard deviation (default: 1)")
    parser.add_argument("--overwrite", action="store_true", help="replaces files that are there")
    add_json_option(parser)
    end = words.index("--") if "--" in words else len(words)  # behind it are no options, of this command or of the other
    arguments, rest = parser.parse_known_args(with_json_joined(words[:end]))
    if any(word.split("=")[0] == "--tables" for word in rest):
        raise Error("--tables: is an option of 'gazetrace gaze measure'; here --parts writes the tables beside the diagrams")
    return arguments, rest + words[end:]


def picture(path):
    if path is None:
        return None
    import numpy
    from PIL import Image
    from .pictures import UNREADABLE
    try:
        image = Image.open(path)
        if image.format not in ("PNG", "JPEG"):
            raise Error(f"{path}: is neither PNG nor JPEG; give a rendered frame, such as frame.0001.png", "input")
        image = image.convert("RGB")
    except UNREADABLE as problem:
        raise Error(f"{path}: cannot be read as a picture: {getattr(problem, 'strerror', None) or problem}", "input") from problem
    image.thumbnail((960, 960))
    return numpy.asarray(image)


def measure(words, folder):
    done = subprocess.run([program(), "gaze", "measure", "--tables", str(folder), "--json=-", *words], stdout=subprocess.PIPE, text=True)
    if done.returncode:
        sys.exit(done.returncode if done.returncode > 0 else 128 - done.returncode)
    return json.loads(done.stdout)


def main(words):
    arguments, rest = parse(words)
    if not 0 < arguments.heat_sigma <= 45:
        raise Error("--heat-sigma: must be above 0 and at most 45 degrees")
    if not [word for word in rest if word != "--"]:
        raise Error("name a gaze log; see 'gazetrace gaze report --help'")
    check_output(arguments.output, arguments.overwrite, rest)
    json_file(arguments.json, arguments.overwrite, [*rest, arguments.output])
    import pandas
    from . import gaze_diagrams, gaze_page
    seen = picture(arguments.frame_image)
    with tempfile.TemporaryDirectory(prefix="gazetrace_") as made:
        folder = Path(made)
        numbers = measure(rest, folder)
        texts = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
        read = {name: pandas.read_csv(folder / name, sep="\t", na_values="n/a") for name in texts}
    recording = gaze_diagrams.Recording(numbers, read["events.tsv"], read["samples.tsv"], read.get("vergence.tsv"), seen, arguments.heat_sigma)
    diagrams = gaze_diagrams.draw_all(recording)
    page = gaze_page.make(numbers, diagrams)
    if arguments.parts:
        parts = {**{f"{one.name}.svg": one.svg for one in diagrams}, **texts}
        for name in parts:
            check_output(arguments.parts / name, arguments.overwrite)
        for name, content in parts.items():
            write(arguments.parts / name, content)
    write(arguments.output, page)
    q = numbers["quality"][0]
    say(f"{arguments.output}: {q['samples']} samples, data loss {gaze_page.loss(q)}, {len(diagrams)} diagrams, {len(page.encode()) / 2**20:.2f} MiB\n",
        numbers, arguments.json)
    return 0
