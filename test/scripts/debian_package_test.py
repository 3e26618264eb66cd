#!/usr/bin/python3
"""debian/ and Dockerfile agree with package.xml, with what CMake installs and with the packages of scripts/setup."""
import json
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import rosunit

ROOT = Path(__file__).resolve().parents[2]
MANIFEST = ElementTree.parse(ROOT / "package.xml").getroot()
LIBRARIES = "${shlibs:Depends}"  # packages of the shared libraries, found by dpkg-shlibdeps
# What the keys of <depend> and <exec_depend> in package.xml need at run time, and those of <depend>, <build_depend>
# and <buildtool_depend> at build time. ros-core-dev contains roscpp and the common messages.
RUN_PACKAGES = {
    "diagnostic_msgs": ["python3-diagnostic-msgs"], "eigen": [], "geometry_msgs": ["python3-geometry-msgs"],
    "libopencv-dev": [LIBRARIES], "nav_msgs": ["python3-nav-msgs"], "nodelet": ["libnodeletlib-tools", LIBRARIES],
    "pluginlib": [LIBRARIES], "rosbag": ["python3-rosbag", LIBRARIES], "roscpp": [LIBRARIES],
    "rosgraph_msgs": ["python3-rosgraph-msgs"], "sensor_msgs": ["python3-sensor-msgs"],
    "std_msgs": ["python3-std-msgs"], "std_srvs": ["python3-std-srvs"], "tbb": [LIBRARIES],
    "tf2": [LIBRARIES],
    "tf2_msgs": ["python3-tf2-msgs"], "tf2_ros": [LIBRARIES], "visualization_msgs": ["python3-visualization-msgs"],
    "yaml-cpp": [LIBRARIES], "rosgraph": ["python3-rosgraph"], "roslib": ["python3-roslib"], "tf2_py": ["python3-tf2"],
    "rospy": ["python3-rospy"], "rviz": ["rviz"]}
BUILD_PACKAGES = {
    "catkin": ["catkin"], "cli11": ["libcli11-dev"], "eigen": ["libeigen3-dev"],
    "nlohmann-json-dev": ["nlohmann-json3-dev"], "nodelet": ["libnodelet-dev", "libnodeletlib-dev"],
    "pluginlib": ["pluginlib-dev"], "rosbag": ["librosbag-dev"], "rviz": ["librviz-dev"], "tbb": ["libtbb-dev"],
    "tf2": ["libtf2-ros-dev"], "tf2_msgs": ["libtf2-msgs-dev"], "tf2_ros": ["libtf2-ros-dev"],
    "yaml-cpp": ["libyaml-cpp-dev"]}
BUILD_PACKAGES.update({name: ["ros-core-dev"] for name in (
    "diagnostic_msgs", "geometry_msgs", "nav_msgs", "roscpp", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs",
    "visualization_msgs")})
# Debian's packages of these depend on a compiler or on headers, or need a display.
RECOMMENDED = {"python3-matplotlib", "python3-tf2", "rviz"}


def read(name):
    return (ROOT / name).read_text(encoding="utf-8")


def keys(*elements):
    return {element.text for element in MANIFEST if element.tag in elements}


def control_field(name):
    """The packages in a field of debian/control, without versions."""
    text = re.search(rf"^{name}:((?:.*\n)(?:[ \t].*\n)*)", read("debian/control"), re.MULTILINE).group(1)
    return {entry.split()[0] for entry in text.split(",")}


def wanted_packages():
    """The packages that scripts/setup installs here."""
    command = f". '{ROOT}/scripts/lib/common.sh'; wanted_packages"
    return set(subprocess.run(["bash", "-c", command], check=True, stdout=subprocess.PIPE).stdout.decode().split())


def installed_sources():
    """The paths in CMake's install(DIRECTORY | FILES | PROGRAMS ...) at the top."""
    text = re.sub(r"#.*", "", read("CMakeLists.txt"))
    for paths in re.findall(r"install\((?:DIRECTORY|FILES|PROGRAMS)\s+(.*?)\s+DESTINATION", text, re.DOTALL):
        yield from paths.split()


def instructions():
    """The instructions of the Dockerfile, as pairs of name and argument."""
    lines = re.sub(r"^#.*\n", "", read("Dockerfile"), flags=re.MULTILINE).replace("\\\n", " ").splitlines()
    return [tuple(line.split(None, 1)) for line in lines if line]


