#!/usr/bin/python3
"""Parameter files of other localizers: compat of localize.launch, and translate_parameters."""
import importlib.machinery
import importlib.util
import re
import subprocess
import sys
import unittest
from pathlib import Path

import roslib.packages
import rosunit
import yaml
from master_test_case import MAP, ROOT, MasterTest

from racecar_mcl_eval.ros_graph import end

FOREIGN = ROOT / "test/data/foreign"


def translate(*arguments):
    program = roslib.packages.find_node("racecar_mcl", "translate_parameters")[0]
    return subprocess.run([program, *map(str, arguments)], check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)


def checked_compat():
    loader = importlib.machinery.SourceFileLoader("checked_compat", str(ROOT / "nodes/checked_compat"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class LaunchFile(unittest.TestCase):
    """The launch file of a command line, as roslaunch finds it: in a package first."""

    def testIsCheckedIfItIsOneOfThisPackage(self):
        launched = checked_compat().launched
        folder, elsewhere = ROOT / "launch", Path("/")
        command = ["/usr/bin/python3", "/usr/bin/roslaunch"]
        for words, place, expected in (
                (["racecar_mcl", "localize.launch", "a:=1"], elsewhere, "localize.launch"),
                (["racecar_mcl", "localize.launch"], folder, "localize.launch"),
                (["-p", "11311", str(folder / "localize.launch")], elsewhere, "localize.launch"),
                (["localize.launch"], folder, "localize.launch"),
                (["compat/mit_pf.launch"], folder, "mit_pf.launch"),
                (["localize.launch"], elsewhere, None),
                (["other_car", "localize.launch"], elsewhere, None),
                (["other_car", "localize.launch"], folder, None),
                (["localize.launch", "map.launch"], folder, None),
                ([], folder, None)):
            with self.subTest(words=words, place=place):
                self.assertEqual(launched(command + words, folder, place), expected)


class Compat(MasterTest):
    def testFilesOfOthersWorkUnchanged(self):
        for origin, file, expected in (("amcl", "amcl.yaml", "localizing from (-7.700 m, -2.750 m"),
                                       ("lab5", "lab5_params.yaml", "map_topic: remap map"),
                                       ("mit_pf", "mit_pf_flat.yaml", "viz: if there are subscribers")):
            with self.subTest(origin=origin):
                if file.endswith("_flat.yaml"):
                    nested = yaml.safe_load((FOREIGN / "mit_pf.yaml").read_text(encoding="utf-8"))
                    path = self.folder / file
                    path.write_text(yaml.dump(nested["particle_filter"]), encoding="utf-8")
                else:
                    path = FOREIGN / file
                text, names = self.launch(origin, "localize.launch", ["map of", expected], map=MAP, config=path,
                                          compat=origin)
                self.assertNotIn("not localizing", text)
                self.assertIn("localization/compat", names)

    def testWithoutCompatAllForeignNamesAreNamedAtOnce(self):
        text, _ = self.launch("without", "localize.launch", ["not localizing"], map=MAP, config=FOREIGN / "amcl.yaml")
        self.assertIn("'odom_alpha1'; that of amcl is 'expert/rotation_noise_from_rotation' here", text)
        self.assertIn("'base_frame_id'; that of amcl is 'particle_filter_frame' here", text)
        self.assertIn("'update_min_d'; that of amcl has no counterpart: every scan is used", text)

    def testTranslatedFilesAreConfigs(self):
        for file in ("amcl.yaml", "lab5_params.yaml", "mit_pf.yaml"):
            with self.subTest(file=file):
                result = translate(FOREIGN / file)
                self.assertEqual(result.returncode, 0, result.stderr)
                path = self.folder / file
                path.write_text(result.stdout, encoding="utf-8")
                text, _ = self.launch(file, "localize.launch", ["map of"], map=MAP, config=path)
                self.assertNotIn("not localizing", text)

    def testMitsLaunchArgumentsWorkUnchanged(self):
        text, names = self.launch("arguments", "mit_pf.launch",
                                  ["map of", "viz: if there are subscribers", "/scan -> /lidar", "/odom -> /wheels"],
                                  map=MAP, scan_topic="/lidar", odometry_topic="/wheels", angle_step=27,
                                  max_particles=1500, viz=1, range_method="rm")
        self.assertNotIn("not localizing", text)
        self.assertNotIn("fine_timing", text)
        self.assertLessEqual({f"localization/{name}" for name in ("max_particles", "angle_step", "z_hit")}, names)

    def testACarsLaunchFileMayIncludeMits(self):
        path = self.folder / "localize.launch"  # as one of this package, which has other arguments
        path.write_text("""<launch>
            <include file="$(find racecar_mcl)/launch/simulate.launch"/>
            <include file="$(find racecar_mcl)/launch/compat/mit_pf.launch">
              <arg name="scan_topic" value="/scan"/>
              <arg name="odometry_topic" value="/vesc/odom"/>
              <arg name="angle_step" value="27"/>
              <arg name="max_particles" value="1500"/>
              <arg name="tf_mode" value="map_to_odom"/>
            </include>
          </launch>""", encoding="utf-8")
        self.addCleanup(end, self.start("car", "roslaunch", str(path), "unrelated:=1"))
        wanted = {"status": "localized", "particles": "1500", "beams": "40"}
        self.waitFor(lambda: wanted.items() <= self.diagnostics().items(), f"the localizer does not report {wanted}")

    def diagnostics(self):
        """Keys and values of a message on /diagnostics; empty if none arrives."""
        try:
            result = subprocess.run(["rostopic", "echo", "-n1", "/diagnostics"], env=self.environment, check=False,
                                    timeout=10, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            return {}
        return dict(re.findall(r'key: "(.*)"\s+value: "(.*)"', result.stdout.decode()))

    def testUnknownArgumentsAreNamed(self):
        mine, localize = "mit_pf.launch has no argument", "localize.launch has no argument"
        for name, file, arguments, expected in (
                ("typo", "mit_pf.launch", {"angle_stp": 9}, f"{mine} 'angle_stp'; did you mean 'angle_step'?"),
                ("unknown", "mit_pf.launch", {"torque": 9}, f"{mine} 'torque'; --ros-args lists its arguments"),
                ("other", "localize.launch", {"angle_step": 9, "compat": "mit_pf"},
                 f"{localize} 'angle_step'; it is one of mit_pf.launch")):
            with self.subTest(name):
                text, _ = self.launch(name, file, [expected, "RLException"], map=MAP, **arguments)
                self.assertEqual(text.count("has no argument"), 1)

    def testTranslationNamesWhatIsWrong(self):
        path = self.folder / "wrong.yaml"
        path.write_text("laser_model_type: sonar\n", encoding="utf-8")
        self.assertIn("laser_model_type is 'sonar'", translate(path).stderr)
        path.write_text("speed: 3\n", encoding="utf-8")
        self.assertIn("no parameter of amcl, lab5 or mit_pf", translate(path).stderr)
        self.assertIn("cannot be read", translate(self.folder / "none.yaml").stderr)
        self.assertIn("one of amcl lab5 mit_pf", translate(FOREIGN / "amcl.yaml", "--from", "nav2").stderr)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "compat_test", __name__, sysargs=sys.argv)
