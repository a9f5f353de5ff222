# SPDX-License-Identifier: Apache-2.0
"""Writes settings as TOML. Python reads TOML but does not write it, and Blender 3.4's does not even read it."""

import json
from collections.abc import Mapping, Sequence

Value = bool | int | float | str | Sequence[int | float | str]


def toml_value(value: Value) -> str:
    """The value as TOML writes it. A JSON string is a basic string of TOML, too."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, int):
        return str(value)
    return "[" + ", ".join(toml_value(part) for part in value) + "]"


def toml_text(settings: Mapping[str, Value]) -> str:
    """One line for each setting, in the order in which they were made."""
    return "".join(f"{name} = {toml_value(value)}\n" for name, value in settings.items())
