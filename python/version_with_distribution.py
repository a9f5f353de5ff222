# SPDX-License-Identifier: Apache-2.0
"""The version of a wheel: that of CMakeLists.txt, with the distribution that it is built on: 0.1.0+debian12."""

import platform
import re
from pathlib import Path


def dynamic_metadata(field, settings=None):
    if field != "version" or settings:
        raise ValueError("this provider states the version and takes no settings")
    text = (Path(__file__).parent.parent / "CMakeLists.txt").read_text(encoding="utf-8")
    version = re.search(r"project\(gazetrace VERSION ([0-9.]+)", text).group(1)
    try:
        release = platform.freedesktop_os_release()
    except OSError:
        return version
    distribution = release.get("ID", "") + release.get("VERSION_ID", "")
    distribution = re.sub(r"[^a-z0-9.]", "", distribution.lower()).strip(".")
    return f"{version}+{distribution}" if distribution else version
