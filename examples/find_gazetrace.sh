# SPDX-License-Identifier: Apache-2.0
# Sourced by the examples: sets $gazetrace to the program and goes to the repository's root, whose paths they use.
# The program is the first argument of the example, else the newest one in build*/, else the one on the PATH.
gazetrace=${1:-}
[ -z "$gazetrace" ] || gazetrace=$(realpath "$gazetrace")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [ -z "$gazetrace" ]; then
  # find fails where build* matches nothing, which is no error here
  gazetrace=$({ find build* -maxdepth 4 -type f -name gazetrace -perm -u+x -printf '%T@ %p\n' 2>/dev/null || true; } |
    sort -rn | head -n 1 | cut -d' ' -f2-)
fi
[ -n "$gazetrace" ] || gazetrace=$(command -v gazetrace || true)
if [ ! -x "$gazetrace" ]; then
  echo "no gazetrace program: build it (see README.md) or give its path as the first argument" >&2
  exit 2
fi
