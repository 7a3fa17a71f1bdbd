"""A test instance of Slurm with all its files in one folder, started and stopped with the tests."""

import os
import pathlib
import shutil
import socket
import subprocess
import time

CONF = """\
ClusterName=tests
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
SlurmctldPort={port}
SlurmdPort={next_port}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SwitchType=switch/none
MpiDefault=none
JobRequeue=1
KillWait=2
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""
DAEMONS = ("slurmd", "slurmctld", "munge")
PATIENCE = 60
# Variables that a test must not inherit from a job in which it runs.
FOREIGN = ("SLURM", "SBATCH", "PMI", "OMPI_COMM")


class Slurm:
    """Slurm in an empty folder. Needs root, munged, slurmctld and slurmd; no systemd and no cgroups."""

    def __init__(self, folder, cores=2):
        self.folder = pathlib.Path(folder)
        self.environment = {k: v for k, v in os.environ.items() if not k.startswith(FOREIGN)}
        self.environment["SLURM_CONF"] = str(self.folder / "slurm.conf")
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        port = free_ports()
        host = socket.gethostname().split(".")[0]
        values = {"host": host, "user": "root", "folder": self.folder, "cores": cores, "port": port, "next_port": port + 1}
        (self.folder / "slurm.conf").write_text(CONF.format(**values))

    def start(self):
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self.folder.chmod(0o755)  # Munge refuses folders that others can write to.
        files = {"key-file": key, "socket": "munge.socket", "pid-file": "munge.pid", "log-file": "munge.log", "seed-file": "seed"}
        options = [f"--{option}={self.folder / name}" for option, name in files.items()]
        self.call("munged", *options, "--num-threads=1", "--force")
        self.call("slurmctld", "-c", "-i")
        self.call("slurmd")
        self.wait(lambda: "idle" in self.call("sinfo", "-h", "-o", "%T"), "the node is not idle")

    def stop(self):
        """Cancels all jobs, and ends the daemons by their process ids."""
        self.call("scancel", "--user", "root", check=False)
        self.wait(lambda: not self.call("squeue", "-h", check=False), "a job does not end")
        for name in DAEMONS:
            path = self.folder / f"{name}.pid"
            process = int(path.read_text()) if path.exists() else None
            if process and is_alive(process):
                os.kill(process, 15)
                self.wait(lambda process=process: not is_alive(process), f"{name} does not end", patience=15)

    def call(self, *command, check=True):
        """Runs a command of Slurm's and returns what it prints."""
        done = subprocess.run(list(map(str, command)), env=self.environment, capture_output=True, text=True, timeout=PATIENCE)
        if check and done.returncode != 0:
            raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")
        return done.stdout

    def submit(self, *arguments, log):
        """Submits a job and returns its number."""
        return self.call("sbatch", "--parsable", f"--output={log}", *arguments).strip()

    def state(self, job):
        """The state of a job, as PENDING, RUNNING or COMPLETED."""
        return dict(field.split("=", 1) for field in self.call("scontrol", "-o", "show", "job", job).split() if "=" in field)["JobState"]

    def wait(self, condition, complaint, patience=PATIENCE):
        deadline = time.monotonic() + patience
        while not condition():
            if time.monotonic() > deadline:
                raise AssertionError(complaint() if callable(complaint) else complaint)
            time.sleep(0.05)


def is_installed():
    return all(map(shutil.which, ("munged", "slurmctld", "slurmd", "sbatch"))) and os.geteuid() == 0


def is_alive(process):
    """Whether a process is alive; a zombie is not."""
    try:
        return pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def free_ports():
    """The first of two ports in a row that are free."""
    for port in range(20000 + os.getpid() % 10000, 60000, 2):
        with socket.socket() as one, socket.socket() as other:
            try:
                one.bind(("127.0.0.1", port))
                other.bind(("127.0.0.1", port + 1))
                return port
            except OSError:
                continue
    raise AssertionError("no two ports in a row are free")
