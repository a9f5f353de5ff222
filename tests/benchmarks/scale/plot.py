# SPDX-License-Identifier: Apache-2.0
"""A small SVG: every quantity of a curve over n, both axes logarithmic, one panel a quantity."""

import math
from xml.sax.saxutils import escape

PANEL_W, PANEL_H, LEFT, RIGHT, TOP, BOTTOM = 300, 200, 62, 14, 34, 36


def decades(low, high):
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    return first, max(last, first + 1)


def label(power):
    return {-2: "0.01", -1: "0.1", 0: "1", 1: "10", 2: "100", 3: "1000"}.get(power) or f"1e{power}"


def panel(name, points, title, x0):
    points = [(x, y) for x, y in points if x > 0 and y > 0]
    if not points:
        return ""
    (xa, xb), (ya, yb) = (decades(min(v), max(v)) for v in zip(*points))
    width, height = PANEL_W - LEFT - RIGHT, PANEL_H - TOP - BOTTOM
    at_x = lambda x: x0 + LEFT + width * (math.log10(x) - xa) / (xb - xa)
    at_y = lambda y: TOP + height * (1 - (math.log10(y) - ya) / (yb - ya))
    out = [f'<text x="{x0 + LEFT}" y="{TOP - 12}" font-weight="bold">{escape(name.replace("_", " "))}</text>',
           f'<text x="{x0 + LEFT + width / 2}" y="{PANEL_H - 4}" text-anchor="middle">{escape(title)}</text>']
    for k in range(xa, xb + 1, max(1, (xb - xa) // 4)):
        out += [f'<path d="M{at_x(10.0**k):.1f} {TOP}v{height}" stroke="#ddd"/>',
                f'<text x="{at_x(10.0**k):.1f}" y="{TOP + height + 14}" text-anchor="middle">{label(k)}</text>']
    for k in range(ya, yb + 1, max(1, (yb - ya) // 4)):
        out += [f'<path d="M{x0 + LEFT} {at_y(10.0**k):.1f}h{width}" stroke="#ddd"/>',
                f'<text x="{x0 + LEFT - 6}" y="{at_y(10.0**k) + 4:.1f}" text-anchor="end">{label(k)}</text>']
    line = " ".join(f"{at_x(x):.1f},{at_y(y):.1f}" for x, y in points)
    out.append(f'<polyline points="{line}" fill="none" stroke="#1f5fa8" stroke-width="1.5"/>')
    out += [f'<circle cx="{at_x(x):.1f}" cy="{at_y(y):.1f}" r="2.5" fill="#1f5fa8"/>' for x, y in points]
    return "\n".join(out)


def log_log(title, rows):
    names = [k for k in rows[0] if k != "n" and any(r[k] > 0 for r in rows)]
    panels = [panel(name, [(r["n"], r[name]) for r in rows], title, i * PANEL_W) for i, name in enumerate(names)]
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {PANEL_W * len(names)} {PANEL_H}" '
            f'width="{PANEL_W * len(names)}" height="{PANEL_H}" font-family="sans-serif" font-size="11">\n'
            '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(panels) + "\n</svg>\n")
