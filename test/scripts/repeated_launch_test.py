#!/usr/bin/python3
"""Launches on one master: none sees the parameters of the one before, and a good start warns of nothing."""
import subprocess
import sys

import rosunit
from master_test_case import MAP, MasterTest


class RepeatedLaunch(MasterTest):
    def testEachLaunchHasItsOwnParametersOnly(self):
        _, names = self.launch("first", "localize.launch", ["map of", "localizing from (-7.700 m"], map=MAP,
                               initial_pose="-7.7 -2.75 0", tf_mode="off")
        self.assertIn("localization/initial_pose", names)
        self.assertIn("localization/tf_mode", names)

        text, names = self.launch("second", "localize.launch", ["map of"], map=MAP)
        self.assertNotIn("localizing from", text)
        self.assertNotIn("localization/initial_pose", names)
        self.assertNotIn("localization/tf_mode", names)
        self.assertIn("localization/num_particles", names)

        subprocess.run(["rosparam", "set", "/simulator/wheelbase", "7"], env=self.environment, check=True)
        # With the first launch's initial_pose it would be refused.
        text, names = self.launch("third", "simulate.launch", ["localizing globally"], localize="true",
                                  global_start="true")
        self.assertNotIn("not localizing", text)
        self.assertIn("simulator/driver", names)
        self.assertNotIn("simulator/wheelbase", names)

    def testAGoodStartWarnsOfNothing(self):
        text, _ = self.launch("good", "simulate.launch", ["localizing from", "]: localized"], localize="true")
        self.assertNotIn("WARN", text)
        self.assertNotIn("ERROR", text)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "repeated_launch_test", RepeatedLaunch, sysargs=sys.argv)
