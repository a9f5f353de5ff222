# SPDX-License-Identifier: Apache-2.0
"""What the frame viewer shows of each scene and gaze: the reference and every run that has pictures, as data for its
script."""

import re
from pathlib import Path


def _finite(value):
    return value if isinstance(value, (int, float)) and value == value and abs(value) != float("inf") else None


def frame_path(pattern, index):
    """reference.####.png -> reference.0007.png; a name without a number stands for every frame."""
    return re.sub(r"#+", lambda m: str(index).zfill(len(m.group())), pattern, count=1)


class Set:
    """Of a scene and gaze: frames in the order of time, of the run that has the most, and the pictures of each run."""

    def __init__(self, results, place):
        self.place, self.runs, self.frames = place, [], []
        rows = [row for row in results.rows if row.place == place and any(frame.get("png") for frame in row.frames)]
        if not rows:
            return
        longest = max(rows, key=lambda row: (len(row.frames), row.role == "test"))
        self.frames = longest.frames
        references = results.references(place)
        for reference in references:
            if not reference.get("png"):
                continue
            pattern = str(results.folder / reference["png"])
            found = {frame["index"]: Path(frame_path(pattern, frame["index"])) for frame in self.frames}
            found = {index: path for index, path in found.items() if path.is_file()}
            if found:
                self.runs.append((f"reference {reference['key']}" if len(references) > 1 else "reference", None, found, {}))
        for row in rows:
            pictures = {frame["index"]: results.folder / frame["png"] for frame in row.frames if frame.get("png")}
            maps = {frame["index"]: results.folder / frame["flip_png"] for frame in row.frames if frame.get("png") and frame.get("flip_png")}
            self.runs.append((row.name, row, pictures, maps))

    def paths(self):
        """Of each frame all its pictures."""
        return [[kind[frame["index"]] for _, _, *kinds in self.runs for kind in kinds if frame["index"] in kind] for frame in self.frames]


def _frame(frame, picture):
    """Gaze and rings become fractions of the frame's width and height, because pictures may be reduced."""
    gaze = frame.get("gaze_px")
    return {"index": frame["index"], "t_s": _finite(frame.get("t_s")), "event": frame.get("event", "none"),
            "gaze": [gaze[0] / picture.width, gaze[1] / picture.height] if gaze else None,
            "rings": [radius / picture.width for radius in frame.get("rings_px") or []] if gaze else []}


def _run(label, row, kinds, frames, embedded, indices, texts):
    def index(paths, frame):
        path = paths.get(frame["index"])
        if path not in embedded.of_path:
            return None
        if path not in indices:
            indices[path] = len(texts)
            texts.append(embedded.of_path[path].uri)
        return indices[path]

    own = {frame["index"]: frame for frame in row.frames} if row else {}
    return {"label": label, "pictures": [index(kinds[0], frame) for frame in frames], "maps": [index(kinds[1], frame) for frame in frames],
            "times": [_finite(own.get(frame["index"], {}).get("time_s")) for frame in frames],
            "scores": [{metric: _finite(value) for metric, value in (own.get(frame["index"], {}).get("scores") or {}).items()} for frame in frames]}


def sets_as_data(sets, names, embedded):
    """The sets as the script takes them, numbered as the places of the results, and the pictures as data: addresses, each once."""
    indices, texts, data = {}, [], []
    for number, one in enumerate(sets):
        shown = []
        for frame in one.frames:
            picture = next((embedded.of_path[path] for _, _, pictures, _ in one.runs if (path := pictures.get(frame["index"])) in embedded.of_path), None)
            if picture:
                shown.append((frame, picture))
        frames = [frame for frame, _ in shown]
        runs = [_run(label, row, kinds, frames, embedded, indices, texts) for label, row, *kinds in one.runs] if frames else []
        data.append({"id": str(number), "name": names[one.place], "frames": [_frame(*both) for both in shown], "runs": runs})
    return data, texts
