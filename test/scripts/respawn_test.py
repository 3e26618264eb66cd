#!/usr/bin/python3
"""A localization node that is killed at speed continues from its last pose."""
import math
import os
import signal
import subprocess
import sys
import time

import roslib.packages
import rosunit
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from master_test_case import MasterTest
from nav_msgs.msg import Odometry

from racecar_mcl_eval.ros_graph import end


def program(name):
    return roslib.packages.find_node("racecar_mcl", name)[0]


class Respawn(MasterTest):
    def setUp(self):
        super().setUp()
        os.environ.update(self.environment)
        self.truth = self.pose = self.status = None
        simulation = self.start("simulation", "roslaunch", "racecar_mcl", "simulate.launch", "global_start:=true")
        self.addCleanup(end, simulation)

    def onTruth(self, message):
        self.truth = message.pose.pose.position

    def onPose(self, message):
        self.pose = message.pose.pose.position

    def onStatus(self, message):
        self.status = message.message

    def startNode(self):
        file = self.folder / "last_pose.yaml"
        return subprocess.Popen(
            [program("localization_node"), "scan:=/scan", "odom:=/vesc/odom", "_tf_mode:=map_to_odom",
             "_initial_pose:=-7.8 -2.65 0", f"_last_pose_file:={file}"],
            env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def error(self):
        return math.hypot(self.pose.x - self.truth.x, self.pose.y - self.truth.y)

    def testAKilledNodeIsBackAtSpeed(self):
        rospy.init_node("respawn_test", disable_signals=True)
        rospy.Subscriber("/ground_truth/odom", Odometry, self.onTruth)
        rospy.Subscriber("/pf/pose/odom", Odometry, self.onPose)
        rospy.Subscriber("/pf/status", DiagnosticStatus, self.onStatus)
        node = self.startNode()
        try:
            self.waitFor(lambda: self.status == "localized", "not localized")
            start = self.truth
            self.waitFor(lambda: math.hypot(self.truth.x - start.x, self.truth.y - start.y) > 5.0, "does not drive")
            self.assertLess(self.error(), 0.5)
            for _ in range(3):
                node.send_signal(signal.SIGKILL)
                node.wait()
                self.status = self.pose = None
                killed = time.monotonic()
                node = self.startNode()
                self.waitFor(lambda: self.status == "localized", "not localized again")
                seconds = time.monotonic() - killed
                print(f"localized again after {seconds:.1f} s")
                # A second, and the time of the process on a busy machine.
                self.assertLess(seconds, 4.0)
                time.sleep(1.5)
                self.assertLess(self.error(), 0.5)
                self.assertEqual(self.status, "localized")
        finally:
            end(node)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "respawn_test", Respawn, sysargs=sys.argv)
