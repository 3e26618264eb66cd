#!/usr/bin/python3
"""Every launch file loads with its arguments and starts existing programs."""
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import roslaunch.config
import roslaunch.xmlloader
import roslib.packages
import rosbag
import rosunit
import rospy
import yaml
from geometry_msgs.msg import TransformStamped
from tf2_msgs.msg import TFMessage

ROOT = Path(__file__).resolve().parents[2]
LAUNCH = ROOT / "launch"
MAP = str(ROOT / "maps/corridor.yaml")


def write_bag(path, child):
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = "odom"
    with rosbag.Bag(str(path), "w") as bag:
        bag.write("/tf", TFMessage([transform]), rospy.Time(1))


def load(name, **arguments):
    config = roslaunch.config.ROSLaunchConfig()
    argv = [f"{key}:={value}" for key, value in arguments.items()]
    roslaunch.xmlloader.XmlLoader().load(str(LAUNCH / name), config, argv=argv, verbose=False)
    return config


def arguments(name):
    return {argument.get("name") for argument in ElementTree.parse(LAUNCH / name).findall("arg")
            if argument.get("value") is None}


def nodes(config):
    return {node.name: node for node in config.nodes}


def parameter(config, name):
    return config.params[name].value if name in config.params else None


class LaunchFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.bag = self.folder / "a drive.bag"
        write_bag(self.bag, "base_link")

    def everyConfig(self):
        yield load("localize.launch")
        yield load("localize.launch", map=MAP, rviz="true", tf_mode="off", initial_pose="1 2 0.5",
                   global_start="false", scan_topic="/lidar", odom_topic="/wheels")
        yield load("localize.launch", manager="somebodys_manager")
        yield load("replay_bag.launch", bag=self.bag, map=MAP, rviz="true", loop="true", rate="2")
        yield load("replay_bag.launch", bag=self.bag, tf_mode="map_to_base")
        yield load("demo.launch", bag=self.bag, map=MAP, record=self.folder / "out.bag")
        yield load("record.launch")
        yield load("compat/mit_pf.launch", map=MAP, viz="1", rviz="true")
        yield load("simulate.launch")
        yield load("simulate.launch", localize="true", rviz="true", map="track", odom_tf="false")

    def testEveryFileIsLoadedHere(self):
        here = set(re.findall(r"[a-z_]+\.launch", Path(__file__).read_text(encoding="utf-8")))
        for file in LAUNCH.rglob("*.launch"):
            self.assertIn(file.name, here)

    def testEveryArgumentIsDocumented(self):
        for file in LAUNCH.rglob("*.launch"):
            for argument in ElementTree.parse(file).getroot().findall("arg"):
                if argument.get("value") is None:
                    self.assertTrue(argument.get("doc"), f"{file.name}: {argument.get('name')}")

    def testEveryProgramExists(self):
        programs = {(node.package, node.type)
                    for config in self.everyConfig() for node in config.nodes}
        for package, program in programs:
            self.assertTrue(roslib.packages.find_node(package, program), f"{package}/{program}")

    def testEveryNodeletIsAPlugin(self):
        plugins = {plugin.get("name")
                   for plugin in ElementTree.parse(ROOT / "nodelet_plugins.xml").iter("class")}
        for config in self.everyConfig():
            for node in config.nodes:
                words = node.args.split()
                if node.package == "nodelet" and words[0] == "load":
                    self.assertIn(words[1], plugins)

    def testEveryFileNamedInThemExists(self):
        for config in self.everyConfig():
            for node in config.nodes:
                for path in re.findall(r"-d (\S+)", node.args):
                    self.assertTrue(Path(path).exists(), path)

    def testStartsAMapServerOnlyIfAMapIsGiven(self):
        self.assertNotIn("map_source", nodes(load("localize.launch")))
        self.assertIn("map_source", nodes(load("localize.launch", map=MAP)))

    def testLoadsIntoARunningManager(self):
        alone = nodes(load("localize.launch", map=MAP))
        self.assertIn("localization_manager", alone)
        shared = nodes(load("localize.launch", map=MAP, manager="car_manager"))
        self.assertNotIn("localization_manager", shared)
        for name in ("localization", "map_source"):
            self.assertTrue(shared[name].args.endswith(" car_manager"))

    def testRemapsTheCarsTopics(self):
        remaps = dict(nodes(load("localize.launch", odom_topic="/wheels"))["localization"].remap_args)
        self.assertEqual(remaps["scan"], "/scan")
        self.assertEqual(remaps["odom"], "/wheels")

    def testSeveralScanTopicsAreAParameter(self):
        self.assertIsNone(parameter(load("localize.launch"), "/localization/scan_topics"))
        config = load("localize.launch", scan_topic="/front /rear")
        self.assertEqual(parameter(config, "/localization/scan_topics"), "/front /rear")
        config = load("replay_bag.launch", bag=self.bag, scan_topic="/front /rear")
        self.assertEqual(parameter(config, "/localization/scan_topics"), "/front /rear")

    def testTheRearLidarOfTheSimulatedCarIsUsed(self):
        config = load("simulate.launch", localize="true", rear_lidar="true")
        self.assertTrue(parameter(config, "/simulator/rear_lidar"))
        self.assertEqual(parameter(config, "/localization/scan_topics"), "/scan /scan_rear")

    def testArgumentsOverrideTheConfigAndEmptyOnesDoNot(self):
        mine = self.folder / "mine.yaml"
        mine.write_text("tf_mode: map_to_odom\nnum_particles: 321\n", encoding="utf-8")
        config = load("localize.launch", config=mine)
        self.assertEqual(parameter(config, "/localization/tf_mode"), "map_to_odom")
        self.assertEqual(parameter(config, "/localization/num_particles"), 321)
        self.assertIsNone(parameter(config, "/localization/initial_pose"))
        config = load("localize.launch", config=mine, tf_mode="off", motion_from="tf",
                      initial_pose="1 2 3")
        self.assertEqual(parameter(config, "/localization/tf_mode"), "off")
        self.assertEqual(parameter(config, "/localization/motion_from"), "tf")
        self.assertEqual(parameter(config, "/localization/initial_pose"), "1 2 3")

    def testReplayHasTheArgumentsOfLocalizeExceptThoseOfACar(self):
        self.assertLessEqual(arguments("localize.launch") - {"manager", "last_pose_file", "respawn"}, arguments("replay_bag.launch"))
        config = load("replay_bag.launch", bag=self.bag, map=MAP, motion_from="tf")
        self.assertEqual(parameter(config, "/localization/motion_from"), "tf")

    def testMitsLaunchHasEveryParameterOfMitAndTheArgumentsOfLocalize(self):
        table = (ROOT / "src/core/localizer/foreign_parameter_table.cpp").read_text(encoding="utf-8")
        foreign = set(re.findall(r'\{"mit_pf", "(\w+)"', table))
        self.assertIn("max_particles", foreign)
        self.assertEqual(arguments("compat/mit_pf.launch"),
                         foreign | arguments("localize.launch") - {"odom_topic", "compat"})
        given = {name: str(number) for number, name in enumerate(sorted(foreign - {"scan_topic", "odometry_topic"}))}
        config = load("compat/mit_pf.launch", scan_topic="/lidar", odometry_topic="/wheels", **given)
        for name, text in given.items():
            self.assertEqual(str(parameter(config, f"/localization/{name}")), text)
        self.assertEqual(parameter(config, "/localization/compat"), "mit_pf")
        remaps = dict(nodes(config)["localization"].remap_args)
        self.assertEqual((remaps["scan"], remaps["odom"]), ("/lidar", "/wheels"))

    def testReplayChoosesTheTfModeByTheBag(self):
        self.assertTrue(parameter(load("replay_bag.launch", bag=self.bag), "/use_sim_time"))
        mode = "/localization/tf_mode"
        self.assertEqual(parameter(load("replay_bag.launch", bag=self.bag), mode), "map_to_odom")
        write_bag(self.bag, "laser")
        self.assertEqual(parameter(load("replay_bag.launch", bag=self.bag), mode), "map_to_base")
        self.assertEqual(
            parameter(load("replay_bag.launch", bag=self.bag, tf_mode="off"), mode), "off")

    def testAMissingOrDamagedBagIsNamed(self):
        program = str(ROOT / "nodes/bag_tf_mode")
        damaged = self.folder / "damaged.bag"
        damaged.write_text("no bag", encoding="utf-8")
        for bag, words in ((self.folder / "none.bag", "there is no bag {}; expected"),
                           (damaged, "the bag {} cannot be read")):
            result = subprocess.run([program, str(bag)], check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(result.returncode, 1)
            self.assertIn(words.format(bag), result.stderr.decode())
            with self.assertRaises(roslaunch.core.RLException):
                load("replay_bag.launch", bag=bag)

    def testRelativePathsStartInTheWorkingDirectory(self):
        player = nodes(load("replay_bag.launch", bag="x.bag", tf_mode="off"))["player"]
        self.assertIn("/x.bag'", player.args)
        self.assertRegex(player.args, r" '/\S+/x\.bag'$")

    def testSimulatesOnAnyMap(self):
        name = "/simulator/map"
        self.assertEqual(parameter(load("simulate.launch"), name), MAP)
        self.assertEqual(parameter(load("simulate.launch", map="track"), name),
                         str(ROOT / "maps/track.yaml"))
        self.assertEqual(parameter(load("simulate.launch", map="/of/others.yaml"), name),
                         "/of/others.yaml")
        self.assertRegex(parameter(load("simulate.launch", map="others.yaml"), name),
                         r"^/.+/others\.yaml$")

    def testSimulatesWithAndWithoutALocalizer(self):
        config = load("simulate.launch")
        self.assertEqual(set(nodes(config)), {"simulator", "map_source"})
        config = load("simulate.launch", localize="true")
        self.assertTrue(parameter(config, "/use_sim_time"))
        self.assertTrue(parameter(config, "/simulator/announce_start"))
        self.assertEqual(parameter(config, "/localization/tf_mode"), "map_to_odom")
        config = load("simulate.launch", localize="true", global_start="true", odom_tf="false")
        self.assertFalse(parameter(config, "/simulator/announce_start"))
        self.assertEqual(parameter(config, "/localization/global_start"), "true")
        self.assertFalse(parameter(config, "/simulator/publish_odom_tf"))
        self.assertEqual(parameter(config, "/localization/tf_mode"), "map_to_base")

    def testSimulatorHasTheParametersThatAreSet(self):
        source = (ROOT / "src/ros/simulation/simulator_parameters.h").read_text(encoding="utf-8")
        known = set(re.findall(r'visit\("(\w+)"', source))
        given = {name.split("/")[2] for name in load("simulate.launch").params
                 if name.startswith("/simulator/")}
        self.assertLessEqual(given, known)
        self.assertIn("slip", given)

    def assertRvizFits(self, config, topics, tools):
        """Checks the displayed topics and those of the tools, and that the nodes have them."""
        source = "".join(path.read_text(encoding="utf-8")
                         for path in (ROOT / "src/ros").rglob("*.cpp"))
        published = {f"/{topic}" for topic in re.findall(r'advertise<[\w:]+>\(\s*"([\w/]+)"', source)}
        published |= {f"/simulator{topic}" for topic in published}
        subscribed = {f"/{topic}" for topic in re.findall(r'subscribe\(\s*"([\w/]+)"', source)}
        subscribed |= {f"/simulator{topic}" for topic in subscribed}
        rviz = yaml.safe_load((ROOT / "config" / config).read_text(encoding="utf-8"))
        manager = rviz["Visualization Manager"]
        shown = {display.get("Topic") or display.get("Marker Topic")
                 for display in manager["Displays"] if display["Value"]}
        plugins = {plugin.get("name") for plugin in ElementTree.parse(ROOT / "rviz_plugins.xml").iter("class")}
        self.assertLessEqual(plugins, {panel["Class"] for panel in rviz["Panels"]})
        self.assertLessEqual(topics, shown)
        self.assertLessEqual(shown, published)
        sent = {tool["Topic"] for tool in manager["Tools"] if "Topic" in tool}
        self.assertEqual(sent, tools)
        self.assertLessEqual(sent, subscribed)

    def testRvizShowsWhatTheLocalizerPublishes(self):
        topics = {"/map", "/pf/viz/particles", "/pf/viz/particle_markers", "/pf/viz/scan",
                  "/pf/viz/fake_scan", "/pf/viz/clusters", "/pf/viz/status", "/pf/pose/odom"}
        self.assertRvizFits("localization.rviz", topics, {"/initialpose", "/clicked_point"})
        self.assertRvizFits("simulation.rviz", topics | {"/simulator/car", "/simulator/obstacles", "/pf/obstacles",
                                                         "/pf/viz/obstacles"},
                            {"/initialpose", "/simulator/place", "/simulator/add_obstacle"})


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "launch_files_test", LaunchFiles, sysargs=sys.argv)
