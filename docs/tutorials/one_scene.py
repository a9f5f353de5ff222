# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # What foveation saves, and what it costs: one scene
#
# A few frames of the shipped courtyard, once with 32 samples in every pixel and once with fewer where a recorded eye did not
# look: 32 in the fovea, and 16 and 8 for each block of 2 x 2 and 4 x 4 pixels around it. Each frame stands by itself here
# (`accumulate="off"`); by default frames share their samples with those around them. It takes about a minute. Raise `size` for
# figures that mean something on your screen.

# %%
import gazetrace
import matplotlib.pyplot as plt
import pandas

size, frames = (320, 180), range(1, 7)  # small: (64, 36), range(1, 3)
job = gazetrace.Job(scene="scenes/courtyard/courtyard.gltf", camera="walk", gaze="gazelogs/tx300_left.csv", size=size, fps=10,
                    frames=frames, sampling="regions", region_samples=(32, 16, 8), accumulate="off")
uniform = job.replace(sampling="uniform", spp=32)
scene = job.load_scene()  # once, for both

# %% [markdown]
# Where the viewer looked, and how many samples each frame takes. Nothing is rendered for this.

# %%
plan = job.plan()
pandas.DataFrame({"t [s]": plan.t_s, "u": plan.u, "v": plan.v, "samples": plan.samples,
                  "times fewer": uniform.plan().samples / plan.samples})

# %% [markdown]
# One frame as a display shows it, and where its samples went.

# %%
frame = next(job.render(scene=scene))
frame

# %%
rates = plt.imshow(frame.sampling_map.samples_per_pixel, cmap="viridis")
rings = plt.contour(frame.eccentricity, [5, 10, 20], colors="white", linewidths=0.8)
plt.clabel(rings, fmt="%g deg", fontsize=8)
plt.colorbar(rates, label="samples a pixel", shrink=0.7)
plt.title("Samples by distance from the gaze")
plt.show()

# %% [markdown]
# Both sequences are rendered while they are compared, one frame of each at a time. Their times are kept on the way.

# %%
spent = {"uniform": [], "foveated": []}


def timed(name, frames):
    for frame in frames:
        times = frame.timing
        spent[name].append({"samples": times["samples"], "ms": times["guiding_ms"] + times["trace_ms"] + times["guides_ms"] + times["reconstruct_ms"]})
        yield frame


result = gazetrace.compare(timed("uniform", uniform.render(scene=scene)), timed("foveated", job.render(scene=scene)))
totals = pandas.DataFrame({name: pandas.DataFrame(rows).sum() for name, rows in spent.items()})
totals.assign(ratio=totals.uniform / totals.foveated).round(1)

# %% [markdown]
# The error by eccentricity, in degrees from the gaze: relative mean squared error and FLIP. Both sides have noise, so that a
# difference of zero is out of reach even where both have 32 samples; `gazetrace.sweep()` measures against a reference whose own
# noise is known.

# %%
bands = pandas.DataFrame({metric: result.scores(metric)["bands"] for metric in ("relmse", "flip")})
bands

# %%
bands["flip"].plot.bar(xlabel="degrees from the gaze", ylabel="FLIP from uniform, lower is better", rot=0)
plt.show()
