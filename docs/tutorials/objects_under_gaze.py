# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # Objects under gaze, also for pymovements and BIDS
#
# In a rendered scene the areas of interest need not be drawn by hand: the renderer knows which object is behind each pixel.
# `job.outlines()` gives the outline of every object in every frame, with holes, and without what other objects hide
# (`gazetrace gaze aois --outlines FILE.json` writes the same). This page finds the object of each fixation, then hands the
# outlines to pymovements and BIDS.

# %%
import json
from pathlib import Path

import gazetrace
import matplotlib.pyplot as plt
import pandas
from matplotlib.patches import PathPatch
from matplotlib.path import Path as MplPath

size, frames = (320, 180), range(1, 41)  # small: (96, 54), range(1, 41)
log = gazetrace.read_gaze("gazelogs/tx300_left.csv")
job = gazetrace.Job(scene="scenes/courtyard/courtyard.gltf", camera="walk", gaze=log, size=size, fps=10, frames=frames)
outlines = job.outlines()
names = [one["name"] for one in outlines["objects"]]
print(f"{len(outlines['frames'])} frames, {len(names)} objects")

# %% [markdown]
# ## One frame with its outlines
#
# An outline is a list of polygons; each is a list of rings, the border first, then its holes. A ring follows the sides of
# pixels.

# %%
frame = next(job.render())
fig, axes = plt.subplots(figsize=(8, 4.5))
axes.imshow(frame.display(), extent=(0, size[0], size[1], 0))
for seen in outlines["frames"][0]["objects"]:
    rings = [MplPath([*ring, ring[0]], closed=True) for polygon in seen["polygons"] for ring in polygon]
    axes.add_patch(PathPatch(MplPath.make_compound_path(*rings), fill=False, edgecolor=f"C{seen['object'] % 10}", linewidth=0.7))
axes.plot(frame.gaze.u * size[0], frame.gaze.v * size[1], "o", color="gold", markeredgecolor="black")
axes.set_axis_off()
plt.show()

# %% [markdown]
# ## The reader
#
# Other tools know rectangles. As outlines follow the sides of pixels, they fall apart into rectangles without a remainder:
# between two neighbouring corners' heights, every second upright side enters the object and the next one leaves it. That
# is the whole reader.


# %%
def rectangles(outlines):
    """A row for each rectangle of each object in each frame, in pixels of the display."""
    width, height = outlines["size_px"]
    x, y, w, h = outlines["frame_on_display_px"] or (0, 0, width, height)
    for frame in outlines["frames"]:
        for seen in frame["objects"]:
            sides = [(a, b) for polygon in seen["polygons"] for ring in polygon
                     for a, b in zip(ring, ring[1:] + ring[:1]) if a[0] == b[0]]
            heights = sorted({corner[1] for side in sides for corner in side})
            for top, bottom in zip(heights, heights[1:]):
                across = sorted(a[0] for a, b in sides if min(a[1], b[1]) <= top < max(a[1], b[1]))
                for left, right in zip(across[::2], across[1::2]):
                    yield {"frame": frame["frame"], "object": outlines["objects"][seen["object"]]["name"],
                           "start_x": x + left * w / width, "start_y": y + top * h / height,
                           "end_x": x + right * w / width, "end_y": y + bottom * h / height}


areas = pandas.DataFrame(rectangles(outlines))
areas.head()

# %% [markdown]
# ## What did each fixation fall on?
#
# The camera moves, so a fixation is looked up in the frame of its middle. It falls into one rectangle, or beside all of them:
# then it was on the sky.

# %%
events = log.process("median:samples=5").detect_events().fixations
fixations = pandas.DataFrame({"onset": events.onset_s * 1000, "offset": events.offset_s * 1000,  # ms, from the video's begin
                              "frame": ((events.onset_s + events.offset_s) / 2 * 10).astype(int) + 1,
                              "x": events.u * outlines["display_px"][0], "y": events.v * outlines["display_px"][1]})
hits = fixations.merge(areas, on="frame").query("start_x <= x < end_x and start_y <= y < end_y")
hits[["onset", "offset", "frame", "x", "y", "object"]].round(0)

# %% [markdown]
# A tracker is off by half a degree, so that a fixation beside a border may belong to either side. `gazetrace gaze objects` gives
# each object its share of that uncertainty, in every frame.
#
# ## For pymovements
#
# Its areas of interest are such rectangles, each of them on a page: here a page is a frame. Its `map_to_aois` finds the object of
# each fixation.

# %% needs: pymovements
import polars
import pymovements

stimulus = pymovements.stimulus.TextStimulus(
    polars.from_pandas(areas), aoi_column="object", page_column="frame",
    start_x_column="start_x", start_y_column="start_y", end_x_column="end_x", end_y_column="end_y")
looks = pymovements.Events(polars.from_pandas(
    fixations.rename(columns={"x": "location_x", "y": "location_y"}).assign(name="fixation")))
looks.map_to_aois(stimulus, verbose=False)
print(looks.frame.select("onset", "offset", "frame", "object"))

# %% [markdown]
# ## For BIDS
#
# BIDS (1.10) has no form of its own for areas of interest. Its tables of events take columns of yours, as long as the sidecar
# describes them: here a row says that an object was seen, from when, for how long, and where. `outline` holds the polygons as
# the coordinates of a GeoJSON MultiPolygon, which shapely and QGIS read.

# %%
folder = Path("out/bids")
folder.mkdir(parents=True, exist_ok=True)
rows = [{"onset": frame["t_video_ns"] * 1e-9, "duration": 0.1, "trial_type": "object", "object": names[seen["object"]],
         "outline": json.dumps(seen["polygons"], separators=(",", ":"))} for frame in outlines["frames"] for seen in frame["objects"]]
pandas.DataFrame(rows).to_csv(folder / "sub-01_task-walk_events.tsv", sep="\t", index=False)
(folder / "sub-01_task-walk_events.json").write_text(json.dumps({
    "trial_type": {"Levels": {"object": "an object of the scene is seen"}},
    "object": {"Description": "name of the object in the scene"},
    "outline": {"Description": "coordinates of a GeoJSON MultiPolygon in pixels of the stimulus, from its top left corner", "Units": "pixel"}}, indent=2))
print(f"{len(rows)} rows of {len({row['object'] for row in rows})} objects")
