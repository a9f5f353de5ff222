# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # Measure settings against a reference
#
# Which of two foveations is worth its error? A sweep renders each of them, and beside each uniform renderings with as many
# samples, in as much time, and with fewer pixels; it compares all with a reference whose own noise is known, and gives each figure
# an interval. This small one takes half a minute. Its numbers show how to read a sweep, not what foveation can do.

# %%
from pathlib import Path

import gazetrace
import matplotlib.pyplot as plt

size, repeats = "160x90", 4  # small: "64x36", 2
plan = Path("out/sweep_tutorial.toml")
plan.parent.mkdir(exist_ok=True)
plan.write_text(f"""
title = "Two foveations of the courtyard"

[common]
screen = "paper"
size = "{size}"
frames = "1"
sampling = "regions"

[[scene]]
name = "courtyard"
path = "../scenes/courtyard/courtyard.gltf"
camera = "still"

[[gaze]]
name = "left"
at = [0.3, 0.5]

[grid]
region-samples = [[16, 8, 4], [32, 8, 2]]

[reference]
spp = 64

[measure]
repeats = {repeats}
metrics = ["relmse", "flip"]
quality = ["flip=0.3"]
""")
results = gazetrace.sweep(plan, "out/sweep_tutorial", restart=True)

# %% [markdown]
# The table has a row for each rendering. `role` is why it is there: a `test` is one of the foveations, the others are what it
# is measured against. The same settings with a wrong gaze are controls, which the page shows. Times are of a frame, in
# seconds; `_low` and `_high` are the ends of intervals at 95 %.

# %%
table = results.to_pandas().query("role != 'wrong-gaze'")
table[["role", "label", "time_s", "flip", "flip_low", "flip_high"]].round(3)

# %% [markdown]
# Error against time, the figure that decides: what lies farther down and left is better. A foveated rendering pays where it lies
# below the uniform ones that took as long.

# %%
for role, rows in table.groupby("role", sort=False):
    plt.errorbar(rows.time_s, rows.flip, [rows.flip - rows.flip_low, rows.flip_high - rows.flip], fmt="o", label=role)
plt.loglog()
plt.xlabel("time of a frame [s]")
plt.ylabel("FLIP, lower is better")
plt.legend(loc="upper left", bbox_to_anchor=(1, 1))
plt.show()

# %% [markdown]
# The page with the pictures side by side, all tables and diagrams, and a paragraph on the methods for a paper:

# %%
print(gazetrace.report(results))

# %% [markdown]
# [Sweeps and reports](../sweep-and-report.md) has every key of a plan.
