#!/usr/bin/python3
"""The configurations for other tools name topics, fields and values that the localizer publishes."""
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

import rosunit
import yaml
from master_test_case import MAP, ROOT, MasterTest

from racecar_mcl_eval.ros_graph import end

# What the 3D panel of Foxglove draws.
DRAWN_TYPES = {"geometry_msgs/PoseStamped", "nav_msgs/OccupancyGrid", "sensor_msgs/LaserScan", "sensor_msgs/PointCloud2",
               "visualization_msgs/Marker", "visualization_msgs/MarkerArray"}


def value_at(message, path):
    """The value at a Foxglove message path without its topic, such as `.values[:]{key=="clusters"}.value`."""
    for field, key, wanted in re.findall(r'\.(\w+)(?:\[:\]\{(\w+)=="([^"]*)"\})?', path):
        message = message[field]
        if key:
            message = next(element for element in message if element[key] == wanted)
    return message


class Dashboards(MasterTest):
    messages = {}  # of one drive, by topic
    types = {}

    def setUp(self):
        super().setUp()
        if self.messages:
            return
        simulation = self.start("simulation", "roslaunch", "racecar_mcl", "simulate.launch", f"map:={MAP}",
                                "localize:=true")
        self.addCleanup(end, simulation)
        for topic in ("/pf/status", "/diagnostics", "/pf/pose/odom", "/vesc/odom"):
            self.waitFor(lambda: self.output("rostopic", "type", topic), f"{topic} was not published")
            self.messages[topic] = next(yaml.safe_load_all(self.output("rostopic", "echo", "-n1", topic)))
        self.types.update(re.findall(r"^ \* (\S+) \[(\S+)\] \d+ publisher", self.output("rostopic", "list", "-v"),
                                     flags=re.MULTILINE))

    def output(self, *command):
        return subprocess.run(command, env=self.environment, check=False, timeout=60, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL).stdout.decode()

    def series(self):
        """All series as PlotJuggler names them: the numbers of the messages that it subscribes to."""
        names = set()
        for status in self.messages["/diagnostics"]["status"]:
            names |= {f"/diagnostics/{status['hardware_id']}/{status['name']}/{value['key']}"
                      for value in status["values"] if re.fullmatch(r"[-+.\deE]+", str(value["value"]))}

        def add(name, value):
            if isinstance(value, dict):
                for field, part in value.items():
                    add(f"{name}/{field}", part)
            elif isinstance(value, (int, float)):
                names.add(name)

        for topic in ("/pf/pose/odom", "/vesc/odom"):
            add(topic, self.messages[topic])
        return names

    def testTheAggregatorExpectsThePublishedName(self):
        config = yaml.safe_load((ROOT / "config/diagnostics_aggregator.yaml").read_text(encoding="utf-8"))
        expected = [analyzer["expected"] for analyzer in config["analyzers"].values()]
        self.assertEqual(expected, [self.messages["/diagnostics"]["status"][0]["name"]])

    def testPlotJugglerFindsItsSeries(self):
        layout = ElementTree.parse(ROOT / "config/plotjuggler_layout.xml").getroot()
        plotted = set()
        for curve in layout.iter("curve"):
            plotted |= {curve.get(name) for name in (("curve_x", "curve_y") if "curve_x" in curve.keys() else ("name",))}
        self.assertGreater(len(plotted), 10)
        self.assertEqual(plotted - self.series(), set())

    def testFoxgloveFindsItsTopicsAndValues(self):
        panels = json.loads((ROOT / "config/foxglove_layout.json").read_text(encoding="utf-8"))["configById"]
        for topic in panels["3D!map"]["topics"]:
            with self.subTest(topic=topic):
                self.assertIn(self.types.get(topic), DRAWN_TYPES)
        paths = [path["value"] for panel in panels.values() for path in panel.get("paths", [])]
        self.assertGreater(len(paths), 10)
        for path in paths:
            with self.subTest(path=path):
                topic, rest = re.fullmatch(r"([^.]+)(\..*)", path).groups()
                float(value_at(self.messages[topic], rest))
        detail = panels["DiagnosticStatusPanel!localization"]
        status = self.messages[detail["topicToRender"]]["status"][0]
        self.assertEqual([detail["selectedHardwareId"], detail["selectedName"]], [status["hardware_id"], status["name"]])

    def testTheLayoutShowsEveryPanelOnce(self):
        layout = json.loads((ROOT / "config/foxglove_layout.json").read_text(encoding="utf-8"))

        def shown(part):
            return [part] if isinstance(part, str) else shown(part["first"]) + shown(part["second"])

        self.assertEqual(sorted(shown(layout["layout"])), sorted(layout["configById"]))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "dashboards_test", Dashboards, sysargs=sys.argv)
