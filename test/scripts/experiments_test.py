#!/usr/bin/python3
"""Plans and measures of scripts/experiments, without running programs."""
import contextlib
import io
import math
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import cv2
import numpy
import rosunit

from racecar_mcl_eval import EvaluationError, experiments, grid_map, programs, trajectory
from racecar_mcl_eval.experiments import (fault_injection, filter_steps, initialization,
                                          sensor_imperfections)
from racecar_mcl_eval.experiments.parameter_sweeps import parameter_value
from racecar_mcl_eval.experiments.runner import Runner, seeds_text
from racecar_mcl_eval.experiments.tracking import CORRIDOR


def errors_of(position, step=0.1):
    """Longitudinal errors (m) at a constant truth, `step` seconds apart."""
    count = len(position)
    stamps = (numpy.arange(count) * step * 1e9).astype(numpy.int64)
    estimate = numpy.column_stack([position, numpy.zeros(count), numpy.zeros(count)])
    return trajectory.compare(trajectory.Trajectory(stamps, estimate),
                              trajectory.Trajectory(stamps, numpy.zeros((count, 3))))


class Plans(unittest.TestCase):
    def setUp(self):
        self.runner = Runner(Path("/out"))
        self.drive = self.runner.drive(CORRIDOR, "--seed", 1)

    def testSharesIdenticalRuns(self):
        self.assertIs(self.runner.drive(CORRIDOR, "--seed", "1"), self.drive)
        first = self.runner.replay(self.drive, "report", seed=1)
        self.assertIs(self.runner.replay(self.drive, "report", seed=1), first)
        others = {self.runner.replay(self.drive, "report", seed=2).folder,
                  self.runner.replay(self.drive, "default", seed=1).folder,
                  self.runner.replay(self.drive, "report", seed=1, settings=("sigma_hit:=2",)).folder,
                  self.runner.replay(self.drive, "report", seed=1, timed=True).folder}
        self.assertEqual(len(others | {first.folder}), 5)

    def testCommandsAreShellCommands(self):
        replay = self.runner.replay(self.drive, "report", seed=7, settings=("sigma_hit:=2",))
        self.assertEqual(self.runner.commands(self.drive, replay, replay), [
            "rosrun racecar_mcl simulate_bag --map maps/corridor.yaml --seed 1 "
            "--out OUT/drives/corridor-01.bag --truth OUT/drives/corridor-01.tum",
            "rosrun racecar_mcl replay --bag OUT/drives/corridor-01.bag --map maps/corridor.yaml "
            "--truth OUT/drives/corridor-01.tum --config config/report.yaml --initial-pose-from-truth "
            "--seed 7 --set sigma_hit:=2 --out OUT/runs/run-001"])

    def testStagesAreNamedInAFileAsTheyBegin(self):
        with tempfile.TemporaryDirectory() as folder:
            runner = Runner(Path(folder), jobs=1)
            drive = runner.drive(CORRIDOR, "--seed", 1)
            runner.replay(drive, "report")
            runner.replay(drive, "default")
            printed = []

            def run(program, words):
                printed.append((program, log.getvalue().splitlines()))
            with contextlib.redirect_stderr(io.StringIO()) as log, mock.patch.object(programs, "run", run):
                runner.execute()
        driving, localizing = "driving: 1 of 3 runs", "localizing: 2 of 3 runs"
        self.assertEqual(printed, [("simulate_bag", [driving]), ("replay", [driving, localizing]),
                                   ("replay", [driving, localizing])])

    def testEveryExperimentPlansASeededDrive(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, experiment in experiments.EXPERIMENTS.items():
                runner = Runner(Path(folder), quick=True)
                experiment().plan(runner)
                for drive in runner._drives:
                    self.assertIn("--seed", drive[1], name)

    def testAFailedProgramRaisesItsMessage(self):
        with tempfile.TemporaryDirectory() as folder:
            runner = Runner(Path(folder))
            runner.drive(Path(folder) / "none.yaml", "--seed", 1)
            with self.assertRaisesRegex(EvaluationError, "none.yaml"):
                runner.execute()

    def testSeedsAsText(self):
        self.assertEqual([seeds_text((1,)), seeds_text((1, 2, 3))], ["seed 1", "seeds 1, 2, 3"])


class Measures(unittest.TestCase):
    def testConvergedIsBelowTheLimitAndStaysThere(self):
        for position, seconds in (([1.0] * 5 + [0.05] * 20, 0.5),
                                  ([0.05] * 5 + [1.0] + [0.05] * 20, 0.6),  # too short
                                  ([0.05] * 20 + [1.0] * 5, 0.0),           # later errors do not matter
                                  ([1.0] * 20 + [0.05] * 5, None),
                                  ([1.0] * 20, None)):
            found = initialization.seconds_to_converge(errors_of(position), 0)
            self.assertEqual(found if found is None else round(found, 6), seconds)

    def testAliasIsTheTruthRotatedAboutTheCentre(self):
        stamps = numpy.array([0, 10**8])
        truth = trajectory.Trajectory(stamps, numpy.array([(8.0, 0.5, 0.0)] * 2))
        estimate = trajectory.Trajectory(stamps, numpy.array([(8.1, 0.5, 0.0), (-8.1, -0.5, math.pi)]))
        errors = trajectory.compare(estimate, truth)
        numpy.testing.assert_array_equal(initialization.PoseEstimators._at_alias(errors), [False, True])
        self.assertEqual(initialization.PoseEstimators._jumps(errors), 1)

    def testCorridorIsSymmetricExceptForOneNiche(self):
        with tempfile.TemporaryDirectory() as folder:
            initialization.write_symmetric_corridor(Path(folder))
            free = cv2.imread(str(Path(folder) / "symmetric.png"), cv2.IMREAD_GRAYSCALE) == 254
        columns = numpy.flatnonzero((free != free[::-1, ::-1]).any(axis=0)) * 0.05 - 22.0
        self.assertLess(numpy.abs(numpy.abs(columns) - 19.4).max(), 0.7)

    def testOutdatedMapHasPatchesOfBothKinds(self):
        with tempfile.TemporaryDirectory() as folder:
            outdated = grid_map.load_map(sensor_imperfections.write_outdated_map(Path(folder), CORRIDOR))
        correct = grid_map.load_map(CORRIDOR)
        mapped, real = (plan.cells == grid_map.OCCUPIED for plan in (outdated, correct))
        self.assertGreater((mapped & ~real).sum(), 1000)
        self.assertGreater((real & ~mapped).sum(), 500)
        self.assertGreater((mapped & real).sum(), 1000)

    def testTableByFormulaIsNormalised(self):
        table = filter_steps.table_by_formula()
        self.assertEqual(table.shape, (201, 201))
        numpy.testing.assert_allclose(table.sum(axis=0), 1.0)
        self.assertEqual(table[:200, 100].argmax(), 100)

    def testParametersAreReadFromTheirSet(self):
        self.assertEqual(parameter_value("report", "sigma_hit"), 8.0)
        self.assertEqual(parameter_value("report", "field_scale"), parameter_value("default", "field_scale"))
        with self.assertRaises(EvaluationError):
            parameter_value("report", "nothing")

    def testDriveThatIsNeverLocalizedHasInfiniteTime(self):
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "drives.csv"
            table.write_text("map,fault,seed,localized,noticed,longest_wrong_trust\n"
                             "m,kidnap,1,0.300,0.125,0.025\nm,kidnap,2,,,0.500\n", encoding="utf-8")
            self.assertEqual(fault_injection.seconds_until_localized(table), [0.3, math.inf])


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "experiments_test", "__main__", sysargs=sys.argv)
