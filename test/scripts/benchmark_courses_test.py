#!/usr/bin/python3
"""tools/benchmark_courses: measures against hand-calculated cases, and the whole program."""
import json
import math
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy
import rosunit
from program_module import load_program

from racecar_mcl_eval import programs, trajectory
from racecar_mcl_eval.columns import STATUS
from racecar_mcl_eval.grid_map import FREE, OCCUPIED, UNKNOWN, GridMap, load_map
from racecar_mcl_eval.map_drawing import erase_walls
from racecar_mcl_eval.run import Run, Updates

SECOND = 10**9  # ns


benchmark = load_program("tools/benchmark_courses")


def measured(off, status, level):
    """The outcome of a run with one scan per second and metre, and lateral errors `off` (m)."""
    stamps = SECOND * numpy.arange(len(off))
    x, still = numpy.arange(len(off), dtype=float), numpy.zeros(len(off))
    poses = numpy.column_stack((x, off, still))
    columns = {STATUS: numpy.array(status), "level_along": still, "level_heading": still,
               "level_across": numpy.full(len(off), level)}
    run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses),
              Updates(stamps, poses, numpy.zeros((len(off), 3, 3)), columns))
    return benchmark.measure(7, run, trajectory.Trajectory(stamps, numpy.column_stack((x, still, still))))


class Outcomes(unittest.TestCase):
    def testTrustedTimeIsThatOfWrongLocalizedScans(self):
        outcome = measured([0.1, 0.6, 0.7, 0.1, 0.9, 0.9],
                           ["localized", "localized", "localized", "localized", "lost", "localized"], 0.2)
        self.assertEqual((outcome.trusted, outcome.longest_trusted, outcome.max_error), (3.0, 2.0, 0.9))
        self.assertAlmostEqual(outcome.rmse, math.sqrt((0.01 + 0.36 + 0.49 + 0.01 + 0.81 + 0.81) / 6))
        self.assertAlmostEqual(outcome.beyond_level, 3 / 5)  # of the localized scans
        self.assertFalse(outcome.held)

    def testARunThatIsNeverLocalizedHasNoneBeyondItsLevel(self):
        outcome = measured([0.1, 0.1], ["lost", "lost"], 0.0)
        self.assertEqual((outcome.beyond_level, outcome.trusted, outcome.longest_trusted), (0.0, 0.0, 0.0))
        self.assertTrue(outcome.held)

    def testARowCountsItsDrives(self):
        def outcome(course, worst, trusted):
            return benchmark.Outcome(course, worst / 2, worst, trusted, trusted, worst < 1.0, 0.25)
        row = benchmark.row(-0.2, 0.15, [outcome(1, 0.4, 0.0), outcome(2, 0.8, 2.0), outcome(3, 3.0, 1.0)])
        self.assertEqual((row["over_half"], row["over_one"], row["trusted_drives"], row["held"]), (2, 1, 2, 2))
        self.assertEqual(benchmark.cells(row), ["-20 %", "15 %", "0.400", "0.700", "1.500", "3.00 (3)", "2", "1",
                                                "2", "3.0", "2.0", "2/3", "25.00 %"])
        self.assertEqual(len(benchmark.HEADER), len(benchmark.cells(row)))


