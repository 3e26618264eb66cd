#!/usr/bin/python3
"""tools/benchmark_wrong_maps: measures against hand-calculated cases, and the whole program."""
import json
import math
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy
import rosunit
from program_module import load_program

from racecar_mcl_eval import programs, recordings, scan_match, trajectory, wrong_map
from racecar_mcl_eval.columns import STATUS
from racecar_mcl_eval.grid_map import UNKNOWN, load_map
from racecar_mcl_eval.run import Run, Updates

SECOND = 10**9  # ns


benchmark = load_program("tools/benchmark_wrong_maps")


def measured(off, status, mapped, **columns):
    """The outcome of a run with one scan per second and metre and lateral errors `off` (m)."""
    stamps = SECOND * numpy.arange(len(off))
    x, still = numpy.arange(len(off), dtype=float), numpy.zeros(len(off))
    poses = numpy.column_stack((x, off, still))
    columns = {STATUS: numpy.array(status), **columns}
    run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses),
              Updates(stamps, poses, numpy.zeros((len(off), 3, 3)), columns))
    run.set_truth(trajectory.Trajectory(stamps, numpy.column_stack((x, still, still))), 2.0)
    inliers = numpy.where(mapped, 0.9, 0.1)
    return wrong_map.measure(run, scan_match.ScanMatch(stamps, still, inliers, numpy.empty((0, 2)), still))


class RecoveryDistances(unittest.TestCase):
    def recoveries(self, mapped, errors):
        return wrong_map.recovery_distances(numpy.arange(len(mapped), dtype=float), numpy.array(mapped, bool),
                                            numpy.array(errors))

    def testIsTheDistanceUntilTheErrorIsSmall(self):
        self.assertEqual(self.recoveries([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.1] * 2 + [0.9] * 5 + [0.1] * 2), [2.0])
        self.assertEqual(self.recoveries([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.1] * 9), [0.0])
        self.assertEqual(self.recoveries([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.9] * 9), [math.inf])

    def testUnmappedDistanceIsNotCounted(self):
        self.assertEqual(self.recoveries([0, 0, 0, 0, 1, 1, 0, 1, 1, 1], [0.9] * 8 + [0.1] * 2), [3.0])

    def testShortStretchesAndTheLastOneAreIgnored(self):
        self.assertEqual(self.recoveries([1, 0, 0, 0, 1, 1, 0, 0, 0, 0], [0.9] * 10), [])


class Outcomes(unittest.TestCase):
    def testFractionsAreOfTheTime(self):
        outcome = measured([0.1, 0.6, 2.5, 0.7, 0.1, 0.1],
                           ["localized", "localized", "lost", "degraded", "lost", "localized"],
                           [True, False, False, True, True, True])
        self.assertEqual((outcome.unmapped, outcome.wrong, outcome.gross), (0.4, 0.6, 0.2))
        self.assertEqual((outcome.misleading, outcome.false_alarm), (0.2, 0.2))
        self.assertEqual(outcome.max_error, 2.5)
        self.assertAlmostEqual(outcome.rmse, math.sqrt((3 * 0.01 + 0.36 + 6.25 + 0.49) / 6))
        self.assertIsNone(outcome.above_level)

    def testLevelsAreEvaluatedPerAxis(self):
        levels = {f"level_{axis}": numpy.full(4, level)
                  for axis, level in (("along", 0.0), ("across", 0.2), ("heading", 0.1))}
        outcome = measured([0.1, 0.3, 0.1, 0.1], ["localized"] * 4, [True] * 4, **levels)
        self.assertEqual(outcome.above_level, (0.0, 0.25, 0.0))

    def testARowHasTheMaximumOfItsRuns(self):
        def outcome(worst, back, above):
            return wrong_map.Outcome(0.1, worst, 0.5, 0.25, 0.0, 0.0, 0.0, back, above)
        row = benchmark.row("a", [outcome(1.0, [2.0, 4.0], None), outcome(3.0, [math.inf], (0.0, 0.5, 1.0))])
        self.assertEqual((row["max"], row["wrong_percent"], row["recovery_mean"], row["recovery_max"]),
                         (3.0, 25.0, 3.0, 4.0))
        self.assertEqual((row["never_recovered"], row["recoveries"]), (1, 3))
        self.assertEqual(benchmark.cells(row)[-3:], ["3.0", "never 1 of 3", "0.00 / 50.00 / 100.00 %"])
        self.assertEqual(benchmark.cells(benchmark.row("a", [outcome(1.0, [], None)]))[-3:], ["–"] * 3)


class Program(unittest.TestCase):
    """The program over a short simulated drive."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.root = Path(cls.scratch.name) / "root"
        (cls.root / "corridor").mkdir(parents=True)
        for file in (programs.ROOT / "maps").glob("corridor.*"):
            shutil.copy(str(file), str(cls.root / "corridor"))
        programs.run("simulate_bag", ["--map", programs.ROOT / "maps/corridor.yaml", "--duration", 6,
                                      "--out", cls.root / "corridor/drive.bag",
                                      "--truth", cls.root / "corridor/drive_gt.tum"])

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def run_program(self, *arguments):
        return subprocess.run([str(programs.ROOT / "tools/benchmark_wrong_maps"), str(self.root), "--odom-topic",
                               "/vesc/odom", *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, check=False)

    def testRecordingsAreFoundWithTheirMapAndTruth(self):
        found = recordings.find_recordings(self.root, None)
        self.assertEqual([[path.name for path in recording] for recording in found],
                         [["drive.bag", "corridor.yaml", "drive_gt.tum"]])
        self.assertEqual(recordings.find_recordings(self.root, ["other"]), [])

    def testTableHasARowPerMapPerBuildingAndForAll(self):
        maps, table = self.root.parent / "maps", self.root.parent / "table.json"
        result = self.run_program("--windows", "0.6:0.9", "0.0:0.3,0.4:1.0", "--seeds", 2, "--leave-one-out",
                                  "--keep-maps", maps, "--json", table)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = json.loads(table.read_text())
        names = ["drive 0.6:0.9", "drive 0.0:0.3,0.4:1.0", "corridor, all maps", "overall"]
        self.assertEqual([row["map"] for row in rows], names)
        self.assertEqual([row["runs"] for row in rows], [2, 2, 4, 4])
        lines = result.stdout.decode().splitlines()
        self.assertTrue(all(line.startswith(name) for line, name in zip(lines[1:], names)))
        # A map with larger gaps explains less of the drive.
        self.assertLess(rows[0]["unmapped_percent"], rows[1]["unmapped_percent"])
        drawn = [load_map(maps / f"drive_without_{index}.yaml") for index in (1, 2)]
        known = [int((one.cells != UNKNOWN).sum()) for one in drawn]
        self.assertGreater(known[0], known[1])
        self.assertGreater(known[1], 0)
        self.assertEqual(drawn[0].origin, load_map(self.root / "corridor/corridor.yaml").origin)

    def testInvalidWindowsAreReported(self):
        for text in ("0.3", "0.5:0.2", "a:b", "0.5:1.5"):
            result = self.run_program("--windows", text)
            self.assertEqual(result.returncode, 2)
            self.assertIn(f"'{text}'; expected BEGIN:END", result.stderr.decode())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "benchmark_wrong_maps_test", "__main__", sysargs=sys.argv)
