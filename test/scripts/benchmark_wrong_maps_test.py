#!/usr/bin/python3
"""What scripts/benchmark_wrong_maps measures, against cases worked out by hand, and the program itself."""
import importlib.machinery
import importlib.util
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

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
from racecar_mcl_eval import programs, recordings, scan_fit, trajectory, wrong_map  # noqa: E402
from racecar_mcl_eval.grid_map import UNKNOWN, load_map  # noqa: E402
from racecar_mcl_eval.run import Run, Updates  # noqa: E402

SECOND = 10**9  # ns


def load(name):
    loader = importlib.machinery.SourceFileLoader(name, str(SCRIPTS / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


benchmark = load("benchmark_wrong_maps")


def measured(off, verdicts, mapped, **columns):
    """A scan a second and a metre, with an estimate beside the truth by so much."""
    stamps = SECOND * numpy.arange(len(off))
    x, still = numpy.arange(len(off), dtype=float), numpy.zeros(len(off))
    poses = numpy.column_stack((x, off, still))
    columns = {"verdict": numpy.array(verdicts), **columns}
    run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses),
              Updates(stamps, poses, numpy.zeros((len(off), 3, 3)), columns))
    run.set_truth(trajectory.Trajectory(stamps, numpy.column_stack((x, still, still))), 2.0)
    near = numpy.where(mapped, 0.9, 0.1)
    return wrong_map.measure(run, scan_fit.ScanFit(stamps, still, near, numpy.empty((0, 2)), still))


class Returns(unittest.TestCase):
    def returns(self, mapped, errors):
        return wrong_map.returns(numpy.arange(len(mapped), dtype=float), numpy.array(mapped, bool),
                                 numpy.array(errors))

    def testCountsTheMetresUntilTheErrorIsSmallAgain(self):
        self.assertEqual(self.returns([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.1] * 2 + [0.9] * 5 + [0.1] * 2), [2.0])
        self.assertEqual(self.returns([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.1] * 9), [0.0])
        self.assertEqual(self.returns([1, 0, 0, 0, 0, 1, 1, 1, 1], [0.9] * 9), [math.inf])

    def testMetresThatTheMapDoesNotExplainAreNotCounted(self):
        self.assertEqual(self.returns([0, 0, 0, 0, 1, 1, 0, 1, 1, 1], [0.9] * 8 + [0.1] * 2), [3.0])

    def testShortStretchesAndTheLastOneAreLeftOut(self):
        self.assertEqual(self.returns([1, 0, 0, 0, 1, 1, 0, 0, 0, 0], [0.9] * 10), [])


class Outcomes(unittest.TestCase):
    def testSharesAreOfTheTime(self):
        told = measured([0.1, 0.6, 2.5, 0.7, 0.1, 0.1],
                        ["localized", "localized", "lost", "degraded", "lost", "localized"],
                        [True, False, False, True, True, True])
        self.assertEqual((told.lacking, told.off, told.far_off), (0.4, 0.6, 0.2))
        self.assertEqual((told.trusted_wrong, told.alarmed_right), (0.2, 0.2))
        self.assertEqual(told.max_error, 2.5)
        self.assertAlmostEqual(told.rmse, math.sqrt((3 * 0.01 + 0.36 + 6.25 + 0.49) / 6))
        self.assertIsNone(told.above_level)

    def testLevelsAreToldPerAxis(self):
        levels = {f"level_{axis}": numpy.full(4, level)
                  for axis, level in (("along", 0.0), ("across", 0.2), ("heading", 0.1))}
        told = measured([0.1, 0.3, 0.1, 0.1], ["localized"] * 4, [True] * 4, **levels)
        self.assertEqual(told.above_level, (0.0, 0.25, 0.0))

    def testARowHasTheWorstOfItsRuns(self):
        def outcome(worst, back, above):
            return wrong_map.Outcome(0.1, worst, 0.5, 0.25, 0.0, 0.0, 0.0, back, above)
        row = benchmark.row("a", [outcome(1.0, [2.0, 4.0], None), outcome(3.0, [math.inf], (0.0, 0.5, 1.0))])
        self.assertEqual((row["max"], row["off_percent"], row["back_mean"], row["back_max"]),
                         (3.0, 25.0, 3.0, 4.0))
        self.assertEqual((row["never_back"], row["returns"]), (1, 3))
        self.assertEqual(benchmark.cells(row)[-3:], ["3.0", "never 1 of 3", "0.00 / 50.00 / 100.00 %"])
        self.assertEqual(benchmark.cells(benchmark.row("a", [outcome(1.0, [], None)]))[-3:], ["–"] * 3)


class Program(unittest.TestCase):
    """Over a short simulated drive, as a recording of its own building."""

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
        return subprocess.run([str(SCRIPTS / "benchmark_wrong_maps"), str(self.root), "--odom-topic",
                               "/vesc/odom", *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, check=False)

    def testRecordingsAreFoundWithTheirMapAndTruth(self):
        found = recordings.find_recordings(self.root, None)
        self.assertEqual([[path.name for path in recording] for recording in found],
                         [["drive.bag", "corridor.yaml", "drive_gt.tum"]])
        self.assertEqual(recordings.find_recordings(self.root, ["other"]), [])

    def testEveryMapHasARowAndEveryBuildingWithAllAnother(self):
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
        # The more a map lacks, the less of the drive it explains.
        self.assertLess(rows[0]["lacking_percent"], rows[1]["lacking_percent"])
        drawn = [load_map(maps / f"drive_without_{index}.yaml") for index in (1, 2)]
        known = [int((one.cells != UNKNOWN).sum()) for one in drawn]
        self.assertGreater(known[0], known[1])
        self.assertGreater(known[1], 0)
        self.assertEqual(drawn[0].origin, load_map(self.root / "corridor/corridor.yaml").origin)

    def testWindowsThatAreNoneAreNamed(self):
        for text in ("0.3", "0.5:0.2", "a:b", "0.5:1.5"):
            result = self.run_program("--windows", text)
            self.assertEqual(result.returncode, 2)
            self.assertIn(f"'{text}'; expected BEGIN:END", result.stderr.decode())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "benchmark_wrong_maps_test", "__main__", sysargs=sys.argv)
