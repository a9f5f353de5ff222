# SPDX-License-Identifier: Apache-2.0
"""What stands and hangs in the courtyard: the bench with its three objects, lantern, neon, pots, tree."""
import math

from .shapes import Shape, box, disc, facets, revolve, sphere, tube
from .vec import add, mix, normalize, scale, smoothstep, sub

BENCH = {"x": (0.44, 2.98), "z": (-0.42, 0.16), "top": 0.36}


def bench():
    shape = Shape()
    (x0, x1), (z0, z1), top = BENCH["x"], BENCH["z"], BENCH["top"]
    box(shape, (x0, top - 0.09, z0), (x1, top, z1))
    for x in (x0 + 0.14, 0.5 * (x0 + x1) - 0.11, x1 - 0.36):
        box(shape, (x, 0.0, z0 + 0.07), (x + 0.22, top - 0.09, z1 - 0.07))
    return shape


def vase():
    """A thrown vase with bands of glaze as vertex colours."""
    shape = Shape()
    keys = [(0.0, 0.085), (0.02, 0.095), (0.08, 0.130), (0.18, 0.168), (0.27, 0.172), (0.36, 0.140), (0.43, 0.088),
            (0.47, 0.062), (0.52, 0.058), (0.56, 0.072), (0.585, 0.092)]  # fmt: skip
    outer = _smooth(keys, 38)
    inner = [(max(0.0, r - 0.010), y) for r, y in reversed(outer) if y > 0.05]
    profile = [(0.0, 0.0), (0.085, 0.0)] + outer + [(outer[-1][0] - 0.004, 0.590)] + inner

    glaze, clay, dark, gold = (0.035, 0.22, 0.25), (0.52, 0.235, 0.11), (0.012, 0.035, 0.075), (0.75, 0.55, 0.24)

    def color(position, radius, height):
        angle = math.atan2(position[2], position[0])
        drip = 0.125 + 0.018 * math.sin(5 * angle + 0.6) + 0.012 * math.sin(11 * angle)
        tone = mix(clay, glaze, smoothstep(drip - 0.008, drip + 0.008, height))
        for at, half in ((0.335, 0.018), (0.455, 0.010)):
            band = 1.0 - smoothstep(half - 0.004, half + 0.004, abs(height - at))
            tone = mix(tone, dark, band)
        zigzag = 0.237 + 0.020 * (2 * abs((angle * 9 / math.pi) % 2 - 1) - 1)
        tone = mix(tone, gold, 1.0 - smoothstep(0.005, 0.010, abs(height - zigzag)))
        return tone

    revolve(shape, profile, 90, color=color)
    return shape


def _smooth(keys, count):
    """Catmull-Rom through (height, radius) keys, evenly in parameter: (radius, height) points."""
    points = []
    for k in range(count + 1):
        t = k / count * (len(keys) - 1)
        i = min(int(t), len(keys) - 2)
        f = t - i
        p = [keys[max(0, min(len(keys) - 1, i + d))] for d in (-1, 0, 1, 2)]
        values = []
        for axis in (0, 1):
            a, b, c, d = (q[axis] for q in p)
            values.append(0.5 * (2 * b + (c - a) * f + (2 * a - 5 * b + 4 * c - d) * f**2 + (3 * b - a - 3 * c + d) * f**3))
        points.append((values[1], values[0]))
    return points


def knot():
    """A trefoil knot that stands on the bench, 0.42 m tall."""
    shape = Shape()
    count, size = 180, 0.070
    path = []
    for k in range(count):
        t = 2.0 * math.pi * k / count
        x, y = math.sin(t) + 2.0 * math.sin(2 * t), math.cos(t) - 2.0 * math.cos(2 * t)
        path.append((x * size, y * size, -math.sin(3 * t) * size))
    radius = 0.043
    low = min(p[1] for p in path) - radius
    tube(shape, [(x, y - low, z) for x, y, z in path], radius, 22, closed=True)
    return shape


def ball():
    shape = Shape()
    sphere(shape, (0, 0.235, 0), 0.215, 64, 40)
    revolve(shape, [(0.115, 0.0), (0.115, 0.025), (0.115, 0.025), (0.095, 0.035), (0.085, 0.05)], 40)
    return shape


