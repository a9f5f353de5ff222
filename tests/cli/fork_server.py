# SPDX-License-Identifier: Apache-2.0
"""Runs the program as subprocess.run() does, by a fork of one that has loaded its libraries already (fork_server.cpp).
One run at a time. Runs that are sent signals, have limits or read from stdin are started for themselves, without this."""

import atexit
import os
import signal
import socket
import struct
import subprocess
import tempfile
from pathlib import Path


class ForkServer:
    def __init__(self, program, preloaded):
        self.program = str(program)
        self.ours, theirs = socket.socketpair()
        environment = {**os.environ, "LD_PRELOAD": preloaded, "GAZETRACE_FORK_SERVER_SOCKET": str(theirs.fileno())}
        self.server = subprocess.Popen([program], env=environment, pass_fds=[theirs.fileno()])
        theirs.close()
        atexit.register(self.close)

    def close(self):
        self.ours.close()
        self.server.wait()

    def run(self, arguments, folder, environment, timeout):
        variables = [f"{name}={value}" for name, value in environment.items()]
        texts = [str(Path(folder)), str(len(arguments) + 1), self.program, *map(str, arguments), *variables]
        request = b"".join(text.encode(errors="surrogateescape") + b"\0" for text in texts)
        with tempfile.TemporaryFile() as stdout, tempfile.TemporaryFile() as stderr:
            socket.send_fds(self.ours, [struct.pack("I", len(request))], [stdout.fileno(), stderr.fileno()])
            self.ours.sendall(request)
            child = self.number()
            self.ours.settimeout(timeout)
            try:
                code = os.waitstatus_to_exitcode(self.number())
            except TimeoutError:
                os.kill(child, signal.SIGKILL)
                self.ours.settimeout(None)
                self.number()
                raise subprocess.TimeoutExpired([self.program, *arguments], timeout) from None
            finally:
                self.ours.settimeout(None)
            stdout.seek(0)
            stderr.seek(0)
            return subprocess.CompletedProcess([self.program, *arguments], code, stdout.read(), stderr.read())

    def number(self):
        return struct.unpack("i", self.ours.recv(4, socket.MSG_WAITALL))[0]
