# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a published recording in BIDS to a figure
#
# Four seconds of one person's gaze on a screen, by a Tobii TX300, from the example data of the event detector I2MC
# (Hessels and others, 2017). `gazelogs/bids/` holds them as a BIDS data set does: one table for each eye, with sidecars.
# Put a recording of your own in their place.

# %%
import gazetrace
import matplotlib.pyplot as plt
import numpy as np

eyes = {eye: gazetrace.read_gaze(f"gazelogs/bids/sub-01_task-view_recording-{file}_physio.tsv.gz")
        for eye, file in (("left", "eye1"), ("right", "eye2"))}
eyes

# %% [markdown]
# The sidecars state the units, the sampling rate and the screen. `facts` says how they were understood; nothing of it is
# guessed.

# %%
for fact in eyes["left"].facts:
    print(fact)

# %% [markdown]
# ## Look at the recording first
#
# Positions of both eyes, as fractions of the screen from its top left corner. A gap is a stretch without gaze.

# %%
fig, axes = plt.subplots(2, sharex=True, figsize=(8, 4))
for eye, log in eyes.items():
    for axis, place in zip(axes, (log.u, log.v)):
        axis.plot(log.t_s, np.where(log.valid, place, np.nan), label=f"{eye} eye", linewidth=0.9)
axes[0].set(ylabel="across, u")
axes[1].set(ylabel="down, v", xlabel="time [s]", ylim=axes[1].get_ylim()[::-1])
axes[0].legend(ncols=2, loc="upper right")
plt.show()

# %% [markdown]
# ## What the eye did
#
# `"auto"` picks a method that suits the recording; `gazetrace list event-methods` names all, each with its paper. The events
# are a table.

# %%
events = eyes["left"].detect_events("auto")
events.to_pandas().groupby("movement").duration_ms.describe()[["count", "50%", "min", "max"]].round(0)

# %% [markdown]
# Do both eyes tell the same? The fixations of the right eye, found by themselves, begin at most this many milliseconds
# apart from those of the left one:

# %%
left, right = (log.detect_events("auto").fixations for log in eyes.values())
apart = np.abs(left.onset_s[:, None] - right.onset_s[None, :]).min(axis=1) * 1000
print(f"{len(left)} and {len(right)} fixations; median {np.median(apart):.0f} ms, 90 % within {np.quantile(apart, 0.9):.0f} ms")

# %% [markdown]
# ## The figure
#
# The scanpath on the screen, and the main sequence: how fast saccades of a size are. The dashed line is what saccades of the
# durations of Carpenter (1988) reach with a minimum-jerk course.

# %%
fig, (path, sequence) = plt.subplots(1, 2, figsize=(9, 3.4))
path.plot(left.u, left.v, color="0.6", linewidth=0.8, zorder=1)
path.scatter(left.u, left.v, left.duration_ms / 3, np.arange(len(left)), cmap="viridis", zorder=2)
for number, (u, v) in enumerate(zip(left.u, left.v), 1):
    path.annotate(number, (u, v), (5, 5), textcoords="offset points", fontsize=7)
path.set(xlim=(0, 1), ylim=(1, 0), aspect=1080 / 1920, xlabel="across the screen, u", ylabel="down, v", title="Fixations in their order")

saccades = events.saccades
amplitudes = np.geomspace(saccades.amplitude_deg.min(), saccades.amplitude_deg.max(), 50)
sequence.loglog(saccades.amplitude_deg, saccades.peak_velocity_deg_s, "o", alpha=0.7)
sequence.loglog(amplitudes, 1.875 * amplitudes / (0.021 + 0.0022 * amplitudes), "k--", linewidth=1)
sequence.set(xlabel="amplitude [deg]", ylabel="peak velocity [deg/s]", title=f"Main sequence of {len(saccades)} saccades")
plt.show()

# %% [markdown]
# `fig.savefig("figure.pdf")` writes it for a paper. `gazetrace gaze report FILE` makes a page of a recording with all of this and
# the figures of data quality; [Gaze](../gaze.md) explains them.
