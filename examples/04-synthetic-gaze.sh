#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A still camera and gaze whose truth is known: nine frames, one at each target of the fixation grid, with sampling maps, in
# out/grid/. The fovea should sit at 0.1, 0.5 and 0.9 of width and height, row by row.
set -euo pipefail
source "$(dirname "$0")/find_gazetrace.sh"

# Every target is looked at for 0.6 s and reached by a saccade of 0.08 to 0.14 s: a step of 0.69 s meets each of them.
"$gazetrace" render --config examples/example.toml --camera still --gaze gazelogs/fixation_grid.csv \
  --fps 100/69 --start 200ms --frames 1-9 --overwrite --map out/grid/map.####.exr \
  --output out/grid/frame.####.png
