# SPDX-License-Identifier: Apache-2.0
# What the eye did, frames that are sampled where it looked, and how far they are from uniform ones, in fifteen lines.
import gazetrace
import matplotlib.pyplot as plt

log = gazetrace.read_gaze("gazelogs/tx300_left.csv")
fixations = log.detect_events().fixations
job = gazetrace.Job(scene="scenes/courtyard/courtyard.gltf", env="scenes/courtyard/dusk.hdr", camera="walk", gaze=log, size=(320, 180), fps=10, frames=range(1, 7))
frames = list(job.render())
error = gazetrace.compare(job.replace(sampling="uniform", spp=32).render(), frames, metrics="flip")
fig, (seen, course) = plt.subplots(1, 2, figsize=(10, 3), layout="constrained")
seen.imshow(frames[0].display(), extent=(0, 1, 1, 0), aspect="auto")
seen.scatter(fixations.u, fixations.v, fixations.duration_ms / 3, color="gold", edgecolor="black", alpha=0.7)
course.plot([frame.t_ns * 1e-9 for frame in frames], [frame.timing["trace_ms"] for frame in frames], "o-")
course.set(title=f"FLIP from uniform: {error['flip']:.3f}", xlabel="video time [s]", ylabel="time to trace a frame [ms]")
fig.savefig("fifteen_lines.svg")
