# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # From a gaze log to a figure, in fifteen lines
#
# Load a log, take off its noise, detect what the eye did, render frames whose samples lie where it looked, compare them with uniform ones,
# and plot. The log is a real recording that ships with gazetrace. Its viewer never saw this courtyard: the recording shows
# what eyes do, not what this scene would make them do.

# %%
import gazetrace
import matplotlib.pyplot as plt

size, frames = (320, 180), range(1, 7)  # small: (64, 36), range(1, 3)
log = gazetrace.read_gaze("gazelogs/tx300_left.csv").process("median:samples=5")
fixations = log.detect_events().fixations
job = gazetrace.Job(scene="scenes/courtyard/courtyard.gltf", camera="walk", gaze=log, size=size, fps=10, frames=frames)
foveated = list(job.render())
error = gazetrace.compare(job.replace(sampling="uniform", spp=32).render(), foveated, metrics="flip")
fig, (seen, course) = plt.subplots(1, 2, figsize=(10, 3))
seen.imshow(foveated[0].display(), extent=(0, 1, 1, 0), aspect="auto")
seen.scatter(fixations.u, fixations.v, fixations.duration_ms / 3, color="gold", edgecolor="black", alpha=0.7)
course.plot([frame.t_ns * 1e-9 for frame in foveated], [frame.timing["trace_ms"] for frame in foveated], "o-")
course.set(title=f"FLIP from uniform: {error['flip']:.3f}", xlabel="video time [s]", ylabel="time to trace a frame [ms]")
plt.show()

# %% [markdown]
# Left: the first frame under all fixations of the log, as fractions of the screen. The area of a disc is the duration of its
# fixation. Right: the time that each frame took to trace. FLIP is the perceived difference of two pictures, from 0 to 1,
# when they are flipped in place; here it is the mean over the frames that fall in
# fixations, against 32 samples in every pixel.
#
# Each line has its section in [the manual](../python.md). For the error by distance from the gaze go on with
# [what foveation saves](one_scene.py).
