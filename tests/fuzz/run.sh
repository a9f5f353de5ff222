#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes targets one after another, in slots, and says for each how long it ran by the clock and on a processor, and what
# came of it.
# usage: tests/fuzz/run.sh SECONDS [TARGET...]      without targets: all of both programs
#   GAZETRACE_FUZZ_FOLDER    where the programs are, default build/fuzz/tests/fuzz
#   GAZETRACE_FUZZ_WORK      corpora, logs, findings and results.tsv, default build/fuzz/state; kept from run to run
#   GAZETRACE_FUZZ_TIMEOUT   seconds after which one input counts as a hang, default 10
#   GAZETRACE_FUZZ_PREFIX    words before the program, such as "nice -n 19"
#   GAZETRACE_FUZZ_LOAD      wait before a target while the load of the machine is above this
# Build: cmake --preset fuzz && cmake --build --preset fuzz
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:?$(sed -n '3,12s/^# \?//p' "$0")}
shift
folder=${GAZETRACE_FUZZ_FOLDER:-build/fuzz/tests/fuzz}
work=${GAZETRACE_FUZZ_WORK:-build/fuzz/state}
most_load=${GAZETRACE_FUZZ_LOAD:-1000}
read -ra prefix <<< "${GAZETRACE_FUZZ_PREFIX:-}"
mkdir -p "$work/corpus" "$work/findings" "$work/log"

# A program lists its targets when it is given none.
targets_of() { GAZETRACE_FUZZ_READER='' "$folder/$1" -runs=1 2>&1 | sed -n 's/^.*must be one of: //p'; }
program_of() { case $1 in gaze-* | camera-*) echo gazetrace_fuzz_reader ;; *) echo gazetrace_fuzz_file ;; esac; }
is_busy() { awk -v most="$most_load" '{ exit !($1 > most) }' /proc/loadavg; }

targets=("$@")
[ $# != 0 ] || read -ra targets <<< "$(targets_of gazetrace_fuzz_file) $(targets_of gazetrace_fuzz_reader)"
python3 -B tests/fuzz/make_corpus.py "$work/seeds"
[ ! -x "$folder/gazetrace_fuzz_file" ] || GAZETRACE_FUZZ_SEEDS=$work/seeds "$folder/gazetrace_fuzz_file"

failed=0
TIMEFORMAT='%U %S'
for target in "${targets[@]}"; do
  while is_busy; do sleep 10; done
  mkdir -p "$work/corpus/$target" "$work/seeds/$target"
  log=$work/log/$target.log
  # Image libraries leak on damaged files. Of the rest every leak is ours.
  leaks=1
  longest=16384
  case $target in scene* | picture-*) leaks=0 longest=65536 ;; esac
  code=0
  begin=$(date +%s)
  { time GAZETRACE_FUZZ_READER=$target ASAN_OPTIONS=detect_leaks=$leaks:allocator_may_return_null=0 \
    "${prefix[@]}" "$folder/$(program_of "$target")" -max_total_time="$seconds" -max_len=$longest \
    -timeout="${GAZETRACE_FUZZ_TIMEOUT:-10}" -rss_limit_mb=1536 -malloc_limit_mb=512 -dict=tests/fuzz/readers.dict \
    -print_final_stats=1 -artifact_prefix="$work/findings/$target-" "$work/corpus/$target" "$work/seeds/$target" \
    > "$log" 2>&1; } 2> "$work/cpu" || code=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
  rss=$(sed -n 's/^stat::peak_rss_mb: *//p' "$log" | tail -1)
  cover=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  cpu=$(tail -1 "$work/cpu" | awk '{ print $1 + $2 }')
  printf '%s\t%s s\tcpu %s s\t%s runs\tcov %s\tpeak %s MiB\texit %s\n' "$target" "$(($(date +%s) - begin))" \
    "$cpu" "${runs:-?}" "${cover:-?}" "${rss:-?}" "$code" | tee -a "$work/results.tsv"
  [ $code = 0 ] || { failed=1; cp "$log" "$work/log/$target.failed.log"; }
done
exit $failed
