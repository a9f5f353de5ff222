#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes readers one after another, in slots, and says for each how long it ran by the clock and on a processor, and what
# came of it.
# usage: tests/fuzz/run.sh SECONDS [READER...]      without readers: all of them
#   GAZETRACE_FUZZ_PROGRAM   the program, default build/fuzz/tests/fuzz/gazetrace_fuzz_reader
#   GAZETRACE_FUZZ_WORK      corpora, logs, findings and results.tsv, default build/fuzz/state; kept from run to run
#   GAZETRACE_FUZZ_TIMEOUT   seconds after which one input counts as a hang, default 10
#   GAZETRACE_FUZZ_PREFIX    words before the program, such as "nice -n 19"
# Build: cmake -S . -B build/fuzz -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DGAZETRACE_BUILD_FUZZERS=ON &&
#        cmake --build build/fuzz --target gazetrace_fuzz_reader
set -euo pipefail
cd "$(dirname "$0")/../.."

seconds=${1:?$(sed -n '3,11s/^# \?//p' "$0")}
shift
program=${GAZETRACE_FUZZ_PROGRAM:-build/fuzz/tests/fuzz/gazetrace_fuzz_reader}
work=${GAZETRACE_FUZZ_WORK:-build/fuzz/state}
read -ra prefix <<< "${GAZETRACE_FUZZ_PREFIX:-}"
mkdir -p "$work/corpus" "$work/findings" "$work/log"

readers=("$@")
if [ $# = 0 ]; then
  # The program lists its readers when it is given none.
  read -ra readers <<< "$(GAZETRACE_FUZZ_READER='' "$program" -runs=1 2>&1 | sed -n 's/^.*must be one of: //p')"
fi
python3 -B tests/fuzz/make_corpus.py "$work/seeds"

failed=0
TIMEFORMAT=%U
for reader in "${readers[@]}"; do
  mkdir -p "$work/corpus/$reader" "$work/seeds/$reader"
  log=$work/log/$reader.log
  code=0
  begin=$(date +%s)
  { time GAZETRACE_FUZZ_READER=$reader ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=0 \
    "${prefix[@]}" "$program" -max_total_time="$seconds" -max_len=16384 -timeout="${GAZETRACE_FUZZ_TIMEOUT:-10}" -rss_limit_mb=1024 \
    -malloc_limit_mb=512 -dict=tests/fuzz/readers.dict -print_final_stats=1 \
    -artifact_prefix="$work/findings/$reader-" "$work/corpus/$reader" "$work/seeds/$reader" > "$log" 2>&1; } 2> "$work/cpu" || code=$?
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
  rss=$(sed -n 's/^stat::peak_rss_mb: *//p' "$log" | tail -1)
  cover=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  printf '%s\t%s s\tcpu %s s\t%s runs\tcov %s\tpeak %s MiB\texit %s\n' "$reader" "$(($(date +%s) - begin))" \
    "$(tail -1 "$work/cpu")" "${runs:-?}" "${cover:-?}" "${rss:-?}" "$code" | tee -a "$work/results.tsv"
  [ $code = 0 ] || { failed=1; cp "$log" "$work/log/$reader.failed.log"; }
done
exit $failed