class DebianPackage(unittest.TestCase):
    def testDependenciesCoverThoseOfPackageXml(self):
        depends, recommends = control_field("Depends"), control_field("Recommends")
        for key in keys("depend", "exec_depend"):
            for package in RUN_PACKAGES.get(key, [key]):
                with self.subTest(key=key):
                    self.assertIn(package, recommends if package in RECOMMENDED else depends)

    def testDependenciesContainToolsOfUsersAndNoCompiler(self):
        depends = control_field("Depends")
        self.assertLessEqual({"python3-roslaunch", "python3-rostopic", "rosbash", "rosout"}, depends)
        self.assertEqual({name for name in depends if name.endswith("-dev") or name in RECOMMENDED}, set())

    def testTheLibrariesOfRvizAreRecommendedOnly(self):
        self.assertIn("${shlibs:Recommends}", control_field("Recommends"))
        panel = ElementTree.parse(ROOT / "rviz_plugins.xml").getroot().get("path")
        self.assertRegex(read("debian/rules"), rf"dh_shlibdeps -X{panel} -- -dRecommends -e\S+ -dDepends")
        self.assertIn(f"/{panel}.so\n", read("debian/rules"))

    def testBuildDependenciesCoverThoseOfPackageXml(self):
        packages = control_field("Build-Depends")
        for key in keys("depend", "build_depend", "buildtool_depend"):
            for package in BUILD_PACKAGES.get(key, [key]):
                with self.subTest(key=key):
                    self.assertIn(package, packages)

    @unittest.skipUnless("VERSION_CODENAME=bookworm" in Path("/etc/os-release").read_text(), "other package names")
    def testScriptsInstallTheBuildDependencies(self):
        script = re.search(r"^install_packages (.*)", read("scripts/package"), re.MULTILINE).group(1).split()
        missing = control_field("Build-Depends") - wanted_packages() - set(script) - {"debhelper-compat", "python3"}
        self.assertEqual(missing, set())

    def testVersionAndLicenseAreThoseOfPackageXml(self):
        newest = re.match(r"racecar-mcl \((.*?)\)", read("debian/changelog")).group(1)
        self.assertEqual(newest, MANIFEST.find("version").text)
        self.assertEqual(read("debian/source/format").strip(), "3.0 (native)")
        self.assertEqual(MANIFEST.find("license").text, "MIT")
        terms = read("LICENSE").split("\n\n", 2)[2].split()
        self.assertIn(" ".join(terms), " ".join(word for word in read("debian/copyright").split() if word != "."))

    def testMaintainerIsThatOfPackageXml(self):
        maintainer = MANIFEST.find("maintainer")
        expected = f"{maintainer.text} <{maintainer.get('email')}>"
        self.assertIn(f"\nMaintainer: {expected}\n", read("debian/control"))
        self.assertIn(f"\n -- {expected}  ", read("debian/changelog"))

    def testInstalledFilesExist(self):
        sources = list(installed_sources())
        self.assertIn("nodes/error_monitor", sources)
        self.assertLessEqual({"nodelet_plugins.xml", "rviz_plugins.xml"}, set(sources))
        self.assertEqual([name for name in sources if not (ROOT / name).exists()], [])

    def testNoDownloadWhilePackaging(self):
        self.assertIn("-DFETCHCONTENT_FULLY_DISCONNECTED=ON", read("debian/rules"))

    def testPluginsHaveNoFolder(self):
        # Debian's pluginlib searches /usr/lib/<multiarch> for the whole path.
        paths = [library.get("path") for name in ("nodelet_plugins.xml", "rviz_plugins.xml")
                 for library in ElementTree.parse(ROOT / name).iter("library")]
        self.assertEqual([path for path in paths if not path.startswith("libracecar_mcl_")], [])
        self.assertEqual(len(paths), 4)


class Dockerfile(unittest.TestCase):
    def testPackagesAreThoseOfSetup(self):
        steps = instructions()
        self.assertEqual(steps[0], ("FROM", "ros:noetic-ros-base"))
        setup = next(i for i, (_, text) in enumerate(steps) if text.startswith("scripts/setup --packages-only"))
        before = {word for name, text in steps[:setup] if name == "COPY" for word in text.split()[:-1]}
        # Scripts before the sources; common.sh is the only one that setup reads.
        self.assertEqual(before, {"scripts/setup", "scripts/lib/common.sh"})
        self.assertEqual(re.findall(r'^\. .*/(\S+)"', read("scripts/setup"), re.MULTILINE), ["common.sh"])
        self.assertEqual([text for _, text in steps if "apt-get install" in text], [])

    def testInstallsIntoThePrefixOfItsEntryPoint(self):
        steps = dict(instructions())
        prefix = re.search(r"-DCMAKE_INSTALL_PREFIX=(\S+)", read("Dockerfile")).group(1)
        shell, option, command, _ = json.loads(steps["ENTRYPOINT"])
        self.assertEqual((shell, option), ("bash", "-c"))
        self.assertEqual(command, f'. {prefix}/setup.bash -- && exec roslaunch racecar_mcl "$@"')
        self.assertTrue((ROOT / "launch" / json.loads(steps["CMD"])[0]).exists())

    def testContextHasNoBuildFolder(self):
        ignored = read(".dockerignore").split()
        self.assertLessEqual({".git", "build", ".devel"}, set(ignored))
        self.assertEqual([name for name in ignored if name.split("/")[0] in ("src", "scripts", "debian")], [])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "debian_package_test", "__main__", sysargs=sys.argv)
