# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""A Slurm cluster of two nodes with one core each on the loopback interface, in a folder of its own.

No service, user or file outside of the folder is used: messages and credentials are not authenticated
(auth/none, cred/none), as on no cluster that others can reach.
"""
import ctypes
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

NODES = ("one", "two")
PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"
START_TIMEOUT = 30.0  # s
NODE_TIMEOUT = 5  # s without an answer, after which a node counts as lost
PR_SET_CHILD_SUBREAPER = 36

CONFIGURATION = """ClusterName=pcavr
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/none
CredType=cred/none
# A job whose node is lost starts again when its old credential has expired.
AuthInfo=cred_expire=3
SlurmctldPort={ports[0]}
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/%n.pid
SlurmdSpoolDir={folder}/spool-%n
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/controller.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,sched_min_interval=0,bf_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
SlurmdTimeout={node_timeout}
KillWait=1
ReturnToService=2
NodeName=one NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 RealMemory=4000
NodeName=two NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 RealMemory=4000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def is_installed():
    return all(shutil.which(program, path=PATH) for program in ("slurmctld", "slurmd", "sbatch", "squeue", "sinfo"))


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def adopt_orphans():
    """In the child: what slurmd starts, and detaches, stays below it, so that a node can be lost as a whole."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def descendants(pid):
    """A process and all below it."""
    found = [pid]
    for one in found:
        for children in pathlib.Path(f"/proc/{one}/task").glob("*/children"):
            try:
                found += [int(word) for word in children.read_text().split()]
            except OSError:
                continue
    return found


def kill_all(pid):
    """Stopped first, so that nothing new is started meanwhile."""
    for number in (signal.SIGSTOP, signal.SIGKILL):
        for one in descendants(pid):
            try:
                os.kill(one, number)
            except ProcessLookupError:
                continue


class Cluster:
    """To be used in a with statement, which ends what was started."""

    def __init__(self, folder, nodes=NODES):
        self.folder, self.names, self.processes = folder, nodes, {}
        folder.mkdir()
        (folder / "state").mkdir()
        host = socket.gethostname().split(".")[0]
        configuration = folder / "slurm.conf"
        user = subprocess.run(["id", "-un"], capture_output=True, text=True, check=True).stdout.strip()
        configuration.write_text(CONFIGURATION.format(host=host, user=user, folder=folder, ports=free_ports(3),
                                                      node_timeout=NODE_TIMEOUT))
        self.environment = {**os.environ, "PATH": PATH, "SLURM_CONF": str(configuration)}

    def __enter__(self):
        self.start_controller()
        for name in self.names:
            self.start_node(name)
        self.wait_for(lambda: self.states().count("idle") == len(self.names), START_TIMEOUT, "all nodes idle")
        return self

    def __exit__(self, *_):
        for name in list(self.processes):
            self.kill(name)

    def _start(self, name, words):
        with open(self.folder / f"{name}.out", "ab") as output:
            self.processes[name] = subprocess.Popen(words, env=self.environment, stdout=output, stderr=output,
                                                    stdin=subprocess.DEVNULL, preexec_fn=adopt_orphans)

    def start_controller(self):
        self._start("controller", ["slurmctld", "-D"])

    def start_node(self, name):
        self._start(name, ["slurmd", "-D", "-N", name])

    def kill(self, name):
        """SIGKILL: the controller, or a node with all that runs on it."""
        process = self.processes.pop(name)
        kill_all(process.pid)
        process.wait()

    def declare_lost(self, name):
        """As an administrator does: the node's jobs start again elsewhere at once, not after its timeout."""
        self.ask("scontrol", "update", f"NodeName={name}", "State=DOWN", "Reason=lost")

    def skip_requeue_delays(self):
        """Slurm starts a job of a lost node again after two minutes; here at once."""
        waiting = self.ask("squeue", "-h", "-t", "PENDING", "-o", "%i=%r")
        for job in [one.partition("=")[0] for one in waiting if one.endswith("=BeginTime")]:
            self.ask("scontrol", "update", f"JobId={job}", "StartTime=now")

    def ask(self, *words):
        return subprocess.run(words, env=self.environment, capture_output=True, text=True, check=False).stdout.split()

    def states(self):
        return self.ask("sinfo", "-h", "-N", "-o", "%T")

    def queue(self):
        """The jobs that have not ended, an array's waiting elements as one."""
        return self.ask("squeue", "-h", "-o", "%i")

    def wait_for(self, condition, timeout, what):
        end = time.monotonic() + timeout
        while not condition():
            if time.monotonic() > end:
                log = (self.folder / "controller.log").read_text()[-1500:]
                raise TimeoutError(f"no {what} in {timeout:.0f} s: {self.ask('squeue')}, {self.states()}\n{log}")
            time.sleep(0.1)