def lantern():
    """(metal, glass, light): a hexagonal lantern with a bulb behind its panes; its ring hangs at the origin, all of it lies below."""
    metal, glass, light = Shape(), Shape(), Shape()
    twist = math.pi / 6
    top, bottom, wide, narrow = -0.34, -0.78, 0.19, 0.15
    tube(metal, [(0, 0.68, 0), (0, 0.3, 0), (0, -0.06, 0)], 0.008, 8)
    tube(metal, [(0.035 * math.cos(a), -0.09 + 0.035 * math.sin(a), 0) for a in _circle(20)], 0.007, 8, closed=True)
    revolve(metal, [(0.0, -0.11), (0.03, -0.125), (0.045, -0.15)][::-1], 24)
    facets(metal, 6, wide + 0.045, 0.045, top + 0.02, -0.15, twist=twist)
    facets(metal, 6, wide + 0.02, wide + 0.045, top - 0.02, top + 0.02, twist=twist)
    facets(metal, 6, narrow + 0.02, narrow + 0.02, bottom - 0.04, bottom, twist=twist)
    disc(metal, (0, bottom, 0), narrow + 0.02, 6, twist=twist)
    disc(metal, (0, bottom - 0.04, 0), narrow + 0.02, 6, twist=twist, down=True)
    revolve(metal, [(0.0, bottom - 0.13), (0.018, bottom - 0.11), (0.028, bottom - 0.08), (0.02, bottom - 0.04)], 20)
    corner = lambda k, r, y: (r * math.cos(twist - k * math.pi / 3), y, r * math.sin(twist - k * math.pi / 3))  # noqa: E731
    for k in range(6):
        tube(metal, [corner(k, narrow, bottom), corner(k, wide, top)], 0.010, 8)
        # Lattice over each pane: two diagonals and a lozenge of thin bars.
        a, b = corner(k, narrow, bottom), corner(k + 1, narrow, bottom)
        c, d = corner(k + 1, wide, top), corner(k, wide, top)
        for p, q in ((a, c), (b, d), (mix(a, d, 0.5), mix(a, b, 0.5)), (mix(a, b, 0.5), mix(b, c, 0.5)),
                     (mix(b, c, 0.5), mix(d, c, 0.5)), (mix(d, c, 0.5), mix(a, d, 0.5))):  # fmt: skip
            tube(metal, [p, q], 0.0045, 6, caps=False)
    facets(glass, 6, narrow - 0.012, wide - 0.012, bottom + 0.005, top - 0.005, twist=twist)
    # The bulb stands in a socket: a pear, 10 cm wide.
    socket = bottom + 0.10
    revolve(metal, [(0.0, bottom), (0.032, bottom), (0.032, bottom), (0.026, socket), (0.026, socket), (0.0, socket)], 20)
    pear = [(0.05 * math.sin(a) * (1 - 0.18 * math.cos(a)), socket + 0.075 - 0.085 * math.cos(a))
            for a in (math.pi * k / 12 for k in range(1, 12))]  # fmt: skip
    revolve(light, [(0.0, socket - 0.01), *pear, (0.0, socket + 0.16)], 20)
    return metal, glass, light


def _circle(count):
    return [2.0 * math.pi * k / count for k in range(count)]


def neon_eye():
    """(outline, iris, supports): an eye of bent glass tubes in the x-y plane, facing +z, 1.3 m wide, about the origin."""
    outline, iris, supports = Shape(), Shape(), Shape()
    half, lift = 0.62, 0.30
    radius = (half * half + lift * lift) / (2 * lift)
    reach = math.asin(half / radius)
    upper = [(radius * math.sin(a), radius * math.cos(a) - radius + lift, 0) for a in _steps(-reach, reach, 40)]
    lower = [(x, -0.80 * y, 0) for x, y, _ in reversed(upper)]
    tube(outline, upper + lower[1:-1], 0.0155, 10, closed=True)
    tube(iris, [(0.185 * math.cos(a), 0.03 + 0.185 * math.sin(a), 0.012) for a in _circle(44)], 0.0155, 10, closed=True)
    tube(iris, [(0.055 * math.cos(a), 0.03 + 0.055 * math.sin(a), 0.012) for a in _circle(24)], 0.0155, 10, closed=True)
    for x, y, _ in (upper[6], upper[20], upper[34], lower[12], lower[28]):
        tube(supports, [(x, y, -0.09), (x, y, 0.0)], 0.009, 8)
    return outline, iris, supports


def _steps(low, high, count):
    return [low + (high - low) * k / count for k in range(count + 1)]


