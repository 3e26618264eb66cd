"""A private ROS graph: roslaunch with a roscore on a free port, shut down on every exit path."""
import contextlib
import os
import random
import signal
import socket
import subprocess
import time
from pathlib import Path

from . import EvaluationError

START_UP = 30.0  # s, limit for the start of roscore
# roslaunch waits for its nodes for 15 s after SIGINT and 2 s after SIGTERM.
END_TIMEOUT = 20.0  # s
SERVER_PORTS = range(20000, 32000)  # Linux gives clients ports from 32768 on


def free_port():
    """A free TCP port for a roscore. It is below those that the system gives to clients, any of which may take a port
    of theirs before the roscore does."""
    for port in random.SystemRandom().sample(SERVER_PORTS, 100):
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
                return port
            except OSError:
                continue
    raise EvaluationError(f"no free port between {SERVER_PORTS[0]} and {SERVER_PORTS[-1]}")


def descendants_of(pid):
    """The process ids of all descendants of `pid`."""
    parents = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text()
        except OSError:
            continue
        # "pid (name) state parent ...", where the name may contain spaces and parentheses.
        parents[int(entry.name)] = int(stat.rpartition(")")[2].split()[1])
    below = [pid]
    for parent in below:
        below.extend(child for child, above in parents.items() if above == parent)
    return below[1:]


def environment(port, folder):
    """The environment of programs that use the roscore on `port` and log to `folder`."""
    variables = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1",
                     ROS_HOME=str(folder / "ros"))
    variables.pop("ROS_HOSTNAME", None)
    return variables


def end(process):
    """Ends a Popen: SIGINT, then SIGTERM, then SIGKILL."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        if process.poll() is not None:
            return
        process.send_signal(number)
        try:
            process.wait(END_TIMEOUT)
        except subprocess.TimeoutExpired:
            continue


@contextlib.contextmanager
def running(words, environment, log):
    """Runs a program in its own session; ends it on every exit path."""
    process = subprocess.Popen([str(word) for word in words], env=environment, stdout=log, stderr=subprocess.STDOUT,
                               stdin=subprocess.DEVNULL, start_new_session=True)
    try:
        yield process
    finally:
        end(process)


def wait_for_master(port):
    until = time.monotonic() + START_UP
    while time.monotonic() < until:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
            return
        time.sleep(0.05)
    raise EvaluationError(f"roscore did not come up on port {port} within {START_UP:.0f} s")


class RosGraph:
    """Context manager that runs a launch file; logs go to `folder`. `environment` is that of its programs."""

    def __init__(self, package, launch_file, arguments, folder):
        port = free_port()
        self.environment = environment(port, folder)
        self.log = folder / "roslaunch.log"
        command = ["roslaunch", "--port", str(port), package, launch_file]
        command += [f"{name}:={value}" for name, value in arguments.items()]
        with open(self.log, "wb") as log:
            # In its own session: Ctrl-C reaches only this program, which then shuts the graph down.
            self.process = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=subprocess.STDOUT,
                                            start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def wait(self, seconds, tick=lambda elapsed: None):
        """True if the graph ended by itself within `seconds`. Calls `tick` with the elapsed time."""
        begin = time.monotonic()
        while self.process.poll() is None:
            elapsed = time.monotonic() - begin
            if elapsed > seconds:
                return False
            tick(elapsed)
            time.sleep(0.2)
        return True

    def stop(self):
        started = descendants_of(self.process.pid)
        end(self.process)
        if self.process.returncode != -signal.SIGKILL:
            return
        # A killed roslaunch leaves its nodes running.
        for pid in started:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
