# SPDX-License-Identifier: Apache-2.0
"""The courtyard's walls, arcade and floor. x from the arcade (-3.6) to the closed wall (3.6), z from the back wall (-5)
to the open front (4.25); the floor is y = 0."""
import math

from .shapes import Shape, arch_points, arched_wall, box, facets, rectangle, revolve, tube
from .vec import mix, smoothstep

LEFT, RIGHT, BACK, FRONT = -3.6, 3.6, -5.0, 4.25
WALL_TOP = 3.7
NICHE = {"half": 1.05, "springing": 2.0, "depth": 0.34, "base": 0.0}
BAY, BAYS, ARCH_RADIUS, SPRINGING, THICKNESS = 1.85, 5, 0.72, 2.02, 0.40


def _damp(position):
    """Vertex colours: walls are darker and warmer near the ground, and a little under the eaves."""
    low = smoothstep(0.0, 0.9, position[1])
    color = mix((0.62, 0.52, 0.44), (1.0, 1.0, 1.0), low)
    eaves = 1.0 - 0.12 * smoothstep(WALL_TOP - 0.5, WALL_TOP, position[1])
    return tuple(c * eaves for c in color)


def floor():
    carpet, border = Shape(), Shape()
    x0, x1, z0, z1 = -2.4, 2.4, -4.0, 4.0
    rectangle(carpet, (x0, 0, z1), (x1 - x0, 0, 0), (0, 0, z0 - z1))
    for a, b, c, d in (
        (LEFT - THICKNESS, x0, BACK, FRONT),
        (x1, RIGHT, BACK, FRONT),
        (x0, x1, z1, FRONT),
        (x0, x1, BACK, z0),
    ):
        rectangle(border, (a, 0, d), (b - a, 0, 0), (0, 0, c - d))
    return carpet, border


def plaster_walls():
    """Back wall with its arched niche, closed wall on the right, the arcade's upper part on the left."""
    shape = Shape()
    back = lambda x, y, z, w=1: (x, y, z + BACK * w)  # noqa: E731
    arched_wall(shape, back, LEFT, RIGHT, 0.0, WALL_TOP, NICHE["springing"], NICHE["half"], NICHE["depth"], 32, _damp)
    rectangle(shape, (RIGHT, 0, FRONT), (0, 0, BACK - FRONT), (0, WALL_TOP, 0), (16, 8), _damp)
    # The right wall's front end and both walls' tops, so that no edge looks like paper.
    rectangle(shape, (RIGHT, 0, FRONT), (0.4, 0, 0), (0, WALL_TOP, 0), (1, 8), _damp)
    for k in range(BAYS):
        z0 = FRONT - (k + 1) * BAY
        left = lambda x, y, z, w=1: (LEFT * w + z, y, -x)  # noqa: E731
        arched_wall(
            shape, left, -z0 - BAY, -z0, SPRINGING, WALL_TOP, SPRINGING, ARCH_RADIUS, THICKNESS, 20, _damp, both=True
        )
    return shape


def niche_lining():
    """The recessed back of the niche: a rectangle and a half disc."""
    shape = Shape()
    half, springing, z = NICHE["half"], NICHE["springing"], BACK - NICHE["depth"]
    rectangle(shape, (-half, 0, z), (2 * half, 0, 0), (0, springing, 0))
    arch = arch_points(0.0, springing, half, 32)
    middle = shape.vertex((0, springing, z), (0, 0, 1), (0, -springing))
    rim = [shape.vertex((x, y, z), (0, 0, 1), (x, -y)) for x, y in arch]
    for a, b in zip(rim, rim[1:]):
        shape.indices += (middle, a, b)
    return shape


def stone_trim():
    """Columns, cornices, the niche's frame, plinth courses: everything of pale stone that stands for itself."""
    shape = Shape()
    column = [
        (0.235, 0.0), (0.235, 0.12), (0.235, 0.12), (0.20, 0.12), (0.20, 0.12),
        (0.215, 0.145), (0.218, 0.17), (0.205, 0.20), (0.168, 0.215), (0.168, 0.215),
        (0.158, 0.26), (0.150, 0.8), (0.140, 1.50), (0.132, 1.62), (0.132, 1.62),
        (0.155, 1.635), (0.158, 1.65), (0.150, 1.67), (0.134, 1.675), (0.134, 1.675),
        (0.150, 1.72), (0.178, 1.79), (0.215, 1.85), (0.235, 1.88),
    ]  # fmt: skip
    x = LEFT - THICKNESS / 2
    for k in range(BAYS + 1):
        z = FRONT - k * BAY
        revolve(shape, column, 24, (x, 0, z))
        box(shape, (x - 0.24, 1.88, z - 0.24), (x + 0.24, SPRINGING, z + 0.24))
    # Frame of the niche: a half-round moulding on the wall, down to low bases.
    half, springing = NICHE["half"] + 0.07, NICHE["springing"]
    arch = arch_points(0.0, springing, half, 40)
    path = [(half, 0.25, BACK)] + [(px, py, BACK) for px, py in arch] + [(-half, 0.25, BACK)]
    tube(shape, path, 0.065, 10, caps=False)
    for sign in (-1, 1):
        box(shape, (sign * half - 0.11, 0, BACK), (sign * half + 0.11, 0.25, BACK + 0.11))
        box(shape, (sign * half - 0.10, springing - 0.07, BACK), (sign * half + 0.10, springing + 0.03, BACK + 0.09))
    # Cornices under the roof tiles.
    box(shape, (LEFT, WALL_TOP - 0.10, BACK), (RIGHT, WALL_TOP, BACK + 0.10))
    box(shape, (RIGHT - 0.10, WALL_TOP - 0.10, BACK + 0.10), (RIGHT, WALL_TOP, FRONT))
    box(shape, (LEFT, WALL_TOP - 0.10, BACK + 0.10), (LEFT + 0.10, WALL_TOP, FRONT))
    box(shape, (LEFT - THICKNESS - 0.1, WALL_TOP - 0.10, BACK), (LEFT - THICKNESS, WALL_TOP, FRONT))
    return shape


