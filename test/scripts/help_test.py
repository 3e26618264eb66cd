#!/usr/bin/python3
"""Programs and launch files describe themselves, without a master."""
import os
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import roslib.packages
import rosunit

ROOT = Path(__file__).resolve().parents[2]
LAUNCH = sorted((ROOT / "launch").rglob("*.launch"))
# Nobody listens there.
ENVIRONMENT = dict(os.environ, ROS_MASTER_URI="http://127.0.0.1:1")


def run(*command):
    return subprocess.run(command, env=ENVIRONMENT, check=False, timeout=60, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def built_programs():
    names = re.findall(r"^racecar_mcl_program\((\w+)", (ROOT / "src/apps/CMakeLists.txt").read_text(encoding="utf-8"),
                       re.MULTILINE)
    return {name: roslib.packages.find_node("racecar_mcl", name) for name in names}


def scripts():
    return [path for folder in ("scripts", "tools", "nodes") for path in sorted((ROOT / folder).iterdir())
            if path.is_file() and os.access(path, os.X_OK)]


class Help(unittest.TestCase):
    def assertHelp(self, programs):
        commands = [(program, option) for program in programs for option in ("--help", "-h")]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(lambda command: run(*command), commands))
        for command, result in zip(commands, results):
            with self.subTest(command=command):
                self.assertEqual(result.returncode, 0, result.stderr.decode())
                self.assertIn(b"usage", result.stdout.lower())
                self.assertNotIn(b"master", result.stderr.lower())

    def testEveryBuiltProgramHelps(self):
        programs = built_programs()
        self.assertIn("localization_node", programs)
        self.assertEqual([name for name, found in programs.items() if not found], [], "not built")
        self.assertHelp([found[0] for found in programs.values()])

    def testEveryScriptHelps(self):
        self.assertHelp([str(path) for path in scripts()])

    def testANodeNamesAnUnknownArgument(self):
        for name in ("localization_node", "simulator_node"):
            result = run(built_programs()[name][0], "map.yaml")
            self.assertEqual(result.returncode, 1)
            self.assertIn(b"unknown argument 'map.yaml'", result.stderr)

    def testEveryLaunchFileListsItsArguments(self):
        for path in LAUNCH:
            text = run("roslaunch", str(path), "--ros-args").stdout.decode()
            for argument in ElementTree.parse(path).getroot().findall("arg"):
                if argument.get("value") is not None:
                    continue
                with self.subTest(file=path.name, argument=argument.get("name")):
                    pattern = r"^\s+{}\b.*: {}".format(argument.get("name"), re.escape(argument.get("doc")[:30]))
                    self.assertRegex(text, re.compile(pattern, re.MULTILINE))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "help_test", Help, sysargs=sys.argv)
