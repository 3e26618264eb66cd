#!/usr/bin/python3
"""What scripts/experiments plans and measures, without running the programs."""
import math
import sys
import tempfile
import unittest
from pathlib import Path

import cv2
import numpy
import rosunit

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
from racecar_mcl_eval import EvaluationError, experiments, grid_map, programs, trajectory  # noqa: E402
from racecar_mcl_eval.experiments import filter_parts, imperfect, starts, sweeps, trouble  # noqa: E402
from racecar_mcl_eval.experiments.workshop import Workshop, seeds_text  # noqa: E402


def errors_of(position, step=0.1):
    """Errors of these sizes (m), ahead of a truth that stands still, `step` seconds apart."""
    count = len(position)
    stamps = (numpy.arange(count) * step * 1e9).astype(numpy.int64)
    estimate = numpy.column_stack([position, numpy.zeros(count), numpy.zeros(count)])
    return trajectory.compare(trajectory.Trajectory(stamps, estimate),
                              trajectory.Trajectory(stamps, numpy.zeros((count, 3))))


class Plans(unittest.TestCase):
    def setUp(self):
        self.workshop = Workshop(Path("/out"))
        self.drive = self.workshop.drive(programs.ROOT / "maps/corridor.yaml", "--seed", 1)

    def testNothingIsRunTwice(self):
        self.assertIs(self.workshop.drive(programs.ROOT / "maps/corridor.yaml", "--seed", "1"), self.drive)
        first = self.workshop.replay(self.drive, "report", seed=1)
        self.assertIs(self.workshop.replay(self.drive, "report", seed=1), first)
        others = {self.workshop.replay(self.drive, "report", seed=2).folder,
                  self.workshop.replay(self.drive, "default", seed=1).folder,
                  self.workshop.replay(self.drive, "report", seed=1, settings=("sigma_hit:=2",)).folder,
                  self.workshop.replay(self.drive, "report", seed=1, timed=True).folder}
        self.assertEqual(len(others | {first.folder}), 5)

    def testCommandsAreAsOneWouldTypeThem(self):
        replay = self.workshop.replay(self.drive, "report", seed=7, settings=("sigma_hit:=2",))
        self.assertEqual(self.workshop.commands(self.drive, replay, replay), [
            "rosrun racecar_mcl simulate_bag --map maps/corridor.yaml --seed 1 "
            "--out OUT/drives/corridor-01.bag --truth OUT/drives/corridor-01.tum",
            "rosrun racecar_mcl replay --bag OUT/drives/corridor-01.bag --map maps/corridor.yaml "
            "--truth OUT/drives/corridor-01.tum --config config/report.yaml --initial-pose-from-truth "
            "--seed 7 --set sigma_hit:=2 --out OUT/runs/run-001"])

    def testEveryExperimentPlansASeededDrive(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, experiment in experiments.EXPERIMENTS.items():
                workshop = Workshop(Path(folder), quick=True)
                experiment().plan(workshop)
                for drive in workshop._drives:
                    self.assertIn("--seed", drive[1], name)

    def testFailureOfAProgramEndsTheWorkWithItsWords(self):
        with tempfile.TemporaryDirectory() as folder:
            workshop = Workshop(Path(folder))
            workshop.drive(Path(folder) / "none.yaml", "--seed", 1)
            with self.assertRaisesRegex(EvaluationError, "none.yaml"):
                workshop.work()

    def testSeedsAreWordedForOneAndMany(self):
        self.assertEqual([seeds_text((1,)), seeds_text((1, 2, 3))], ["seed 1", "seeds 1, 2, 3"])


class Measures(unittest.TestCase):
    def testConvergedIsBelowTheLimitAndStaysThere(self):
        for position, seconds in (([1.0] * 5 + [0.05] * 20, 0.5),
                                  ([0.05] * 5 + [1.0] + [0.05] * 20, 0.6),  # half a second does not count
                                  ([0.05] * 20 + [1.0] * 5, 0.0),           # lost later is another thing
                                  ([1.0] * 20 + [0.05] * 5, None),
                                  ([1.0] * 20, None)):
            found = starts.seconds_to_converge(errors_of(position), 0)
            self.assertEqual(found if found is None else round(found, 6), seconds)

    def testTwinIsHalfATurnAboutTheMiddle(self):
        stamps = numpy.array([0, 10**8])
        truth = trajectory.Trajectory(stamps, numpy.array([(8.0, 0.5, 0.0)] * 2))
        estimate = trajectory.Trajectory(stamps, numpy.array([(8.1, 0.5, 0.0), (-8.1, -0.5, math.pi)]))
        errors = trajectory.compare(estimate, truth)
        numpy.testing.assert_array_equal(starts.ThreeEstimates._at_twin(errors), [False, True])
        self.assertEqual(starts.ThreeEstimates._jumps(errors), 1)

    def testCorridorIsItsOwnTwinButForOneNiche(self):
        with tempfile.TemporaryDirectory() as folder:
            starts.write_twin_corridor(Path(folder))
            free = cv2.imread(str(Path(folder) / "twin.png"), cv2.IMREAD_GRAYSCALE) == 254
        columns = numpy.flatnonzero((free != free[::-1, ::-1]).any(axis=0)) * 0.05 - 22.0
        self.assertLess(numpy.abs(numpy.abs(columns) - 19.4).max(), 0.7)

    def testStaleMapDiffersInPatchesOfBothKinds(self):
        with tempfile.TemporaryDirectory() as folder:
            stale = grid_map.load_map(imperfect.write_stale_map(Path(folder), imperfect.CORRIDOR))
        right = grid_map.load_map(imperfect.CORRIDOR)
        shown, there = (plan.cells == grid_map.OCCUPIED for plan in (stale, right))
        self.assertGreater((shown & ~there).sum(), 1000)
        self.assertGreater((there & ~shown).sum(), 500)
        self.assertGreater((shown & there).sum(), 1000)

    def testTableOfTheEquationsIsNormalised(self):
        table = filter_parts.table_by_formula()
        self.assertEqual(table.shape, (201, 201))
        numpy.testing.assert_allclose(table.sum(axis=0), 1.0)
        self.assertEqual(table[:200, 100].argmax(), 100)

    def testConstantsAreReadFromTheirSet(self):
        self.assertEqual(sweeps.constant("report", "sigma_hit"), 8.0)
        self.assertEqual(sweeps.constant("report", "field_sigma"), sweeps.constant("default", "field_sigma"))
        with self.assertRaises(EvaluationError):
            sweeps.constant("report", "nothing")

    def testDriveThatIsNeverLocalizedTakesForEver(self):
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "drives.csv"
            table.write_text("map,trouble,seed,localized,noticed,longest_wrong_trust\n"
                             "m,kidnap,1,0.300,0.125,0.025\nm,kidnap,2,,,0.500\n", encoding="utf-8")
            self.assertEqual(trouble.seconds_until_localized(table), [0.3, math.inf])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "experiments_test", "__main__", sysargs=sys.argv)
