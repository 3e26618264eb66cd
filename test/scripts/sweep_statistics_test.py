#!/usr/bin/python3
"""Scores of runs and the paired bootstrap of scripts/sweep."""
import sys
import unittest
from unittest import mock

import numpy
import rosunit
from sweep_fixture import summary

from racecar_mcl_eval.sweep import bootstrap, jobs, score


class Scores(unittest.TestCase):
    LIMITS = jobs.Limits(0.5, 1.0)

    def score(self, result):
        scored = score.score("key", None, result, self.LIMITS)
        return scored.outcome, scored.error

    def result(self, error, coverage=1.0, **position):
        result = summary(error, coverage=coverage)
        result["position_error_m"].update(position)
        return result

    def testALostOrFailedRunCountsTheBound(self):
        self.assertEqual(self.score(self.result(0.1)), (score.TRACKED, 0.1))
        self.assertEqual(self.score(self.result(0.1, max=3.0)), (score.TRACKED, 0.1))
        self.assertEqual(self.score(self.result(0.1, p95=0.6)), (score.LOST, 1.0))
        self.assertEqual(self.score(self.result(0.1, final=9.0)), (score.LOST, 1.0))
        self.assertEqual(self.score(self.result(0.01, coverage=0.4)), (score.LOST, 1.0))
        self.assertEqual(self.score(self.result(0.1, mean=None)), (score.LOST, 1.0))
        self.assertEqual(self.score(self.result(50.0, p95=0.1, final=0.1)), (score.TRACKED, 1.0))
        self.assertEqual(self.score({"failure": "no scans"}), (score.FAILED, 1.0))


class Bootstrap(unittest.TestCase):
    def testEqualDifferencesHaveNoWidth(self):
        for value, verdict in ((-0.1, bootstrap.BETTER), (0.1, bootstrap.WORSE), (0.0, bootstrap.NO_DIFFERENCE)):
            difference = bootstrap.paired_difference([[value] * 3] * 4)
            numpy.testing.assert_allclose([difference.mean, difference.low, difference.high], value)
            self.assertEqual(difference.verdict, verdict)

    def testIntervalOfOneRunPerBagIsThatOfTheMean(self):
        values = numpy.random.default_rng(3).normal(0.2, 1.0, 100)
        difference = bootstrap.paired_difference([[value] for value in values])
        half_width = 1.96 * values.std() / 10.0
        self.assertAlmostEqual(difference.low, values.mean() - half_width, delta=0.06 * half_width)
        self.assertAlmostEqual(difference.high, values.mean() + half_width, delta=0.06 * half_width)

    def testRunsOfOneBagAreNoIndependentEvidence(self):
        values = numpy.random.default_rng(3).normal(0.0, 1.0, 20)
        single = bootstrap.paired_difference([[value] for value in values])
        repeated = bootstrap.paired_difference([[value] * 50 for value in values])
        self.assertAlmostEqual(repeated.high - repeated.low, single.high - single.low, delta=0.05)

    def testEachBagCountsOnceAndOnlyItsOwnRuns(self):
        difference = bootstrap.paired_difference([[1.0], [3.0] * 9])
        self.assertEqual((difference.mean, difference.low, difference.high), (2.0, 1.0, 3.0))

    def testABagIsRedrawnWithItsOwnNumberOfRuns(self):
        difference = bootstrap.paired_difference([[-1.0, 1.0], [0.0] * 40])
        self.assertEqual((difference.mean, difference.low, difference.high), (0.0, -0.5, 0.5))

    def testCoversTheTrueDifferenceAsOftenAsItSays(self):
        generator = numpy.random.default_rng(5)
        covered = 0
        with mock.patch.object(bootstrap, "REPLICATES", 1000):
            for _ in range(200):
                drives = generator.normal(0.3, 1.0, 30)
                groups = [drive + generator.normal(0.0, 0.3, 3) for drive in drives]
                difference = bootstrap.paired_difference(groups)
                covered += difference.low <= 0.3 <= difference.high
        self.assertGreaterEqual(covered, 180)
        self.assertLessEqual(covered, 199)

    def testTheSameSeedGivesTheSameInterval(self):
        groups = [[1.0, 2.0], [0.5], [3.0, -1.0, 2.0]]
        self.assertEqual(bootstrap.paired_difference(groups, 4), bootstrap.paired_difference(groups, 4))
        self.assertNotEqual(bootstrap.paired_difference([[value] for value in range(40)], 4),
                            bootstrap.paired_difference([[value] for value in range(40)], 5))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "sweep_statistics_test", "__main__", sysargs=sys.argv)
