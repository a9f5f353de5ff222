#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One frame twice: uniform at 32 samples a pixel, and foveated as in the source paper with the map of where its samples
# went. Writes EXR and PNG to out/compare/ and prints what was saved. FRAME=n chooses the frame, SIZE=WxH its size.
set -euo pipefail
source "$(dirname "$0")/find_gazetrace.sh"
frame=${FRAME:-7}
common=(render --config examples/example.toml --frames "$frame" --size "${SIZE:-640x360}" --accumulate off \
  --overwrite --quiet)

mkdir -p out/compare/uniform out/compare/foveated
"$gazetrace" "${common[@]}" --sampling uniform --spp 32 \
  --output out/compare/uniform/frame.####.exr --output out/compare/uniform/frame.####.png
"$gazetrace" "${common[@]}" --sampling regions --map out/compare/foveated/map.####.exr --aov samples,eccentricity \
  --output out/compare/foveated/frame.####.exr --output out/compare/foveated/frame.####.png

# The columns are found by their names, so that new ones do no harm.
awk -F, '
  FNR == 1 { file++; delete column; for (i = 1; i <= NF; i++) column[$i] = i; next }
  { samples[file] += $column["samples"]; ms[file] += $column["guiding_ms"] + $column["trace_ms"] + $column["reconstruct_ms"] }
  END {
    printf "uniform:  %9d samples, %8.1f ms for tracing and reconstruction\n", samples[1], ms[1]
    printf "foveated: %9d samples, %8.1f ms\n", samples[2], ms[2]
    printf "ratio:    %9.2f x samples, %6.2f x time\n", samples[1] / samples[2], ms[1] / ms[2]
  }' out/compare/uniform/*timing*.csv out/compare/foveated/*timing*.csv
echo "pictures: out/compare/uniform/ and out/compare/foveated/ (map.*.exr is the sampling map)"
