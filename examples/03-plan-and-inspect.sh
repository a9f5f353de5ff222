#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# What the inputs contain and what would be rendered, without a ray: scene, gaze log, the plan of a second of frames (which
# rows of the log each frame uses, and how old they are), and samples per region with the ratio to uniform sampling.
set -euo pipefail
source "$(dirname "$0")/find_gazetrace.sh"

"$gazetrace" scene scenes/courtyard/courtyard.gltf
echo
"$gazetrace" gaze inspect gazelogs/tx300_left.csv
echo
"$gazetrace" plan --config examples/example.toml --frames 21-30
echo
"$gazetrace" plan --config examples/example.toml --frames 21-30 --counts
