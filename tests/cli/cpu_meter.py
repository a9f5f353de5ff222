# SPDX-License-Identifier: Apache-2.0
"""cpu_meter.py FILE COMMAND...: runs the command, passes signals on to it, and adds a line to FILE with the processor time
that it took and how it ended. Where the command renders chunk K and there is a file FILE.hold-K, that file is removed, and
the command is stopped once it has run for as many seconds as the file says; FILE.held-K tells that it stands still. So what
is to be done to a chunk finds it at work, however fast or loaded the machine is."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path


def hold(child, path):
    """Stops the child as the first attempt at a chunk is to be."""
    if "--chunk" not in sys.argv:
        return
    chunk = sys.argv[sys.argv.index("--chunk") + 1].split("/")[0]
    wanted = Path(f"{path}.hold-{chunk}")
    try:
        seconds = float(wanted.read_text())
        wanted.unlink()
    except FileNotFoundError:
        return
    time.sleep(seconds)
    child.send_signal(signal.SIGSTOP)
    Path(f"{path}.held-{chunk}").write_text(f"{child.pid}\n")


def main():
    child = subprocess.Popen(sys.argv[2:])

    def pass_on(number, _):
        child.send_signal(number)
        child.send_signal(signal.SIGCONT)

    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1, signal.SIGXCPU):
        signal.signal(number, pass_on)
    hold(child, sys.argv[1])
    code = child.wait()
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    line = json.dumps({"command": sys.argv[3:], "cpu_s": round(used.ru_utime + used.ru_stime, 3), "code": code}) + "\n"
    with open(sys.argv[1], "a", encoding="utf-8") as file:
        file.write(line)
    if code < 0:
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    return code


if __name__ == "__main__":
    sys.exit(main())
