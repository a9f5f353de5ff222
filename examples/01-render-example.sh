#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Renders the shipped example, 40 foveated frames of 960 x 540 with their timing, into out/example/ (a minute or two on
# two cores). More arguments go to gazetrace: 01-render-example.sh build/release/.../gazetrace --frames 1-12
set -euo pipefail
source "$(dirname "$0")/find_gazetrace.sh"

"$gazetrace" render --config examples/example.toml --overwrite "${@:2}"
