# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a published recording in BIDS to a figure
#
# Four seconds of one person's gaze on a screen, by a Tobii TX300, from the example data of the event detector I2MC
# (Hessels and others, 2017). `gazelogs/bids/` holds them as a BIDS data set does: one table for each eye, with sidecars.
# Put a recording of your own in their place: any of [the formats](../gaze.md) will do, and the lines below stay as they are.

# %%
import gazetrace
import matplotlib.pyplot as plt
import numpy as np

path = "gazelogs/bids/sub-01_task-view_recording-eye1_physio.tsv.gz"
left, right = (gazetrace.read_gaze(path, gaze_eye=eye) for eye in ("left", "right"))
print(left, right, sep="\n")

# %% [markdown]
# One file is named, and the table of the other eye is found beside it. The sidecars state the units, the sampling rate and
# the screen; `facts` lists how they were understood, and on what evidence.

# %%
for fact in left.facts:
    print(f"{fact['what']:17} {fact['value']:48} {fact['evidence']}")

# %% [markdown]
# ## Look at the recording first
#
# Positions of both eyes, as fractions of the screen from its top left corner. A gap is a stretch without gaze. The eyes
# differ in height by nearly one degree, as calibrations do: their mean would be nobody's gaze.

# %%
fig, axes = plt.subplots(2, sharex=True, figsize=(8, 4))
for eye, log in (("left", left), ("right", right)):
    for axis, place in zip(axes, (log.u, log.v)):
        axis.plot(log.t_s, np.where(log.valid, place, np.nan), label=f"{eye} eye", linewidth=0.9)
axes[0].set(ylabel="across, u")
axes[1].set(ylabel="down, v", xlabel="time [s]", ylim=axes[1].get_ylim()[::-1])
axes[0].legend(loc="upper left")
plt.show()

# %% [markdown]
# ## What the eye did
#
# `detect_events()` picks a method that suits the recording; `gazetrace list event-methods` names all, each with its paper. It
# warns where the events are not to be relied on, and names what suits the recording better. Here noise of 0.3 degrees from
# sample to sample makes 23 saccades for 11 fixations; a median of five samples takes most of it away. A study chooses one
# such step for all participants. The events are a table.

# %%
quiet = [log.process("median:samples=5") for log in (left, right)]
events = quiet[0].detect_events()
events.to_pandas().groupby("movement").duration_ms.describe()[["count", "50%", "min", "max"]].round(0)

# %% [markdown]
# Do both eyes agree? For each fixation of the left eye, this is how far its beginning is from that of the nearest fixation of
# the right eye, which is detected by itself:

# %%
fixations, of_right = (log.detect_events().fixations for log in quiet)
apart_ms = 1000 * np.abs(fixations.onset_s[:, None] - of_right.onset_s).min(axis=1)
print(f"{len(fixations)} and {len(of_right)} fixations; median {np.median(apart_ms):.0f} ms, at most {apart_ms.max():.0f} ms")

# %% [markdown]
# ## The figure
#
# The scanpath on the screen, and the main sequence: how fast saccades of a size are. The dashed line is what saccades of the
# durations of Carpenter (1988) reach with a minimum-jerk course.

# %%
fig, (scanpath, sequence) = plt.subplots(1, 2, figsize=(10, 3.4))
order = np.arange(1, len(fixations) + 1)
scanpath.plot(fixations.u, fixations.v, color="0.6", linewidth=0.8, zorder=1)
discs = scanpath.scatter(fixations.u, fixations.v, fixations.duration_ms / 3, order, cmap="viridis", edgecolor="white", zorder=2)
fig.colorbar(discs, ax=scanpath, label="order", shrink=0.7)
scanpath.set(xlim=(0, 1), ylim=(1, 0), aspect=1080 / 1920, xlabel="across the screen, u", ylabel="down, v",
             title="Fixations, area by duration")

saccades = events.saccades
amplitudes = np.geomspace(saccades.amplitude_deg.min(), saccades.amplitude_deg.max(), 50)
sequence.loglog(saccades.amplitude_deg, saccades.peak_velocity_deg_s, "o", alpha=0.7)
sequence.loglog(amplitudes, 1.875 * amplitudes / (0.021 + 0.0022 * amplitudes), "k--", linewidth=1)
sequence.set(xlabel="amplitude [deg]", ylabel="peak velocity [deg/s]", title=f"Main sequence of {len(saccades)} saccades")
plt.show()

# %% [markdown]
# `fig.savefig("figure.pdf")` writes it for a paper. `gazetrace gaze report FILE` makes a page of a recording with all of this and
# the figures of data quality; [Gaze](../gaze.md) explains them.