class ErasedWalls(unittest.TestCase):
    def setUp(self):
        cells = numpy.full((200, 300), OCCUPIED, numpy.uint8)
        cells[20:180, 20:280] = FREE
        self.whole = GridMap("room", cells, 0.05, (0.0, 0.0, 0.0))

    def testTheFractionOfTheSurfaceIsErased(self):
        surface = numpy.zeros(self.whole.cells.shape, bool)
        surface[19:181, 19:281] = True
        surface &= self.whole.cells == OCCUPIED
        for fraction in (0.15, 0.5):
            erased = erase_walls(self.whole, fraction, numpy.random.default_rng(1)).cells
            left = numpy.count_nonzero(erased[surface] == OCCUPIED) / numpy.count_nonzero(surface)
            self.assertLessEqual(left, 1.0 - fraction)
            self.assertGreater(left, 1.0 - fraction - 0.06)  # a disc of 1.2 m is 6 % of this surface

    def testOnlyWallsAreErasedToUnknown(self):
        erased = erase_walls(self.whole, 0.3, numpy.random.default_rng(1)).cells
        changed = erased != self.whole.cells
        self.assertTrue((self.whole.cells[changed] == OCCUPIED).all())
        self.assertTrue((erased[changed] == UNKNOWN).all())
        self.assertEqual(numpy.count_nonzero(self.whole.cells == UNKNOWN), 0)  # the map given is unchanged

    def testAMapWithoutWallsIsReturned(self):
        empty = GridMap("empty", numpy.full((10, 10), FREE, numpy.uint8), 0.05, (0.0, 0.0, 0.0))
        self.assertTrue((erase_walls(empty, 0.3, numpy.random.default_rng(1)).cells == FREE).all())


class Program(unittest.TestCase):
    def run_program(self, *arguments):
        return subprocess.run([str(programs.ROOT / "tools/benchmark_courses"), *map(str, arguments)],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)

    def testTableHasARowPerScaleAndFraction(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder, table = Path(scratch) / "courses", Path(scratch) / "table.json"
            words = ["--first", 3, "--count", 1, "--duration", 6, "--erased", 0, 0.3, "--speed-scale-errors", 0, -0.1,
                     "--folder", folder, "--json", table]
            result = self.run_program(*words)
            self.assertEqual(result.returncode, 0, result.stderr)
            rows = json.loads(table.read_text())
            self.assertEqual([(row["speed_scale_error"], row["erased"]) for row in rows],
                             [(0.0, 0.0), (0.0, 0.3), (-0.1, 0.0), (-0.1, 0.3)])
            lines = result.stdout.decode().splitlines()
            self.assertEqual([line.split()[:4] for line in lines[1:]],
                             [["+0", "%", "0", "%"], ["+0", "%", "30", "%"], ["-10", "%", "0", "%"],
                              ["-10", "%", "30", "%"]])
            self.assertLess(rows[0]["rmse_mean"], 0.15)
            # The kept courses and drives are those of the next run.
            kept = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
            self.assertEqual(len([path for path in kept if path.suffix == ".bag"]), 2)
            again = self.run_program(*words)
            self.assertEqual(again.stdout, result.stdout)
            self.assertEqual({path: path.stat().st_mtime_ns for path in folder.iterdir()}, kept)
            self.assertEqual(load_map(next(folder.glob("course_3_plain.yaml"))).resolution, 0.05)

    def testInvalidOptionsAreReported(self):
        for words, expected in ((["--first", -1], "--first must be at least 0"),
                                (["--count", 0], "--count must be at least 1"),
                                (["--erased", 1.0], "--erased must be at least 0 and less than 1")):
            result = self.run_program(*words)
            self.assertEqual(result.returncode, 2)
            self.assertIn(expected, result.stderr.decode())


    def testAFailedDriveEndsTheRun(self):
        with tempfile.TemporaryDirectory() as scratch:
            result = self.run_program("--first", 3, "--count", 2, "--duration", -1, "--folder", scratch)
            self.assertEqual(result.returncode, 1)
            self.assertIn("benchmark_courses: error: ", result.stderr.decode())
            self.assertNotIn("Traceback", result.stderr.decode())

    def testACourseThatCannotBeDrawnIsReported(self):
        with tempfile.TemporaryDirectory() as scratch:
            (Path(scratch) / "course_3_plain_world.png").mkdir()
            result = self.run_program("--first", 3, "--count", 1, "--folder", scratch)
            self.assertEqual(result.returncode, 1)
            self.assertIn("course 3: draw_maps failed: ", result.stderr.decode())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "benchmark_courses_test", "__main__", sysargs=sys.argv)
