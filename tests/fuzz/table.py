#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What run.sh has written into results.tsv, added up by target, as the table of findings.md: table.py [results.tsv]."""

import collections
import sys
from pathlib import Path


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else Path(__file__).resolve().parents[2] / "build/fuzz/state/results.tsv"
    cpu_s, runs, stopped = collections.Counter(), collections.Counter(), collections.Counter()
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        target, _, cpu, count, _, _, code = line.split("\t")
        cpu_s[target] += float(cpu.split()[1])
        runs[target] += int(count.split()[0]) if count.split()[0].isdigit() else 0
        stopped[target] += code != "exit 0"
    print("| target | CPU s | runs | findings |\n| --- | --- | --- | --- |")
    for target in sorted(cpu_s):
        print(f"| `{target}` | {cpu_s[target]:.0f} | {runs[target]:,} | {stopped[target]} |")
    print(f"| all {len(cpu_s)} | {sum(cpu_s.values()) / 3600:.2f} hours | {sum(runs.values()):,} | {sum(stopped.values())} |")


if __name__ == "__main__":
    main()
