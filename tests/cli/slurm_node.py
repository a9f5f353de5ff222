# SPDX-License-Identifier: Apache-2.0
"""One node of Slurm on this machine, with daemons of its own that end with it. Needs Debian's slurm-wlm and munge, and
root."""

import os
import pwd
import re
import shutil
import socket
import subprocess
import time
from pathlib import Path

PROGRAMS = ("slurmctld", "slurmd", "sbatch", "munged")
CONFIGURATION = """
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
JobRequeue=1
KillWait=30
BatchStartTimeout=120
MessageTimeout=60
Epilog={folder}/epilog.sh
MinJobAge=3600
MpiDefault=none
MailProg=/bin/true
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={memory} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def why_not():
    """Why there can be no node here; empty: there can."""
    for name in PROGRAMS:
        if shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin:/sbin") is None:
            return f"{name} is not installed (apt-get install slurm-wlm munge)"
    return "" if os.geteuid() == 0 else "the daemons need root"


def free_ports(count):
    """Different ones that nobody listens at."""
    taken = [socket.socket() for _ in range(count)]
    try:
        for one in taken:
            one.bind(("127.0.0.1", 0))
        return [one.getsockname()[1] for one in taken]
    finally:
        for one in taken:
            one.close()


class Node:
    def __init__(self, folder, cpus=2):
        self.folder = Path(folder)
        self.host = socket.gethostname().split(".")[0]
        self.cpus = cpus
        self.daemons = []
        self.waiting_since = {}
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf"),
                            "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}

    def __enter__(self):
        try:
            self.begin()
        except BaseException:
            self.__exit__()
            raise
        return self

    def begin(self):
        for name in ("state", "spool", "munge"):
            (self.folder / name).mkdir(parents=True)
        with open("/proc/meminfo", encoding="ascii") as file:
            memory_mib = int(file.readline().split()[1]) // 1024 * 9 // 10
        # Nodes clean up after a task, which is neither running nor waiting meanwhile. Here that takes as long as elsewhere.
        epilog = self.folder / "epilog.sh"
        epilog.write_text("#!/bin/sh\nsleep 3\n")
        epilog.chmod(0o755)
        port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=self.host, folder=self.folder, port=port, node_port=node_port, cpus=self.cpus, memory=memory_mib))
        self.start_munge()
        self.start("slurmctld", "-D", "-f", self.folder / "slurm.conf")
        self.start("slurmd", "-D", "-f", self.folder / "slurm.conf", "-N", self.host)
        self.wait_for(lambda: "idle" in self.run("sinfo", "-h", "-o", "%t"), 120, "the node is not idle")

    def start_munge(self):
        munge = self.folder / "munge"
        (munge / "key").write_bytes(os.urandom(128))
        (munge / "key").chmod(0o400)
        account = pwd.getpwnam("munge")
        for path in (munge, munge / "key"):
            shutil.chown(path, account.pw_uid, account.pw_gid)
        munge.chmod(0o755)
        for at in (self.folder, self.folder.parent):  # both are of this test, and munged runs as another user
            at.chmod(0o755)
        self.start("munged", "--foreground", "--force", f"--key-file={munge}/key", f"--socket={munge}/socket",
                   f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed",
                   user="munge")
        self.wait_for(lambda: (munge / "socket").exists(), 20, "munged does not answer")

    def start(self, *arguments, user=None):
        with open(self.folder / f"{arguments[0]}.out", "ab") as out:
            self.daemons.append(subprocess.Popen([str(word) for word in arguments], stdout=out, stderr=out,
                                                 env=self.environment, user=user))

    def __exit__(self, *_):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def run(self, *arguments):
        done = subprocess.run([str(word) for word in arguments], capture_output=True, text=True, env=self.environment, check=False)
        return done.stdout + done.stderr

    def jobs(self):
        """Number of each task in the queue -> state. A controller that is busy is asked again."""
        for _ in range(30):
            told = subprocess.run(["squeue", "-h", "-r", "-o", "%i %T %r"], capture_output=True, text=True, env=self.environment,
                                  check=False)
            if told.returncode == 0:
                return {words[0]: words[1:] for words in (line.split() for line in told.stdout.splitlines())}
            time.sleep(2)
        raise TimeoutError(f"squeue does not answer: {told.stderr}")

    def begin_soon(self):
        """A requeued task need not wait for its two minutes, but for three seconds: slurmd knows by the second when it
        ended a job, and takes one that begins again within that second for the ended one. Such a task fails without
        having begun, and Slurm cancels what depends on it."""
        waiting = [job for job, state in self.jobs().items() if state[0] == "PENDING" and state[1] == "BeginTime"]
        now = time.monotonic()
        self.waiting_since = {job: self.waiting_since.get(job, now) for job in waiting}
        for job, since in self.waiting_since.items():
            if now - since > 3:
                self.run("scontrol", "update", f"JobId={job}", "StartTime=now")

    def restarts(self, job):
        """How often each task of an array was put back into the queue, by its index."""
        told = self.run("scontrol", "show", "job", job)
        return {int(index): int(count) for index, count in re.findall(r"ArrayTaskId=(\d+) .*?Restarts=(\d+)", told, re.DOTALL)}

    def wait_for(self, condition, seconds, complaint):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                logs = "\n".join(path.read_text(errors="replace")[-2000:] for path in self.folder.glob("*.log"))
                raise TimeoutError(f"{complaint}\n{logs}")
            time.sleep(0.2)
