# SPDX-License-Identifier: Apache-2.0
"""A few seconds of tests/benchmarks/soak.py: faults at random, seeds printed."""

import os
import subprocess
import sys
from pathlib import Path

SOAK = Path(__file__).resolve().parents[1] / "benchmarks" / "soak.py"

sys.exit(subprocess.run([sys.executable, "-B", str(SOAK), "--seconds", "8", "--seed", "1"], env=os.environ, check=False).returncode)
