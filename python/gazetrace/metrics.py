# SPDX-License-Identifier: Apache-2.0
"""Every metric of the library as a function of two pictures, or two sequences, in memory.

    gazetrace.metrics.flip(reference, test)
    gazetrace.metrics.fovvideovdp(reference, test, gaze=(0.5, 0.5), screen="paper", fps=24)
    value, maps = gazetrace.metrics.relmse(reference, test, maps=True)

Arguments are those of `gazetrace.compare()`. A picture is an array of the shape (height, width, 3), a sequence one with
a dimension more or an iterable. Metrics of linear light and of code values are given the same arrays: linear light is
taken through the view.
"""

from . import _core
from .comparison import compare

INFO = {info["name"]: info for info in _core.metrics()}


def measure(metric, reference, test, *, maps=False, **options):
    """The value of a metric by its name and, with `maps`, the error map of each frame."""
    result = compare(reference, test, metrics=[metric], maps=maps, **options)
    return (result[metric], result.maps(metric)) if maps else result[metric]


def _function(info):
    def metric(reference, test, **options):
        return measure(info["name"], reference, test, **options)

    metric.__name__ = metric.__qualname__ = info["name"]
    metric.__doc__ = f"{info['description']}; {info['better']} is better. See `measure()`."
    return metric


globals().update({name: _function(info) for name, info in INFO.items()})
__all__ = ["INFO", "measure", *INFO]
