# SPDX-License-Identifier: Apache-2.0
"""Diagrams: one style, and SVG that stands in a page, in light and dark, as well as in a file."""

import contextlib
import html
import io
import logging
import re
import warnings
from importlib import resources

import matplotlib
import matplotlib.style
import matplotlib.ticker
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

INK, GRID = "#1c1c1c", "#d8d8d8"
STYLE = resources.files(__package__) / "data" / "gazetrace.mplstyle"


@contextlib.contextmanager
def figure(width=4.6, height=3.3, **more):
    """A figure with its axes in the style of all, whatever the user's own; apart from pyplot, whose backend is the caller's."""
    with matplotlib.style.context(["default", str(STYLE)]), _without_words_on_fonts():
        fig = Figure(figsize=(width, height))
        FigureCanvasAgg(fig)
        yield fig, fig.subplots(**more)


@contextlib.contextmanager
def _without_words_on_fonts():
    """A page's letters are the browser's: which fonts there are here, and which signs these have, says nothing of it."""
    log = logging.getLogger("matplotlib.font_manager")
    level = log.level
    log.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph .* missing from", UserWarning)
            yield
    finally:
        log.setLevel(level)


def svg_of(fig, title):
    """The figure as a file of its own, the same each time."""
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": title}):
        fig.savefig(text, format="svg", metadata={"Date": None, "Creator": None, "Title": title, "Format": None, "Type": None})
    return re.sub(r' (?:d|x|y|transform)="[^"]*"', lambda m: re.sub(r"(\d\.\d\d)\d+", r"\1", m.group()), text.getvalue())


def pdf_of(fig, title):
    data = io.BytesIO()
    fig.savefig(data, format="pdf", metadata={"Title": title, "CreationDate": None, "ModDate": None})
    return data.getvalue()


def in_page(svg, title, names):
    """The SVG as a part of a page: as wide as there is room, inks that follow the page's, names that no other drawing
    has. `names` counts the drawings."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.S)
    used = set(re.findall(r'(?:url\(#|href="#)([^")]+)', svg))
    svg = re.sub(r' id="([^"]*)"', lambda m: m.group(0) if m.group(1) in used else "", svg)
    for name in used:
        svg = re.sub(rf'(id="|url\(#|href="#){re.escape(name)}(?=["\)])', rf"\g<1>d{names}{name}", svg)
    svg = re.sub(r' (?:width|height)="[\d.]+pt"', "", svg, 2)
    svg = svg.replace("<svg", f'<svg role="img" aria-label="{html.escape(title, True)}"', 1)
    svg = svg.replace(INK, "currentColor").replace(GRID, "var(--line)")
    svg = re.sub(r"(?<=: )#(0072b2|5a5a5a|d55e00|b8860b|009e73|b0579a|8a8a8a)(?=[;\"])", r"var(--c\1, #\1)", svg)
    return re.sub(r"\n\s*", "\n", svg)


def wants_log(values):
    """Values that span more than a factor of 8 are told apart on a logarithmic scale."""
    return bool(len(values)) and min(values) > 0 and max(values) / min(values) > 8


def scale_of(axis, values):
    """A logarithmic or linear axis for these values, with numbers as people write them."""
    if wants_log(values):
        axis.axes.set_yscale("log") if axis.axis_name == "y" else axis.axes.set_xscale("log")
        wide = max(values) / min(values) > 30
        axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1,) if wide and max(values) / min(values) > 300 else (1, 3) if wide else (1, 2, 5)))
        axis.set_minor_locator(matplotlib.ticker.NullLocator())
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:.4g}"))


class Labels:
    """Words beside marks, where they cover marks and other words least. Places are in points of the figure."""

    def __init__(self, fig, axes):
        fig.canvas.draw()
        self.axes, self.taken = axes, []
        self.renderer, self.points = fig.canvas.get_renderer(), fig.dpi / 72
        self.box = axes.get_window_extent(self.renderer)

    def keep_clear(self, x, y, radius=4):
        """A mark and the bars of its intervals."""
        r = radius * self.points
        low = self.axes.transData.transform((x.mean if x.low is None else x.low, y.mean if y.low is None else y.low))
        high = self.axes.transData.transform((x.mean if x.high is None else x.high, y.mean if y.high is None else y.high))
        px, py = self.axes.transData.transform((x.mean, y.mean))
        self.taken += [(px - r, py - r, px + r, py + r), (low[0], py - 1, high[0], py + 1), (px - 1, low[1], px + 1, high[1])]

    def put(self, x, y, words, color, size=8, radius=4):
        px, py = self.axes.transData.transform((x, y))
        probe = self.axes.text(0, 0, words, fontsize=size)
        extent = probe.get_window_extent(self.renderer)
        probe.remove()
        width, height, unit = extent.width * 1.08, extent.height, self.points  # browsers have wider letters
        best, least = None, None
        beside = radius + 2
        for turn, rise in enumerate((0, 6, -6, 14, -14, 22, -22, 31, -31, 40, -40)):
            for right in (True, False):
                left = px + beside * unit if right else px - beside * unit - width
                bottom = py + rise * unit - height / 2
                box = (left, bottom, left + width, bottom + height)
                cost = 0.02 * turn * width * height + 4 * (width * height - _overlap(box, (self.box.x0, self.box.y0, self.box.x1, self.box.y1)))
                cost += sum(_overlap(box, other) for other in self.taken)
                if least is None or cost < least:
                    best, least = (box, right, rise), cost
        box, right, rise = best
        self.taken.append(box)
        offset = (beside if right else -beside, rise)
        far = abs(rise) > 12
        self.axes.annotate(words, (x, y), offset, textcoords="offset points", fontsize=size, color=color, ha="left" if right else "right", va="center",
                           annotation_clip=False, arrowprops={"arrowstyle": "-", "color": color, "lw": 0.5, "shrinkA": 0, "shrinkB": 3} if far else None)

    def along(self, y, words, size=7.5):
        """Words on a level line through the axes, where they cover least."""
        probe = self.axes.text(0, 0, words, fontsize=size)
        extent = probe.get_window_extent(self.renderer)
        probe.remove()
        height, gap = extent.height, 2 * self.points
        level = self.axes.transData.transform((self.axes.get_xlim()[0], y))[1]
        best, least = None, None
        for share in (1, 0, 0.75, 0.5, 0.25):
            for above in (True, False):
                left = self.box.x0 + share * (self.box.width - 1.08 * extent.width)
                bottom = level + gap if above else level - gap - height
                box = (left, bottom, left + 1.08 * extent.width, bottom + height)
                outside = extent.width * height - _overlap(box, (self.box.x0, self.box.y0, self.box.x1, self.box.y1))
                cost = 4 * outside + sum(_overlap(box, other) for other in self.taken)
                if least is None or cost < least:
                    best, least = (box, share, above), cost
        box, share, above = best
        self.taken.append(box)
        self.axes.annotate(words, (share, y), (3 if share == 0 else -3 if share == 1 else 0, 2 if above else -2), xycoords=("axes fraction", "data"), textcoords="offset points", fontsize=size,
                           ha="right" if share == 1 else "left" if share == 0 else "center", va="bottom" if above else "top")


def _overlap(a, b):
    return max(0.0, min(a[2], b[2]) - max(a[0], b[0])) * max(0.0, min(a[3], b[3]) - max(a[1], b[1]))
