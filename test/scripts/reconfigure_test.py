#!/usr/bin/python3
"""rqt_reconfigure's way to the parameters of a running node, where dynamic_reconfigure is installed."""
import os
import re
import subprocess
import sys
import unittest

import roslib.packages
import rosunit
import rospy
from master_test_case import ROOT, MasterTest

from racecar_mcl_eval.ros_graph import end

try:
    from dynamic_reconfigure.client import Client
except ImportError:
    Client = None

# Need a restart of the node (docs/parameters.md).
FIXED = {"motion_from", "expert/clock_jump"}
NODE = {"transform_tolerance", "input_timeout", "visualization_rate", "diagnostics_rate", "obstacle_distance",
        "obstacle_min_returns"}


@unittest.skipUnless(Client, "dynamic_reconfigure is not installed")
class Reconfigure(MasterTest):
    def testOffersEveryParameterAndAppliesOrRefusesAChange(self):
        os.environ.update(self.environment)
        program = roslib.packages.find_node("racecar_mcl", "localization_node")[0]
        node = subprocess.Popen([program], env=self.environment, stdin=subprocess.DEVNULL,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(end, node)
        rospy.init_node("reconfigure_test", disable_signals=True)
        client = Client("localization", timeout=20)
        config = client.get_configuration(timeout=10)
        names = set(config) - {"groups"}
        file = (ROOT / "config/default.yaml").read_text(encoding="utf-8")
        registry = set(re.findall(r"^([\w/]+):", file, re.MULTILINE))
        self.assertEqual(names, (registry - FIXED) | NODE)
        described = {parameter["name"] for parameter in client.get_parameter_descriptions(timeout=10)}
        self.assertEqual(described, names)
        self.assertEqual(config["num_particles"], 200)
        self.assertIs(config["deskew"], True)

        changed = client.update_configuration({"num_particles": 300, "expert/range_bias": 0.01, "deskew": False,
                                               "sensor_model": "beam"})
        self.assertEqual((changed["num_particles"], changed["expert/range_bias"], changed["deskew"],
                          changed["sensor_model"]), (300, 0.01, False, "beam"))
        self.assertEqual(rospy.get_param("/localization/num_particles"), 300)

        refused = client.update_configuration({"num_particles": -5})
        self.assertEqual(refused["num_particles"], 300)
        self.assertEqual(rospy.get_param("/localization/num_particles"), 300)
        self.assertIsNone(node.poll())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "reconfigure_test", Reconfigure, sysargs=sys.argv)
