# SPDX-License-Identifier: Apache-2.0
"""The gazetrace program: where it is, and what names its options take."""

import json
import os
import shutil
import subprocess
from functools import lru_cache

import bpy

from .refusal import Refusal


def program_path(context: bpy.types.Context) -> str:
    """The program of the preferences, else of the environment variable GAZETRACE, else the one on the PATH."""
    addon = context.preferences.addons.get(__package__)
    wanted = (addon.preferences.program if addon else "") or os.environ.get("GAZETRACE", "") or "gazetrace"
    found = shutil.which(bpy.path.abspath(wanted))
    if found is None:
        raise Refusal(f"the program {wanted} was not found", "install it, or name it in the add-on's preferences")
    return found


@lru_cache(maxsize=None)
def names_of(program: str, family: str) -> tuple[tuple[str, str], ...]:
    """The names of a family such as `filters`, each with its description, as `gazetrace list` prints them."""
    try:
        told = subprocess.run([program, "list", family, "--json"], capture_output=True, check=True, timeout=10)
        return tuple((entry["name"], entry["description"]) for entry in json.loads(told.stdout)[family])
    except (OSError, subprocess.SubprocessError, ValueError, KeyError):
        return ()
