"""The job arrays of plenoflame submit under a real Slurm: two nodes on this machine, with a munge of their own. Ends with 77,
which skips the test, where they are not installed (tools/setup.sh slurm) or cannot be started."""

import os
import pathlib
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import command
from command import CommandTest, main

SCENE = """[camera]
preset = "paper-plenoptic2"
[[flames]]
preset = "paper-layered"
position = ["1 m", "0 m", "-29 mm"]
"""
WINDOW = "--window 1400,1400,200,128"
# Some ten seconds of a node: what is to end it finds it under way.
LONG = "--samples 4096 --window 1300,1300,800,512"
CONFIGURATION = """ClusterName=plenoflame
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={control}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
KillWait=60
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=one NodeHostname={host} NodeAddr=127.0.0.1 Port={one} CPUs=2 State=UNKNOWN
NodeName=two NodeHostname={host} NodeAddr=127.0.0.1 Port={two} CPUs=2 State=UNKNOWN
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


def skip(why):
    print(f"skipped: {why}")
    sys.exit(77)


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class Cluster:
    """munged, slurmctld and two slurmd in a folder of their own."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="plenoflame-slurm-"))
        os.chmod(self.folder, 0o755)
        (self.folder / "state").mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o600)
        control, one, two = free_ports(3)
        host = socket.gethostname().split(".")[0]
        configuration = self.folder / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(host=host, folder=self.folder, control=control, one=one, two=two,
                                                      user="root"))
        self.environment = {**os.environ, "SLURM_CONF": str(configuration), "PLENOFLAME": command.COMMAND}
        self.processes = []
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                   f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log",
                   f"--seed-file={self.folder}/munged.seed")
        self.wait_for(lambda: (self.folder / "munge.socket").exists(), "munged")
        self.start("slurmctld", "-D")
        for node in ("one", "two"):
            self.start("slurmd", "-D", "-N", node)
        self.wait_for(lambda: self.said("sinfo", "--noheader", "--format=%T").split() == ["idle"], "idle nodes")

    def start(self, *words):
        output = open(self.folder / f"{words[0]}-{len(self.processes)}.out", "wb")
        self.processes.append(subprocess.Popen(words, env=self.environment, stdin=subprocess.DEVNULL, stdout=output,
                                               stderr=subprocess.STDOUT))
        output.close()

    def said(self, *words, folder=None):
        return subprocess.run(words, env=self.environment, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False).stdout

    def wait_for(self, condition, what, most=120):
        end = time.monotonic() + most
        while not condition():
            if time.monotonic() > end or any(p.poll() is not None for p in self.processes):
                logs = "".join(f"--- {log.name}\n{log.read_text(errors='replace')[-600:]}\n"
                               for log in sorted([*self.folder.glob("*.log"), *self.folder.glob("*.out")]))
                raise TimeoutError(f"waited in vain for {what}\n{logs}")
            time.sleep(0.2)

    def stop(self):
        for process in reversed(self.processes):
            process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
        shutil.rmtree(self.folder, ignore_errors=True)


