#!/usr/bin/python3
"""Measures of scripts/evaluate against hand-calculated cases."""
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy
import rosunit

from racecar_mcl_eval import EvaluationError, assessment, consistency, grid_map, trajectory
from racecar_mcl_eval.run import Run, Updates

SECOND = 10**9  # ns


def straight(seconds, speed=1.0, yaw=0.0, y=0.0):
    """A trajectory along x with poses at these times."""
    stamps = numpy.round(numpy.asarray(seconds) * SECOND).astype(numpy.int64)
    return trajectory.Trajectory(stamps, numpy.array([(speed * t, y, yaw) for t in seconds]))


class Trajectories(unittest.TestCase):
    def testStampsKeepTheirNanoseconds(self):
        self.assertEqual(trajectory.parse_stamp("1134864642.914187001"), 1134864642914187001)
        self.assertEqual(trajectory.parse_stamp("12"), 12 * SECOND)
        self.assertEqual(trajectory.parse_stamp("1.5e3"), 1500 * SECOND)
        self.assertEqual(trajectory.format_stamp(1134864642914187001), "1134864642.914187001")

    def testTumFilesAreReadInOrderAndWritten(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.tum"
            path.write_text("# made by hand\n\n2.5 1 2 0 0 0 1 0\n1.25 3 4 0 0 0 0 1\n2.5 9 9 0 0 0 0 1\n")
            read = trajectory.read_tum(path)
            numpy.testing.assert_array_equal(read.stamps, [1250000000, 2500000000])
            numpy.testing.assert_allclose(read.poses, [(3, 4, 0), (1, 2, math.pi)])
            trajectory.write_tum(read, path)
            numpy.testing.assert_allclose(trajectory.read_tum(path).poses, read.poses, atol=1e-9)

    def testInvalidTumLinesAreReported(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "a.tum"
            path.write_text("1 0 0 0 0 0 0 1\n2 0 0 what\n")
            with self.assertRaisesRegex(EvaluationError, "a.tum, line 2"):
                trajectory.read_tum(path)
            path.write_text("# nothing\n")
            with self.assertRaisesRegex(EvaluationError, "no poses"):
                trajectory.read_tum(path)
            with self.assertRaisesRegex(EvaluationError, "cannot be read"):
                trajectory.read_tum(Path(folder) / "b.tum")

    def testInterpolatesTheEstimateAtTruthStamps(self):
        errors = trajectory.compare(straight([0.0, 0.4, 0.8]), straight([0.1, 0.3, 0.7, 0.9], y=0.05))
        numpy.testing.assert_array_equal(errors.stamps, [SECOND // 10, 3 * SECOND // 10, 7 * SECOND // 10])
        numpy.testing.assert_allclose(errors.position, [0.05] * 3)

    def testSkipsAndCountsTruthStampsInGaps(self):
        errors = trajectory.compare(straight([0.0, 0.6, 1.0]), straight([0.0, 0.3, 0.6, 0.8]), 0.5)
        self.assertEqual(errors.skipped, 1)
        self.assertEqual(len(errors.stamps), 3)

    def testInterpolatesYawAlongTheShorterArc(self):
        estimate = straight([0.0, 0.4])
        estimate.poses[:, 2] = (math.pi - 0.1, -math.pi + 0.1)
        errors = trajectory.compare(estimate, straight([0.2], yaw=math.pi - 0.02))
        numpy.testing.assert_allclose(errors.heading, [0.02], atol=1e-12)

    def testAlongTrackAndCrossTrackErrors(self):
        truth = straight([0.0, 1.0], yaw=math.pi / 2)
        estimate = straight([0.0, 1.0])
        estimate.poses[:] = truth.poses + (-0.3, 0.1, 0.05)
        errors = trajectory.compare(estimate, truth)
        numpy.testing.assert_allclose(errors.cross_track, 0.3)
        numpy.testing.assert_allclose(errors.along_track, 0.1)
        numpy.testing.assert_allclose(errors.heading, 0.05)

    def testTrajectoriesWithoutCommonTimeHaveNoErrors(self):
        self.assertIsNone(trajectory.compare(straight([0.0, 0.1]), straight([5.0, 6.0])))

    def testLengthAndRateOfADrive(self):
        drive = straight([0.0, 0.5, 1.0, 2.0], speed=3.0)
        self.assertAlmostEqual(drive.length(), 6.0)
        self.assertAlmostEqual(drive.rate(), 1.5)
        self.assertEqual(straight([0.0]).rate(), 0.0)

    def testKeepsTheFirstOfEqualStamps(self):
        kept = trajectory.in_order([2 * SECOND, SECOND, 2 * SECOND], [(5, 0, 0), (1, 0, 0), (2, 0, 0)])
        numpy.testing.assert_array_equal(kept.stamps, [SECOND, 2 * SECOND])
        numpy.testing.assert_allclose(kept.poses[:, 0], [1, 5])

    def testASinglePoseIsComparedAtItsStampOnly(self):
        self.assertIsNone(trajectory.compare(straight([0.0]), straight([0.1])))
        self.assertEqual(len(trajectory.compare(straight([0.1]), straight([0.0, 0.1])).stamps), 1)

    def testIntervalsAndFractionsOfTime(self):
        flags = [False, True, True, False, True]
        self.assertEqual(trajectory.spans([0, 1, 2, 3, 9], flags), [(1, 2), (9, 9)])
        self.assertAlmostEqual(trajectory.fraction_of_time(numpy.array([0, 1, 2, 3, 9]), flags), 2 / 9)


def run_of(errors, covariances):
    """A run whose updates are off by `errors` (x, y, yaw) on a constant truth."""
    stamps = numpy.arange(len(errors)) * SECOND // 10
    poses = numpy.array(errors, dtype=float)
    run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses),
              Updates(stamps, poses, numpy.array(covariances), {}))
    run.set_truth(trajectory.Trajectory(stamps, numpy.zeros_like(poses)), 0.5)
    return run


class Consistency(unittest.TestCase):
    def testCorrectCovarianceHasAMeanNeesOfThree(self):
        generator = numpy.random.default_rng(1)
        root = numpy.array([[0.1, 0.0, 0.0], [0.05, 0.02, 0.0], [0.0, 0.01, 0.03]])
        errors = generator.normal(size=(4000, 3)) @ root.T
        measured = consistency.measure(run_of(errors, [root @ root.T] * 4000), 0.5)
        self.assertAlmostEqual(measured.mean_nees, 3.0, delta=0.15)
        self.assertGreater(min(measured.within_3_sigma), 0.99)

    def testDetectsOverconfidence(self):
        run = run_of([(0.3, 0.0, 0.0)] * 10, [numpy.diag([1e-4, 1e-4, 1e-4])] * 10)
        measured = consistency.measure(run, 0.5)
        self.assertEqual(measured.within_3_sigma, (0.0, 1.0, 1.0))
        self.assertAlmostEqual(measured.mean_nees, 900.0, delta=1e-6)
        banner = assessment.assess(run, measured, None, 0.5)
        self.assertEqual(banner.level, "warning")
        self.assertIn("overconfident", banner.reasons[0])

    def testNeesOfASingularCovarianceIsFinite(self):
        measured = consistency.measure(run_of([(0.1, 0.1, 0.1)] * 3, [numpy.diag([1e-4, 0.0, 0.0])] * 3), 0.5)
        self.assertTrue(numpy.isfinite(measured.nees).all())


class Maps(unittest.TestCase):
    def testWallDistancesUseTheOriginsYawAndAreTruncated(self):
        with tempfile.TemporaryDirectory() as folder:
            # A wall in the second column of three; the grid stands upright.
            (Path(folder) / "m.pgm").write_bytes(b"P5 3 2 255\n" + bytes([254, 0, 254] * 2))
            path = Path(folder) / "m.yaml"
            path.write_text("image: m.pgm\nresolution: 0.5\norigin: [1.0, 2.0, 1.5707963267948966]\n"
                            "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
            walls = grid_map.load_map(path)
            # Grid x runs along the map's y, grid y along its -x.
            points = numpy.array([(0.75, 2.75), (0.75, 2.25), (0.75, 3.0), (50.0, 50.0)])
            numpy.testing.assert_allclose(walls.wall_distances(points), [0.0, 0.5, 0.25, 2.0], atol=0.02)

    def testInvalidMapsAreReported(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "m.yaml"
            with self.assertRaisesRegex(EvaluationError, "m.yaml"):
                grid_map.load_map(path)
            path.write_text("image: m.pgm\n")
            with self.assertRaisesRegex(EvaluationError, "resolution"):
                grid_map.load_map(path)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "evaluation_test", "__main__", sysargs=sys.argv)
