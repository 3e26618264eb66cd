#!/usr/bin/python3
"""Checks an installed racecar_mcl: runs the simulated car with the localizer, without display, and checks status and
error of the localization. Prints one line, `passed: ...` or `failed: ...`; exit status 1 if failed."""
import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from nav_msgs.msg import Odometry
from std_msgs.msg import Float32
from racecar_mcl_eval.ros_graph import RosGraph

MAX_ERROR = 0.3  # m, of 95 % of the poses
MIN_POSES = 100
MIN_DISTANCE = 3.0  # m


class Drive:
    """What the topics report: the status, and since `start()` the errors (m) and the distance (m) of the car."""

    def __init__(self):
        self.localized = False
        self.start()
        self.subscribers = [rospy.Subscriber("pf/status", DiagnosticStatus, self.on_status),
                            rospy.Subscriber("error_monitor/position_error", Float32, self.on_error),
                            rospy.Subscriber("ground_truth/odom", Odometry, self.on_truth)]

    def start(self):
        self.errors, self.distance, self.stamp = [], 0.0, None

    def on_status(self, message):
        self.localized = message.level == DiagnosticStatus.OK

    def on_error(self, message):
        self.errors.append(message.data)

    def on_truth(self, message):
        stamp = message.header.stamp.to_sec()
        if self.stamp is not None:
            self.distance += abs(message.twist.twist.linear.x) * (stamp - self.stamp)
        self.stamp = stamp

    def summary(self):
        """Whether the car is localized, and the figures."""
        errors = sorted(self.errors) or [float("inf")]
        p95 = errors[int(0.95 * (len(errors) - 1))]
        passed = (self.localized and p95 <= MAX_ERROR and len(self.errors) >= MIN_POSES and
                  self.distance >= MIN_DISTANCE)
        return passed, (f"{'localized' if self.localized else 'not localized'}, position error p95 {100 * p95:.1f} cm "
                        f"of {len(self.errors)} poses over {self.distance:.1f} m")


def wait_until(holds, graph, seconds):
    """Waits until `holds()`, at most for `seconds`. False also if the graph ended before."""
    deadline = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > deadline or graph.wait(0.0):
            return False
    return True


def check(graph, options):
    """Whether the car was localized, and a description."""
    os.environ.update(graph.environment)
    if not wait_until(rosgraph.is_master_online, graph, options.timeout):
        return False, "no ROS master"
    rospy.init_node("localized_car", disable_signals=True)
    drive = Drive()
    if not wait_until(lambda: drive.localized, graph, options.timeout):
        return False, f"no status 'localized' within {options.timeout:.0f} s"
    drive.start()
    if graph.wait(options.duration):
        return False, "the launch has ended"
    return drive.summary()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--duration", type=float, default=20.0, metavar="S", help="how long the error is measured, s")
    parser.add_argument("--timeout", type=float, default=60.0, metavar="S", help="limit of each wait before that, s")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        with RosGraph("racecar_mcl", "simulate.launch", {"localize": "true"}, Path(folder)) as graph:
            passed, description = check(graph, options)
        if not passed:
            sys.stderr.write(graph.log.read_text(errors="replace"))
    print(f"{'passed' if passed else 'failed'}: {description}")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
