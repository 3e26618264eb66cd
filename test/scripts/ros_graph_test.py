#!/usr/bin/python3
"""A ROS graph leaves no processes behind."""
import os
import sys
import tempfile
import time
import unittest
from pathlib import Path

import rosunit

from racecar_mcl_eval.ros_graph import RosGraph, descendants_of


def alive(pid):
    try:
        # A zombie has ended.
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


class RosGraphLifetime(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def startGraph(self):
        return RosGraph("racecar_mcl", "localize.launch", {}, self.folder)

    def waitForNodes(self, graph):
        deadline = time.monotonic() + 30.0
        while time.monotonic() < deadline:
            started = descendants_of(graph.process.pid)
            # roscore's master, rosout, the manager and the localization nodelet
            if len(started) >= 4:
                return started
            time.sleep(0.1)
        self.fail(f"the graph did not come up: {graph.log.read_text()}")

    def testEndsAllProcessesAfterAnException(self):
        with self.assertRaises(KeyboardInterrupt):
            with self.startGraph() as graph:
                started = self.waitForNodes(graph)
                raise KeyboardInterrupt
        self.assertFalse([pid for pid in started + [graph.process.pid] if alive(pid)])

    def testWaitTimesOut(self):
        with self.startGraph() as graph:
            self.assertFalse(graph.wait(0.5))

    def testDescendantsIncludeGrandchildren(self):
        self.assertIn(os.getpid(), descendants_of(os.getppid()))
        self.assertNotIn(os.getpid(), descendants_of(os.getpid()))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "ros_graph_test", RosGraphLifetime, sysargs=sys.argv)
