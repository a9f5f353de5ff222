#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts one eye of a BIDS 1.11 eye-tracking recording to gazetrace CSV, losslessly.

    convert_bids.py PHYSIO.tsv.gz EVENTS.json OUT.csv [--clock TEXT]

Reads `PHYSIO.tsv.gz` (no header line; column names from the sidecar `PHYSIO.json` beside it) and the display from
`StimulusPresentation` in EVENTS.json. Times are converted to int64 nanoseconds by decimal arithmetic on the text, never
through a float. Coordinates become fractions of the display: u = x_px / width_px (trackers give continuous pixel
coordinates, so no half pixel is added), printed with the digits that restore the same double; u * width_px rounds back to
the recorded text, which the script checks for every row. Rows with `n/a` are kept, marked lost, with nan coordinates.
No id, name or date is taken over. Python 3, standard library only.
"""
import argparse
import gzip
import json
import sys
from decimal import Decimal

NS_PER_UNIT = {"ns": 1, "us": 1_000, "ms": 1_000_000, "s": 1_000_000_000}
MISSING = "n/a"


def fail(place, problem):
    sys.exit(f"convert_bids.py: {place}: {problem}")


def exact_ns(text, unit, place):
    value = Decimal(text) * NS_PER_UNIT[unit]
    if value != value.to_integral_value():
        fail(place, f"time {text} {unit} is not a whole number of nanoseconds")
    return int(value)


def read_sidecars(physio_path, events_path):
    with open(physio_path.removesuffix(".tsv.gz") + ".json", encoding="utf-8-sig") as file:
        sidecar = json.load(file)
    with open(events_path, encoding="utf-8-sig") as file:
        screen = json.load(file)["StimulusPresentation"]
    if sidecar.get("PhysioType") != "eyetrack" or sidecar.get("SampleCoordinateSystem") != "gaze-on-screen":
        fail(physio_path, "only PhysioType eyetrack with SampleCoordinateSystem gaze-on-screen is converted")
    for axis in ("x_coordinate", "y_coordinate"):
        if sidecar[axis]["Units"] not in ("pixel", "pixels", "px"):
            fail(physio_path, f"{axis} is in {sidecar[axis]['Units']}, not in pixels")
    if screen["ScreenOrigin"] != ["top", "left"]:
        fail(events_path, f"ScreenOrigin {screen['ScreenOrigin']} is not top left")
    return sidecar, screen


def fraction(text, size_px, place):
    value = float(text) / size_px
    digits = -Decimal(text).as_tuple().exponent
    if round(value * size_px, digits) != float(text):
        fail(place, f"{text} px does not survive the conversion")
    return value


def number(value):
    """The shortest decimal text that restores the value."""
    return f"{Decimal(str(value)).normalize():f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("physio")
    parser.add_argument("events")
    parser.add_argument("out")
    parser.add_argument("--clock", help="what is known of the clock; default: the sidecar's timestamp Origin")
    args = parser.parse_args()

    sidecar, screen = read_sidecars(args.physio, args.events)
    width_px, height_px = screen["ScreenResolution"]
    column = {name: index for index, name in enumerate(sidecar["Columns"])}
    time_unit = sidecar["timestamp"]["Units"]
    eye = sidecar["RecordedEye"]
    clock = args.clock or sidecar["timestamp"].get("Origin", "")
    pupil_unit = sidecar["pupil_size"]["Units"] if "pupil_size" in column else None

    lines = [
        "# gazetrace-gaze 1",
        f"# display_px {width_px} {height_px}",
        "# display_mm " + " ".join(number(Decimal(str(size)) * 1000) for size in screen["ScreenSize"]),
        "# distance_mm " + number(Decimal(str(screen["ScreenDistance"])) * 1000),
        f"# clock {clock}",
        "t[ns],u[1],v[1],valid,eye" + (f",pupil[{pupil_unit}]" if pupil_unit else ""),
    ]
    with gzip.open(args.physio, "rt", encoding="utf-8-sig") as file:
        for row, line in enumerate(file, start=1):
            cells = line.rstrip("\r\n").split("\t")
            place = f"{args.physio}:{row}"
            if len(cells) != len(column):
                fail(place, f"{len(cells)} cells instead of {len(column)}")
            t_ns = exact_ns(cells[column["timestamp"]], time_unit, place)
            x, y = cells[column["x_coordinate"]], cells[column["y_coordinate"]]
            if MISSING in (x, y):
                out = [str(t_ns), "nan", "nan", "lost", eye]
            else:
                u, v = fraction(x, width_px, place), fraction(y, height_px, place)
                valid = "ok" if 0 <= u <= 1 and 0 <= v <= 1 else "off_screen"
                out = [str(t_ns), repr(u), repr(v), valid, eye]
            if pupil_unit:
                pupil = cells[column["pupil_size"]]
                out.append("nan" if pupil == MISSING else pupil)
            lines.append(",".join(out))
    with open(args.out, "w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