def pot(radius, height):
    """(pot, soil)"""
    clay, soil = Shape(), Shape()
    profile = [(0.0, 0.0), (radius * 0.62, 0.0), (radius * 0.62, 0.0), (radius * 0.80, height * 0.45),
               (radius * 0.93, height * 0.86), (radius * 0.93, height * 0.86), (radius * 1.06, height * 0.88),
               (radius * 1.08, height * 0.94), (radius * 1.05, height), (radius * 1.05, height),
               (radius * 0.90, height), (radius * 0.90, height), (radius * 0.86, height * 0.86)]  # fmt: skip
    revolve(clay, profile, 40)
    disc(soil, (0, height * 0.88, 0), radius * 0.88, 24)
    return clay, soil


def sprig():
    """(olive, flowers): a bent card of 8 triangles, stem at the origin, 1 m tall along +y; left or right half of the atlas."""
    cards = []
    for u0 in (0.0, 0.5):
        card = Shape()

        def vertex(i, j, u0=u0):
            x, y = i / 2 - 0.5, j / 2
            bend = 0.16 * y * y + 0.22 * abs(x)
            normal = normalize((-0.44 * (x > 0) + 0.44 * (x < 0), -0.32 * y, 1.0))
            return (x, y, bend), normal, (u0 + 0.5 * (i / 2) * 0.996 + 0.001, 1.0 - y)

        card.grid(2, 2, vertex)
        cards.append(card)
    return cards


def tree(random):
    """(wood, leaf places): an olive tree 2.7 m tall. Places are (position, direction out of the crown)."""
    wood = Shape()
    trunk = [(0.0, 0.0, 0.0), (0.03, 0.25, 0.02), (-0.03, 0.55, 0.0), (0.04, 0.85, 0.03), (0.02, 1.12, 0.0)]
    tube(wood, _curve(trunk, 16), lambda t: 0.075 - 0.028 * t, 12)
    places = []
    for k in range(7):
        angle = k * 2.4 + random.uniform(-0.3, 0.3)
        reach = random.uniform(0.34, 0.66)
        start = trunk[3] if k % 2 else trunk[4]
        rise = random.uniform(0.45, 1.05)
        tip = (start[0] + reach * math.cos(angle), start[1] + rise, start[2] + reach * math.sin(angle))
        bend = add(mix(start, tip, 0.5), (0.0, 0.12, 0.0))
        branch = _curve([start, bend, tip], 8)
        tube(wood, branch, lambda t: 0.036 - 0.026 * t, 8)
        for _ in range(64):
            center = branch[random.randrange(3, len(branch))]
            out = normalize(tuple(random.gauss(0, 1) for _ in range(3)))
            far = random.random() ** 0.5
            position = add(center, (out[0] * 0.32 * far, out[1] * 0.26 * far + 0.04, out[2] * 0.32 * far))
            places.append((position, normalize(add(out, (0.0, 0.35, 0.0)))))
    return wood, places


def _curve(points, steps):
    """Catmull-Rom through 3-D points."""
    out = []
    for k in range(steps + 1):
        t = k / steps * (len(points) - 1)
        i = min(int(t), len(points) - 2)
        f = t - i
        p = [points[max(0, min(len(points) - 1, i + d))] for d in (-1, 0, 1, 2)]
        total = scale(p[1], 2.0)
        total = add(total, scale(sub(p[2], p[0]), f))
        second = add(sub(scale(p[0], 2.0), scale(p[1], 5.0)), sub(scale(p[2], 4.0), p[3]))
        third = add(sub(scale(p[1], 3.0), p[0]), sub(p[3], scale(p[2], 3.0)))
        out.append(scale(add(total, add(scale(second, f * f), scale(third, f**3))), 0.5))
    return out


def bougainvillea(random):
    """Places of leaves and of flowers where it spills over the right wall and the corner of the back wall."""
    leaves, flowers = [], []
    for k in range(520):
        along = random.random()
        spill = random.random() ** 1.6
        if k % 3:
            width = 0.55 + 0.45 * math.sin(5.0 * along + 0.4)
            position = (3.50 - 0.16 * random.random(), 3.80 - 1.35 * spill * width, -4.9 + 3.6 * along)
            out = (-1.0, 0.15, random.uniform(-0.3, 0.3))
        else:
            width = 1.0 - 0.85 * along
            position = (3.55 - 2.0 * along, 3.82 - 1.15 * spill * width, -4.92 + 0.16 * random.random())
            out = (random.uniform(-0.3, 0.3), 0.15, 1.0)
        down = normalize(add(scale(normalize(out), 0.75), (0.0, random.uniform(-0.9, 0.5), 0.0)))
        (flowers if random.random() < 0.46 else leaves).append((position, down))
    return leaves, flowers