class Slurm(CommandTest):
    @classmethod
    def setUpClass(cls):
        try:
            cls.cluster = Cluster()
        except (TimeoutError, PermissionError) as error:
            skip(f"no cluster: {error}")
        cls.addClassCleanup(cls.cluster.stop)

    def setUp(self):
        super().setUp()
        os.chmod(self.folder, 0o755)
        self.write("flame.toml", SCENE)

    def submit(self, *arguments):
        """The lines that the command prints, run by a shell; the numbers of the jobs."""
        lines = self.succeeds("submit", "--slurm", "flame.toml", *arguments, "-o", "jobs.sbatch")
        said = self.cluster.said("bash", "-ec", lines + 'echo "array=${job:-}"\n', folder=self.folder)
        jobs = re.findall(r"Submitted batch job (\d+)|array=(\d+)", said)
        self.assertTrue(jobs, said)
        return [one or other for one, other in jobs]

    def state(self, job):
        return self.cluster.said("squeue", "--noheader", "--states=all", "--array", "--format=%T", f"--jobs={job}").split()

    def wait_until(self, job, *states, most=600):
        self.cluster.wait_for(lambda: set(self.state(job)) <= set(states) and self.state(job), f"{job} to be {states}", most)

    def logs(self):
        return "".join(pathlib.Path(self.path(name)).read_text() for name in self.files() if name.endswith((".log", ".out")))

    def test_a_job_array_makes_the_bits_of_one_run(self):
        merge, array = self.submit("--parts", "4", "--time", "10m", "--options", f"--samples 8 {WINDOW}")
        self.wait_until(array, "COMPLETED")
        self.wait_until(merge, "COMPLETED")
        self.succeeds("render", "flame.toml", "-o", "alone.exr", "--samples", "8", *WINDOW.split(), "--quiet")
        self.assertEqual(self.read("flame.exr"), self.read("alone.exr"), self.logs())

    def long_task(self, options, *limit):
        """A task of one picture that is under way, with a state; its job."""
        job, = self.submit(*limit, "--options", f"{options} --checkpoint 1s")
        self.cluster.wait_for(lambda: os.path.exists(self.path("flame.exr.state")), "the task's state")
        return job

    def test_a_task_that_is_begun_anew_goes_on(self):
        job = self.long_task(LONG)
        self.cluster.said("scontrol", "requeue", job)  # ends the task, and puts it into the queue again
        self.wait_until(job, "PENDING")
        self.assertTrue(os.path.exists(self.path("flame.exr.state")))
        self.cluster.said("scontrol", "update", f"jobid={job}", "StartTime=now")
        self.wait_until(job, "COMPLETED", most=1500)
        self.succeeds("render", "flame.toml", "-o", "alone.exr", *LONG.split(), "--quiet")
        self.assertEqual(self.read("flame.exr"), self.read("alone.exr"), self.logs())
        self.assertFalse(os.path.exists(self.path("flame.exr.state")))

    def kill(self):
        """Ends the task as a lack of memory would: Slurm itself asks by SIGTERM first."""
        pids = self.cluster.said("pgrep", "-f", "plenoflame render").split()
        ours = [pid for pid in pids if os.path.realpath(f"/proc/{pid}/cwd") == os.path.realpath(self.folder)]
        self.assertTrue(ours, pids)
        for pid in ours:
            os.kill(int(pid), signal.SIGKILL)

    def test_a_task_that_was_killed_goes_on(self):
        job = self.long_task(LONG)
        self.kill()
        self.wait_until(job, "FAILED", "CANCELLED")
        self.assertFalse(os.path.exists(self.path("flame.exr")))
        job = re.search(r"\d+", self.cluster.said("sbatch", "--parsable", "jobs.sbatch", folder=self.folder))[0]
        self.wait_until(job, "COMPLETED", most=1500)
        self.succeeds("render", "flame.toml", "-o", "alone.exr", *LONG.split(), "--quiet")
        self.assertEqual(self.read("flame.exr"), self.read("alone.exr"), self.logs())

    def test_the_time_limit_keeps_what_was_rendered(self):
        job = self.long_task("--samples 16384", "--time", "0-00:01:00")
        self.wait_until(job, "TIMEOUT", "COMPLETING", most=400)
        self.wait_until(job, "TIMEOUT")
        self.assertIn("stopped; flame.exr holds the rendered part, marked partial", self.logs())
        self.assertIn("TIME LIMIT", self.logs())
        figures = self.json_of("info", "flame.exr")
        self.assertIs(figures["complete"], False)
        self.assertGreater(figures["channels"][0]["total_W"], 0)
        # The same script goes on from there.
        job = re.search(r"\d+", self.cluster.said("sbatch", "--parsable", "jobs.sbatch", folder=self.folder))[0]
        self.wait_until(job, "RUNNING")
        time.sleep(5)
        self.cluster.said("scancel", "--signal=TERM", "--full", job)
        self.wait_until(job, "FAILED", "CANCELLED", "COMPLETED")
        again = self.json_of("info", "flame.exr")
        self.assertGreater(again["samples"], 0)
        self.assertEqual(again["numbers"]["render.replicates"], figures["numbers"]["render.replicates"])


if __name__ == "__main__":
    for program in ("munged", "slurmctld", "slurmd", "sbatch"):
        if shutil.which(program) is None:
            skip(f"there is no {program} (tools/setup.sh slurm)")
    if os.geteuid() != 0:
        skip("nodes are started by root")
    main()
