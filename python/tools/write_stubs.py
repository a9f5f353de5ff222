# SPDX-License-Identifier: Apache-2.0
"""Writes the stubs that follow from the library's schemas: PYTHONPATH=build/dev/python python3 python/tools/write_stubs.py

What a type checker knows of the options and of the metrics is made from the definitions that check them.
"""

import sys
from pathlib import Path

from gazetrace import _core
from gazetrace.metrics import INFO

HEAD = "# SPDX-License-Identifier: Apache-2.0\n# Written by python/tools/write_stubs.py from the schemas of the library.\n"
TYPES = {"flag": "bool", "value": "Value", "list": "Value | Sequence[Value]", "repeated": "str | Sequence[Value]"}


# Of compare(), which have types of their own.
ARGUMENTS = {"metrics", "gaze", "fps", "exposure", "display", "view", "maps", "threads"}


def option_types():
    text = HEAD + "import os\nfrom collections.abc import Iterable, Sequence\nfrom typing import TypeAlias, TypedDict\n\n"
    text += "Value: TypeAlias = str | float | os.PathLike[str]\n"
    classes = {
        "JobOptions": _core.job_options(),
        "GazeOptions": _core.gaze_file_options() + _core.screen_options(),
        "MeasureOptions": _core.compare_options(),
    }
    for name, options in classes.items():
        text += f"\nclass {name}(TypedDict, total=False):\n"
        for option in options:
            if name == "MeasureOptions" and option["name"] in ARGUMENTS:
                continue
            if name == "JobOptions" and option["name"] in ("density", "gaze"):
                continue  # those that take arrays, too
            kind = TYPES[option["shape"]]
            if option["unit"] == "WxH":
                kind = "str | Sequence[int]"
            if option["name"] == "frames":
                kind = "Value | Iterable[int]"
            text += f"    {option['name']}: {kind} | None\n"
    return text


def metric_types():
    text = HEAD + "from typing import Any\n\nfrom . import Pictures\n\nINFO: dict[str, dict[str, Any]]\n\n"
    text += "def measure(metric: str, reference: Pictures, test: Pictures, *, maps: bool = False, **options: Any) -> Any: ...\n"
    for name in INFO:
        text += f"def {name}(reference: Pictures, test: Pictures, **options: Any) -> Any: ...\n"
    return text


STUBS = {"_option_types.pyi": option_types, "metrics.pyi": metric_types}

if __name__ == "__main__":
    folder = Path(__file__).parents[1] / "gazetrace"
    for name, stub in STUBS.items():
        (folder / name).write_text(stub(), encoding="utf-8")
        print(folder / name, file=sys.stderr)
