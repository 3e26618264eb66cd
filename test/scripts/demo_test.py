#!/usr/bin/python3
"""Parts of scripts/demo: its summary, figure and arguments, and the drive on the map of a real building, on a map of
the test."""
import contextlib
import io
import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy
import rosbag
import rosunit
from sensor_msgs.msg import Imu, LaserScan

from racecar_mcl_eval import EvaluationError, demo, programs, run_figures, trajectory
from racecar_mcl_eval.columns import INITIALIZING, STATUS
from racecar_mcl_eval.grid_map import FREE, OCCUPIED, GridMap, write_map
from racecar_mcl_eval.run import Run, Updates


class RealBuilding(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        self.data, self.out = self.folder / "data", self.folder / "out"
        self.out.mkdir()

    def show(self):
        """The printed lines."""
        with mock.patch.dict(os.environ, {"RACECAR_MCL_DATA": str(self.data)}), \
                contextlib.redirect_stdout(io.StringIO()) as printed:
            demo.show_real_building(self.out)
        return printed.getvalue().strip().splitlines()

    def build(self, shade):
        """A hall of 16 m by 12 m with a block on one side, around the start pose of the demo."""
        x, y, _ = map(float, demo.REAL_START.split())
        cells = numpy.full((240, 320), shade, numpy.uint8)
        cells[[0, -1]], cells[:, [0, -1]], cells[150:, 200:] = OCCUPIED, OCCUPIED, OCCUPIED
        path = self.data / demo.REAL_MAP
        path.parent.mkdir(parents=True)
        write_map(GridMap("hall", cells, 0.05, (x - 8.0, y - 6.0, 0.0)), path)

    def testPrintsNothingWithoutTheMap(self):
        self.assertEqual(self.show(), [])
        self.assertEqual(list(self.out.iterdir()), [])

    def testReportsTheErrorsOfBothInitializations(self):
        self.build(FREE)
        with mock.patch.object(demo, "REAL_DURATION", 5.0):
            first, *starts = self.show()
        self.assertIn("stata_basement.yaml", first)
        self.assertEqual([line.split(":")[0] for line in starts],
                         ["true initial pose", "global localization"])
        self.assertRegex(starts[0], r"localized after 0\.\d s; position error from then on: mean \d\.\d cm, "
                                    r"max \d+\.\d cm")

    def testAFailedSimulationIsNoError(self):
        self.build(OCCUPIED)
        self.assertRegex(self.show()[-1], "^simulation failed: ")

    def testAFailedReplayIsAnError(self):
        self.build(FREE)
        run = programs.run

        def fail(name, words):
            if name == "replay":
                raise EvaluationError("replay broke")
            return run(name, words)
        with mock.patch.object(programs, "run", fail), mock.patch.object(demo, "REAL_DURATION", 1.0):
            with self.assertRaisesRegex(EvaluationError, "replay broke"):
                self.show()

    def testErrorsCountFromTheFirstLocalizedUpdate(self):
        stamps = numpy.arange(4) * 10**8
        truth = trajectory.Trajectory(stamps, numpy.zeros((4, 3)))
        poses = numpy.array([(9.0, 0, 0), (8.0, 0, 0), (0.1, 0, 0), (0.3, 0, 0)])

        def since_localized(*states):
            updates = Updates(stamps, poses, numpy.zeros((4, 3, 3)), {STATUS: numpy.array(states)})
            return demo.since_localized(Run("run", Path("run"), trajectory.Trajectory(stamps, poses), updates),
                                        truth)
        self.assertEqual(since_localized(INITIALIZING, INITIALIZING, "localized", "degraded"),
                         "localized after 0.2 s; position error from then on: mean 20.0 cm, "
                         "max 30.0 cm")
        self.assertEqual(since_localized(*[INITIALIZING] * 4), "never localized")


class Start(unittest.TestCase):
    """Two runs over ten seconds; the heading of the first is corrected in its first instant."""

    def setUp(self):
        stamps = numpy.arange(101) * 10**8
        truth = trajectory.Trajectory(stamps, numpy.zeros((101, 3)))
        self.runs = []
        for first, middle in ((0.5, 0.01), (0.0, 0.02)):
            poses = numpy.zeros((101, 3))
            poses[:, 0] = 0.01
            poses[0, 2], poses[50, 2] = first, middle
            run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses), None)
            run.set_truth(truth, 0.5)
            self.runs.append(run)

    def testTheTimesOfTheLargestErrorsAreInTheSummary(self):
        rows = {row[0]: row[1:] for row in demo.error_rows(self.runs)}
        self.assertEqual(rows["heading error, max"], ["28.65 deg", "1.15 deg"])
        self.assertEqual(rows["heading error, time of max"], ["0.0 s", "5.0 s"])

    def testDoesNotSetTheScaleOfTheErrors(self):
        figure = run_figures.errors_over_time(self.runs, 0.5)
        self.addCleanup(run_figures.plt.close, figure)
        heading = next(axes for axes in figure.axes if axes.get_ylabel().startswith("heading"))
        self.assertAlmostEqual(heading.get_ylim()[1], 1.1 * numpy.degrees(0.02))
        self.assertIn("up to 29 deg in the first 1 s", [text.get_text() for text in heading.texts])


class Gyro(unittest.TestCase):
    def testReplayUsesTheGyroOfTheBag(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "drive.bag"
            with rosbag.Bag(str(path), "w") as bag:
                bag.write("/imu", Imu())
                bag.write("/scan", LaserScan())
            self.assertEqual(demo.gyro_arguments(path, "/imu"), ["--imu-topic", "/imu"])
            self.assertEqual(demo.gyro_arguments(path, "/scan"), [])
            self.assertEqual(demo.gyro_arguments(path, "/none"), [])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "demo_test", "__main__", sysargs=sys.argv)
