#!/usr/bin/python3
"""What counts as a global start that found the car, against cases worked out by hand."""
import sys
import unittest
from pathlib import Path

import numpy
import rosunit

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from racecar_mcl_eval import global_start, trajectory  # noqa: E402
from racecar_mcl_eval.run import Updates  # noqa: E402

SECOND = 10**9  # ns


def measured(off, verdicts, speed=1.0):
    """A scan a second of a car that drives along x, with an estimate that is off by so many metres."""
    stamps = numpy.arange(len(off)) * SECOND
    x = speed * numpy.arange(len(off))
    truth = trajectory.Trajectory(stamps, numpy.column_stack((x, 0 * x, 0 * x)))
    poses = truth.poses + numpy.column_stack((0 * x, off, 0 * x))
    columns = {"verdict": numpy.array(verdicts)}
    return global_start.measure(Updates(stamps, poses, numpy.zeros((len(off), 3, 3)), columns), truth)


class GlobalStarts(unittest.TestCase):
    def testIsHeldWhereItIsFoundSoonAndKept(self):
        # True itself, which json can write, not numpy's.
        self.assertIs(measured([9.0] * 5 + [0.1] * 45, ["localized"] * 50).held, True)

    def testIsNotHeldWhereItIsFoundLateOrLostAgain(self):
        self.assertFalse(measured([9.0] * 17 + [0.1] * 33, ["localized"] * 50).held)
        self.assertFalse(measured([0.1] * 40 + [9.0] * 10, ["localized"] * 50).held)
        self.assertFalse(measured([9.0] * 50, ["lost"] * 50).held)

    def testForgivesTwoScansInAHundred(self):
        self.assertTrue(measured([0.1] * 50 + [9.0] * 2 + [0.1] * 48, ["localized"] * 100).held)
        self.assertFalse(measured([0.1] * 50 + [9.0] * 3 + [0.1] * 47, ["localized"] * 100, 0.5).held)

    def testTakesTheTimeOfWrongTrustAndOfFalseAlarms(self):
        start = measured([9.0, 9.0, 9.0, 0.1, 0.1, 0.1],
                         ["converging", "localized", "lost", "localized", "degraded", "localized"])
        self.assertEqual((start.time, start.trusted_wrong, start.right, start.false_alarm),
                         (5.0, 1.0, 3.0, 1.0))

    def testWhereThereIsNoTruthNothingIsMeasured(self):
        truth = trajectory.Trajectory(numpy.array([100 * SECOND]), numpy.zeros((1, 3)))
        updates = Updates(numpy.array([SECOND]), numpy.zeros((1, 3)), numpy.zeros((1, 3, 3)),
                          {"verdict": numpy.array(["lost"])})
        self.assertIsNone(global_start.measure(updates, truth))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "global_start_test", GlobalStarts, sysargs=sys.argv)
