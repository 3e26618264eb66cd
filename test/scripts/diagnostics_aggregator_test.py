#!/usr/bin/python3
"""config/diagnostics_aggregator.yaml expects the diagnostics that localize.launch publishes."""
import subprocess
import sys

import rosunit
import yaml
from master_test_case import ROOT, MasterTest

from racecar_mcl_eval.ros_graph import end


class DiagnosticsAggregator(MasterTest):
    def publishedName(self):
        process = self.start("localization", "roslaunch", "racecar_mcl", "localize.launch")
        self.addCleanup(end, process)
        result = subprocess.run(["rostopic", "echo", "-n1", "/diagnostics"], env=self.environment, check=True,
                                timeout=60, stdout=subprocess.PIPE)
        return next(yaml.safe_load_all(result.stdout.decode()))["status"][0]["name"]

    def testExpectsThePublishedName(self):
        config = yaml.safe_load((ROOT / "config/diagnostics_aggregator.yaml").read_text(encoding="utf-8"))
        expected = [analyzer["expected"] for analyzer in config["analyzers"].values()]
        self.assertEqual(expected, [self.publishedName()])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "diagnostics_aggregator_test", DiagnosticsAggregator, sysargs=sys.argv)
