"""Launches after each other on one master."""
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from racecar_mcl_eval.ros_graph import end, environment, free_port

ROOT = Path(__file__).resolve().parents[2]
MAP = str(ROOT / "maps/corridor.yaml")


class MasterTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.port = free_port()
        self.environment = dict(environment(self.port, self.folder), ROSCONSOLE_STDOUT_LINE_BUFFERED="1")
        master = self.start("master", "roscore", "-p", str(self.port))
        self.addCleanup(end, master)
        self.waitFor(lambda: self.parameters("/") is not None, "the master did not start")

    def start(self, name, *command):
        with open(self.folder / f"{name}.log", "wb") as log:
            return subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=log,
                                    stderr=subprocess.STDOUT, start_new_session=True)

    def waitFor(self, holds, message):
        deadline = time.monotonic() + 30.0
        while not holds():
            self.assertLess(time.monotonic(), deadline, message)
            time.sleep(0.2)

    def parameters(self, namespace):
        """The names on the parameter server below `namespace`; None without a master."""
        result = subprocess.run(["rosparam", "list", namespace], env=self.environment, check=False,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        if result.returncode != 0:
            return None
        return {name[len(namespace):].lstrip("/") for name in result.stdout.decode().split()}

    def launch(self, name, file, expected, **arguments):
        """Launches until all of `expected` are in the log, reads the parameters, and ends the launch. Returns the
        log and the names of the parameters."""
        process = self.start(name, "roslaunch", "racecar_mcl", file,
                             *(f"{key}:={value}" for key, value in arguments.items()))
        log = self.folder / f"{name}.log"
        try:
            self.waitFor(lambda: all(words in log.read_text() for words in expected),
                         f"not in the log of {name}: {expected}")
            return log.read_text(), self.parameters("/")
        finally:
            end(process)
