# SPDX-License-Identifier: Apache-2.0
"""`gazetrace gaze iohub`: the samples and messages of a recording of PsychoPy's ioHub (HDF5), as `gazetrace gaze import`
writes them. What the numbers mean is decided there, by its options."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from .command_line import Parser, check_output
from .errors import Error
from .gaze_command import program

DESCRIPTION = """Import the gaze of an ioHub file (.hdf5) of PsychoPy. The file does not state the unit of its places: it is the
one of the experiment's window, such as --unit height, or --unit px --origin center, with --screen-px. Other options of
'gazetrace gaze import' are taken, too; of a file of several sessions --gaze-recording takes one."""
# Of what is known only once the messages are there.
AFTERWARDS = ("--trial-start", "--trial-end", "--trial-nth", "--trial-table")
# The eyes that a sample's status calls invalid.
INVALID = {"left": (20, 22), "right": (2, 22), "": (2,)}


def parse(words):
    parser = Parser("gazetrace gaze iohub", usage="gazetrace gaze iohub FILE.hdf5 -o OUT [options]", description=DESCRIPTION,
                    formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="the recording")
    parser.add_argument("-o", "--output", required=True, metavar="OUT", help="gazetrace CSV, or BIDS, as of 'gazetrace gaze import'")
    for name in ("--trial-per-block", "--keep-ids", "--overwrite"):
        parser.add_argument(name, action="store_true", help=argparse.SUPPRESS)
    for name in AFTERWARDS:
        parser.add_argument(name, help=argparse.SUPPRESS)
    return parser.parse_known_args(words)


def events(file, path):
    """The events under a path that has any; empty otherwise."""
    table = file.get(f"data_collection/events/{path}")
    return table[:] if table is not None else []


def table_of(samples, eyes, has_sessions):
    """A table of one's own, and the map of its columns for the importer."""
    sides = {eye: f"{eye}_" if eye else "" for eye in eyes}
    columns = {"time": "time", "time_unit": "s"}
    for eye in eyes:
        names = {key: f"{eye or 'gaze'}_{key}" for key in ("x", "y", "validity", "pupil")}
        columns.update({eye: names} if eye else names)
    header = ["time"] + [f"{eye or 'gaze'}_{key}" for eye in eyes for key in ("x", "y", "validity", "pupil")]
    if has_sessions:
        columns["recording"] = "session"
        header.append("session")
    lines = [",".join(header)]
    for sample in samples:
        cells = [f"{sample['time']:.9f}"]
        for eye, side in sides.items():
            cells += [repr(float(sample[f"{side}gaze_x"])), repr(float(sample[f"{side}gaze_y"])), str(int(sample["status"] not in INVALID[eye])),
                      repr(float(sample[f"{side}pupil_measure1"]))]
        lines.append(",".join(cells + ([str(sample["session_id"])] if has_sessions else [])))
    return "\n".join(lines) + "\n", columns


def run(*words, quiet=False):
    done = subprocess.run([program(), "gaze", "import", *map(str, words)], check=False, stdout=subprocess.DEVNULL if quiet else None)
    if done.returncode:
        sys.exit(done.returncode if done.returncode > 0 else 128 - done.returncode)


def with_messages(text, messages):
    lines = text.split("\n")
    for message in messages:
        t_ns = round(float(message["time"]) * 1e9)
        words = message["text"].decode("utf-8", "replace") if isinstance(message["text"], bytes) else str(message["text"])
        lines.insert(1, f"# event message cyclopean {t_ns} {t_ns} {' '.join(words.split())}")
    return "\n".join(lines)


def main(words):
    arguments, rest = parse(words)
    try:
        import h5py
    except ModuleNotFoundError as missing:
        raise Error("'gazetrace gaze iohub' needs h5py: install it, on Debian with 'apt-get install python3-h5py'", "runtime") from missing
    if not arguments.output.endswith((".tsv", ".tsv.gz")):
        check_output(Path(arguments.output), arguments.overwrite, [arguments.file])
    try:
        with h5py.File(arguments.file, "r") as file:
            both, one = events(file, "eyetracker/BinocularEyeSampleEvent"), events(file, "eyetracker/MonocularEyeSampleEvent")
            messages = events(file, "experiment/MessageEvent")
    except OSError as problem:
        raise Error(f"{arguments.file}: cannot be read as HDF5: {problem}", "input") from problem
    if not len(both) and not len(one):
        raise Error(f"{arguments.file}: has no samples of an eye tracker under data_collection/events/eyetracker; is it a file of ioHub?", "input")
    if len(both) and len(one):
        raise Error(f"{arguments.file}: has samples of both eyes and others of one eye; keep one kind of them", "input")
    samples, eyes = (both, ["left", "right"]) if len(both) else (one, [""])
    has_sessions = len(set(samples["session_id"])) > 1
    with tempfile.TemporaryDirectory(prefix="gazetrace_") as made:
        table, columns = Path(made) / f"{arguments.file.name}.csv", Path(made) / "columns.json"
        text, of = table_of(samples, eyes, has_sessions)
        table.write_text(text)
        columns.write_text(json.dumps(of))
        first = Path(made) / arguments.file.with_suffix(".csv").name
        run(table, "--columns", columns, "-o", first, *rest)
        kept = [] if has_sessions else messages  # on whose clock the chosen session ran is not stated
        first.write_text(with_messages(first.read_text(), kept))
        after = [word for name in AFTERWARDS if (value := getattr(arguments, name[2:].replace("-", "_"))) for word in (name, value)]
        after += [name for name in ("--trial-per-block", "--keep-ids", "--overwrite") if getattr(arguments, name[2:].replace("-", "_"))]
        run(first, "-o", arguments.output, *after, quiet=True)
    return 0
