#!/usr/bin/python3
"""Outcome of global localization against hand-calculated cases."""
import sys
import unittest

import numpy
import rosunit

from racecar_mcl_eval import global_start, trajectory
from racecar_mcl_eval.columns import INITIALIZING, STATUS
from racecar_mcl_eval.run import Updates

SECOND = 10**9  # ns


def measured(off, status, speed=1.0):
    """The outcome of a drive along x with one scan per second and lateral errors `off` (m)."""
    stamps = numpy.arange(len(off)) * SECOND
    x = speed * numpy.arange(len(off))
    truth = trajectory.Trajectory(stamps, numpy.column_stack((x, 0 * x, 0 * x)))
    poses = truth.poses + numpy.column_stack((0 * x, off, 0 * x))
    columns = {STATUS: numpy.array(status)}
    return global_start.measure(Updates(stamps, poses, numpy.zeros((len(off), 3, 3)), columns), truth)


class GlobalStarts(unittest.TestCase):
    def testIsHeldIfLocalizedSoonAndNotLost(self):
        # Python's bool, as json cannot write numpy's.
        self.assertIs(measured([9.0] * 5 + [0.1] * 45, ["localized"] * 50).held, True)

    def testIsNotHeldIfLocalizedLateOrLostAgain(self):
        self.assertFalse(measured([9.0] * 17 + [0.1] * 33, ["localized"] * 50).held)
        self.assertFalse(measured([0.1] * 40 + [9.0] * 10, ["localized"] * 50).held)
        self.assertFalse(measured([9.0] * 50, ["lost"] * 50).held)

    def testToleratesTwoPercentWrongScans(self):
        self.assertTrue(measured([0.1] * 50 + [9.0] * 2 + [0.1] * 48, ["localized"] * 100).held)
        self.assertFalse(measured([0.1] * 50 + [9.0] * 3 + [0.1] * 47, ["localized"] * 100, 0.5).held)

    def testMeasuresTheTimeOfMisleadingStatesAndFalseAlarms(self):
        start = measured([9.0, 9.0, 9.0, 0.1, 0.1, 0.1],
                         [INITIALIZING, "localized", "lost", "localized", "degraded", "localized"])
        self.assertEqual((start.time, start.misleading, start.correct, start.false_alarm),
                         (5.0, 1.0, 3.0, 1.0))

    def testReturnsNoneWithoutATruth(self):
        truth = trajectory.Trajectory(numpy.array([100 * SECOND]), numpy.zeros((1, 3)))
        updates = Updates(numpy.array([SECOND]), numpy.zeros((1, 3)), numpy.zeros((1, 3, 3)),
                          {STATUS: numpy.array(["lost"])})
        self.assertIsNone(global_start.measure(updates, truth))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "global_start_test", GlobalStarts, sysargs=sys.argv)
