# SPDX-License-Identifier: Apache-2.0
"""The moving clips that renderers are compared on: where the camera is, what it sees, how bright it is shown.

A clip is 12 frames at 24 a second, 320x180 pixels at 10 pixels a degree. Three glide past surfaces that lie at all
depths (an arcade, foliage, a town of blocks); `walk` is the walk of the shipped scene.
"""

import dataclasses
import math
import pathlib

import numpy as np

FPS = 24
FRAMES = 12
WIDTH, HEIGHT = 320, 180
FIELD_DEG = 32.0  # across the frame: 10 pixels a degree
LONGEST = 64      # poses that a path holds, so that windows after the last frame find one


@dataclasses.dataclass(frozen=True)
class Clip:
    name: str
    scene: str
    environment: str
    exposure_ev: float
    eye: tuple = ()
    target: tuple = ()
    velocity_m_s: tuple = ()
    yfov_deg: float = 0
    first_frame: int = 1

    @property
    def frames(self):
        return range(self.first_frame, self.first_frame + FRAMES)

    def eye_at(self, frame):
        seconds = (frame - 1) / FPS
        return [e + v * seconds for e, v in zip(self.eye, self.velocity_m_s)]

    def target_at(self, frame):
        return [t + e - s for t, e, s in zip(self.target, self.eye_at(frame), self.eye)]

    def words(self, folder):
        """The options of `gazetrace render` for scene, camera and frames; writes the camera path into `folder`."""
        words = [self.scene, "--env", self.environment, "--fps", str(FPS), "--size", f"{WIDTH}x{HEIGHT}",
                 "--frames", f"{self.frames[0]}-{self.frames[-1]}"]
        if not self.eye:
            return [*words, "--camera", "walk"]
        path = pathlib.Path(folder) / f"{self.name}.csv"
        turn = ",".join(f"{q:.12g}" for q in rotation(np.subtract(self.target, self.eye)))
        rows = [f"{(f - 1) / FPS:.12g},{','.join(f'{x:.12g}' for x in self.eye_at(f))},{turn}" for f in range(1, LONGEST)]
        path.write_text("\n".join(["t[s],x[m],y[m],z[m],qx,qy,qz,qw", *rows]) + "\n")
        return [*words, "--camera-path", str(path), "--yfov", str(self.yfov_deg)]


def rotation(forward):
    """The quaternion (x, y, z, w) of a camera that looks along `forward`, +y up."""
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0, 1, 0))
    right /= np.linalg.norm(right)
    m = np.stack([right, np.cross(right, forward), -forward], 1)
    w = math.sqrt(max(0.0, 1 + np.trace(m))) / 2
    x, y, z = (math.sqrt(max(0.0, 1 + 2 * m[i, i] - np.trace(m))) / 2 for i in range(3))
    return (math.copysign(x, m[2, 1] - m[1, 2]), math.copysign(y, m[0, 2] - m[2, 0]),
            math.copysign(z, m[1, 0] - m[0, 1]), w)


def clips(shared, source):
    """All clips, by name. `shared`: the folder of the large scenes; `source`: the project."""
    sky = f"{shared}/hdri/kiara_1_dawn_1k.hdr"
    scenes, courtyard = f"{shared}/scenes", f"{source}/scenes/courtyard"
    return {clip.name: clip for clip in (
        Clip("sponza", f"{scenes}/sponza/Sponza.gltf", sky, 3, (8, 2, -0.3), (-8, 3, -0.3), (-1.1, 0, 0), 50),
        Clip("san-miguel", f"{scenes}/san-miguel/san-miguel.gltf", sky, 3, (27.6, 1.5, 2.42), (26.66, 1.488, 2.17),
             (-1.1, 0, 0), 50.5),
        Clip("lost-empire", f"{scenes}/lost-empire/lost-empire.gltf", sky, 2, (0, 30, 70), (0, 15, 0), (4, 0, 0), 46.7),
        Clip("walk", f"{courtyard}/courtyard.gltf", f"{courtyard}/dusk.hdr", 0, first_frame=13))}
