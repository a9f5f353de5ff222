# SPDX-License-Identifier: Apache-2.0
"""cpu_meter.py FILE COMMAND...: runs the command, passes signals on to it, and adds a line to FILE with the processor time
that it took and how it ended."""

import json
import os
import resource
import signal
import subprocess
import sys


def main():
    child = subprocess.Popen(sys.argv[2:])
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1, signal.SIGXCPU):
        signal.signal(number, lambda got, _: child.send_signal(got))
    code = child.wait()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    line = json.dumps({"command": sys.argv[3:], "cpu_s": round(used.ru_utime + used.ru_stime, 3), "code": code}) + "\n"
    with open(sys.argv[1], "a", encoding="utf-8") as file:
        file.write(line)
    if code < 0:
        signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    return code


if __name__ == "__main__":
    sys.exit(main())
