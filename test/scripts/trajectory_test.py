#!/usr/bin/python3
"""Errors between trajectories, against cases worked out by hand."""
import math
import sys
import unittest
from pathlib import Path

import numpy
import rosunit

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts/lib"))
import trajectory  # noqa: E402


def along_x(stamps, speed=1.0, yaw=0.0, y=0.0):
    return trajectory.from_rows([(t, speed * t, y, math.sin(yaw / 2), math.cos(yaw / 2))
                                 for t in stamps])


class TrajectoryErrors(unittest.TestCase):
    def testInterpolatesBetweenNeighbours(self):
        stamps, position, heading = trajectory.errors(along_x([0.0, 0.4, 0.8]),
                                                      along_x([0.1, 0.3, 0.7], y=0.05))
        numpy.testing.assert_allclose(stamps, [0.1, 0.3, 0.7])
        numpy.testing.assert_allclose(position, [0.05] * 3)
        numpy.testing.assert_allclose(heading, [0.0] * 3, atol=1e-12)

    def testHeadingGoesTheShortWayRound(self):
        _, _, heading = trajectory.errors(along_x([0.0, 0.4], yaw=math.pi - 0.01),
                                          along_x([0.2], yaw=-math.pi + 0.02))
        numpy.testing.assert_allclose(heading, [0.03], atol=1e-9)

    def testSkipsGapsAndWhatLiesOutside(self):
        estimate = along_x([0.0, 0.5, 2.0, 2.2])
        stamps, _, _ = trajectory.errors(estimate, along_x([-0.1, 0.25, 1.0, 2.1, 2.3]))
        numpy.testing.assert_allclose(stamps, [0.25, 2.1])

    def testTooShortAnEstimateGivesNothing(self):
        for estimate in (trajectory.from_rows([]), along_x([0.0])):
            self.assertEqual(len(trajectory.errors(estimate, along_x([0.0]))[0]), 0)

    def testRowsAreOrderedAndTheLastOfAStampStays(self):
        path = trajectory.from_rows([(2.0, 5, 0, 0, 1), (1.0, 1, 0, 0, 1), (2.0, 2, 0, 0, 1)])
        numpy.testing.assert_allclose(path.stamp, [1.0, 2.0])
        numpy.testing.assert_allclose(path.x, [1.0, 2.0])
        self.assertAlmostEqual(path.rate, 1.0)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "trajectory_test", TrajectoryErrors, sysargs=sys.argv)