def roof_tile():
    """One barrel tile, half a cone along +z, 0.5 m long; instanced along the wall tops."""
    shape = Shape()

    def vertex(i, j):
        angle = math.pi * i / 10
        radius = 0.105 + 0.012 * j
        normal = (-math.cos(angle), math.sin(angle), 0.0)
        return (normal[0] * radius, normal[1] * radius, 0.5 * j - 0.25), normal, (i / 10, j)

    shape.grid(10, 1, vertex, flip=True)
    inner = 0.014

    def below(i, j):
        angle = math.pi * i / 10
        radius = 0.105 + 0.012 * j - inner
        normal = (math.cos(angle), -math.sin(angle), 0.0)
        return (-normal[0] * radius, -normal[1] * radius, 0.5 * j - 0.25), normal, (i / 10, j)

    shape.grid(10, 1, below)

    def lip(i, j):
        angle = math.pi * i / 10
        radius = 0.117 - inner * j
        return (-math.cos(angle) * radius, math.sin(angle) * radius, 0.25), (0, 0, 1), (i / 10, j * 0.1)

    shape.grid(10, 1, lip, flip=True)
    return shape


def roof_tile_places():
    """(translation, quaternion) of every roof tile: over the back wall, the right wall and the arcade."""
    tilt = math.radians(16)
    places = []
    pitch = 0.225
    y = WALL_TOP + 0.02
    for k in range(int((RIGHT - LEFT) / pitch) + 1):
        places.append(((LEFT + 0.05 + k * pitch, y, BACK - 0.02), (math.sin(tilt / 2), 0.0, 0.0, math.cos(tilt / 2))))
    for k in range(int((FRONT - BACK) / pitch)):
        z = BACK + 0.3 + k * pitch
        for x, turn in ((RIGHT + 0.02, -math.pi / 2), (LEFT + 0.0, math.pi / 2)):
            c, s = math.cos(turn / 2), math.sin(turn / 2)
            a, b = math.cos(tilt / 2), math.sin(tilt / 2)
            places.append(((x, y, z), (c * b, s * a, -s * b, c * a)))
    return places


def basin():
    """An octagonal fountain basin; its water is a separate shape."""
    stone, water = Shape(), Shape()
    center, twist = (-1.15, 0.0, -0.75), math.pi / 8
    outer, inner, rim, level = 0.95, 0.80, 0.40, 0.33
    facets(stone, 8, outer + 0.10, outer + 0.10, 0.0, 0.07, center, twist=twist)
    ring(stone, 8, outer + 0.10, outer - 0.02, 0.07, center, twist)
    facets(stone, 8, outer - 0.02, outer - 0.02, 0.07, rim - 0.07, center, twist=twist)
    ring(stone, 8, outer - 0.02, outer + 0.03, rim - 0.07, center, twist, down=True)
    facets(stone, 8, outer + 0.03, outer + 0.03, rim - 0.07, rim, center, twist=twist)
    ring(stone, 8, outer + 0.03, inner, rim, center, twist)
    facets(stone, 8, inner, inner, 0.05, rim, center, inward=True, twist=twist)
    ring(water, 8, inner, 0.0, level, center, twist)
    # A small fluted spout in the middle.
    profile = [(0.11, 0.05), (0.09, 0.30), (0.07, 0.48), (0.085, 0.52), (0.20, 0.60), (0.245, 0.655), (0.25, 0.67),
               (0.25, 0.67), (0.225, 0.67), (0.225, 0.67), (0.16, 0.625), (0.0, 0.61)]  # fmt: skip
    revolve(stone, profile, 28, center)
    return stone, water


def ring(shape, corners, outer, inner, y, center, twist, down=False):
    normal = (0.0, -1.0 if down else 1.0, 0.0)

    def vertex(i, j):
        angle = twist - 2.0 * math.pi * i / corners
        r = inner if j else outer
        position = (center[0] + r * math.cos(angle), y, center[2] + r * math.sin(angle))
        return position, normal, (position[0], position[2])

    shape.grid(corners, 1, vertex, flip=down and inner < outer)


def ground():
    """What lies outside: dry earth to the horizon."""
    shape = Shape()
    rectangle(shape, (-120, -0.03, 120), (240, 0, 0), (0, 0, -240))
    return shape


def hills(height_at):
    """A ring of low hills that ends the view through the arcade; `height_at(turn)` in metres, turn 0..1."""
    shape = Shape()
    count, near, far = 160, 60.0, 85.0

    def vertex(i, j):
        angle = -2.0 * math.pi * i / count
        radius, height = ((near, -0.1), (far, height_at(i / count)))[j]
        c, s = math.cos(angle), math.sin(angle)
        return (radius * c, height, radius * s), (-0.2425 * c, 0.9701, -0.2425 * s), (i / count, j)

    shape.grid(count, 1, vertex, flip=True)
    return shape


def beams():
    """Two old beams across the court; the lantern hangs from the nearer, higher one."""
    shape = Shape()
    for y, z in ((3.52, -1.3), (3.28, -3.6)):
        box(shape, (LEFT - 0.1, y, z - 0.075), (RIGHT + 0.05, y + 0.17, z + 0.075))
    return shape
