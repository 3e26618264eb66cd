"""A ROS graph of one's own: a roslaunch with its roscore on a free port, ended whatever happens."""
import os
import signal
import socket
import subprocess
import time
from pathlib import Path

# roslaunch itself gives its nodes 15 s after SIGINT and 2 s after SIGTERM.
PATIENCE = 20.0  # s


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def children_of(pid):
    """The process ids below `pid`, grandchildren included."""
    parents = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text()
        except OSError:
            continue
        # "pid (name) state parent ...", where the name may hold spaces and brackets.
        parents[int(entry.name)] = int(stat.rpartition(")")[2].split()[1])
    below = [pid]
    for parent in below:
        below.extend(child for child, above in parents.items() if above == parent)
    return below[1:]


def environment(port, folder):
    """The variables of programs that belong to the roscore on `port` and log to `folder`."""
    variables = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1",
                     ROS_HOME=str(folder / "ros"))
    variables.pop("ROS_HOSTNAME", None)
    return variables


def end(process):
    """Asks a Popen and then makes it end."""
    for request in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        if process.poll() is not None:
            return
        process.send_signal(request)
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            continue


class RosGraph:
    """`with RosGraph(package, launch_file, arguments, folder) as graph:` runs it; logs go to `folder`."""

    def __init__(self, package, launch_file, arguments, folder):
        port = free_port()
        self.log = folder / "roslaunch.log"
        command = ["roslaunch", "--port", str(port), package, launch_file]
        command += [f"{name}:={value}" for name, value in arguments.items()]
        with open(self.log, "wb") as log:
            # Its own session: Ctrl-C reaches this program only, which then ends the graph in order.
            self.process = subprocess.Popen(command, env=environment(port, folder), stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=subprocess.STDOUT,
                                            start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def wait(self, seconds, tick=lambda elapsed: None):
        """True when the graph ended of itself within that time."""
        begin = time.monotonic()
        while self.process.poll() is None:
            elapsed = time.monotonic() - begin
            if elapsed > seconds:
                return False
            tick(elapsed)
            time.sleep(0.2)
        return True

    def stop(self):
        started = children_of(self.process.pid)
        end(self.process)
        if self.process.returncode != -signal.SIGKILL:
            return
        # A roslaunch that had to be killed has ended none of its nodes.
        for pid in started:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
