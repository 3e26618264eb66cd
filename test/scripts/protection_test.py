#!/usr/bin/python3
"""Evaluation of protection levels against hand-calculated cases, and their section in the report."""
import contextlib
import csv
import io
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

import numpy
import rosunit

from racecar_mcl_eval import evaluate, protection, trajectory
from racecar_mcl_eval.columns import INLIER_RATIO, STATUS
from racecar_mcl_eval.run import Run, Updates

SECOND = 10**9  # ns
UNBOUNDED = math.inf


def run_of(errors, levels, status, yaw=0.0, columns=None):
    """A run whose updates are off by `errors` (x, y, yaw) of a stationary car with heading `yaw`."""
    stamps = numpy.arange(len(errors)) * SECOND // 10
    truth = numpy.zeros((len(errors), 3)) + (0.0, 0.0, yaw)
    poses = truth + errors
    columns = {**(columns or {}), STATUS: numpy.array(status)}
    if levels is not None:
        columns.update((f"level_{axis}", numpy.array(of_axis, dtype=float))
                       for axis, of_axis in zip(protection.AXES, zip(*levels)))
    run = Run("run", Path("run"), trajectory.Trajectory(stamps, poses),
              Updates(stamps, poses, numpy.zeros((len(errors), 3, 3)), columns))
    run.set_truth(trajectory.Trajectory(stamps, truth), 0.5)
    return run


class Levels(unittest.TestCase):
    def testErrorsAreInTheEstimatedFrame(self):
        run = run_of([(0.2, -0.3, 0.0)], [(1.0, 1.0, 1.0)], ["localized"], yaw=math.pi / 2)
        numpy.testing.assert_allclose(protection.measure(run, 0.5).errors, [(0.3, 0.2, 0.0)], atol=1e-12)
        # The estimated heading counts, not the true one.
        run = run_of([(0.2, 0.0, math.pi / 2)], [(1.0, 1.0, 1.0)], ["localized"])
        numpy.testing.assert_allclose(protection.measure(run, 0.5).errors, [(0.0, 0.2, math.pi / 2)],
                                      atol=1e-12)

    def testUpdatesAboveTheirLevelsAreCounted(self):
        run = run_of([(0.2, 0.0, 0.0), (0.1, 0.0, 0.0), (-0.4, 0.0, 0.0), (5.0, 0.0, 0.0)],
                     [(0.1, 0.1, 0.1), (0.1, 0.1, 0.1), (0.3, 0.1, 0.1), (UNBOUNDED, UNBOUNDED, math.pi)],
                     ["localized", "localized", "degraded", "lost"])
        measured = protection.measure(run, 0.5)
        self.assertAlmostEqual(measured.fraction_above(0), 2 / 4)
        self.assertAlmostEqual(measured.fraction_above_while_localized(0), 1 / 2)
        self.assertEqual(measured.fraction_above(1), 0.0)
        numpy.testing.assert_allclose(measured.medians_while_localized(0), (0.1, 0.15))

    def testEveryUpdateIsInOneRegion(self):
        run = run_of([(0.1, 0.0, 0.0), (0.3, 0.0, 0.0), (0.3, 0.0, 0.0), (9.0, 0.0, 0.0), (9.0, 0.0, 0.0)],
                     [(0.2, 9.0, 3.0), (0.2, 9.0, 3.0), (0.6, 9.0, 3.0), (8.0, 9.0, 3.0), (0.4, 9.0, 3.0)],
                     ["localized"] * 5)
        measured = protection.measure(run, 0.5)
        self.assertEqual(measured.regions(0), {"nominal": 0.2, "misleading": 0.6, "unavailable": 0.2})
        self.assertEqual(measured.regions(1), {"nominal": 0.0, "misleading": 0.0, "unavailable": 1.0})
        # The heading has no alarm limit.
        self.assertEqual(measured.regions(2), {"nominal": 1.0, "misleading": 0.0, "unavailable": 0.0})

    def testMediansAreNoneIfNeverLocalized(self):
        measured = protection.measure(run_of([(1.0, 0.0, 0.0)], [(UNBOUNDED, UNBOUNDED, math.pi)], ["lost"]), 0.5)
        self.assertIsNone(measured.medians_while_localized(0))
        self.assertIsNone(measured.fraction_above_while_localized(0))

    def testResultsWithoutLevelsAreAccepted(self):
        self.assertIsNone(protection.measure(run_of([(0.1, 0.0, 0.0)], None, ["localized"]), 0.5))


class InTheReport(unittest.TestCase):
    """scripts/evaluate over hand-made output folders of replay."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        self.stamps = numpy.arange(1, 41) * SECOND // 10
        self.truth = numpy.column_stack([0.1 * numpy.arange(40), numpy.zeros(40), numpy.zeros(40)])

    def write(self, name, more):
        """A run with an error of 2 cm; `more`: columns in addition to those of every version."""
        folder = self.folder / name
        folder.mkdir()
        estimate = trajectory.Trajectory(self.stamps, self.truth + (0.0, 0.02, 0.0))
        trajectory.write_tum(estimate, folder / "trajectory.tum")
        trajectory.write_tum(trajectory.Trajectory(self.stamps, self.truth), self.folder / "truth.tum")
        (folder / "summary.json").write_text(json.dumps({"update_ms": {"mean": 1.0, "p99": 2.0}}))
        with open(folder / "updates.csv", "w", encoding="utf-8", newline="") as file:
            always = {f"cov_{name}": 1e-4 if name in ("xx", "yy", "yawyaw") else 0.0
                      for name in ("xx", "xy", "xyaw", "yy", "yyaw", "yawyaw")}
            table = None
            for stamp, (x, y, yaw) in zip(self.stamps, estimate.poses):
                row = {"stamp": trajectory.format_stamp(stamp), "x": x, "y": y, "yaw": yaw, **always,
                       "outcome": "used", **more}
                table = table or csv.DictWriter(file, row)
                if file.tell() == 0:
                    table.writeheader()
                table.writerow(row)
        return folder

    def evaluate(self, *folders):
        """The text of the report, stdout, and the names of the figures."""
        page = self.folder / "page"
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            self.assertEqual(evaluate.main([*map(str, folders), "--truth", str(self.folder / "truth.tum"),
                                            "--out", str(page)]), 0)
        return ((page / "index.html").read_text(encoding="utf-8"), printed.getvalue(),
                {path.stem for path in page.glob("*.png")})

    def testLevelsAreReportedPerAxis(self):
        measured = {INLIER_RATIO: 0.9, "obstructed": 0.05, "contradicted": 0.03, "unmapped": 0.02, "conflict": 0.1,
                    "carried": 0.0, "range_bias": 0.0, "level_along": 0.1, "level_across": 0.01,
                    "level_heading": "inf", STATUS: "localized", "reason": "none"}
        text, printed, figures = self.evaluate(self.write("new", measured))
        self.assertIn("0.00 % along, 100.00 % across, 0.00 % heading", printed)
        self.assertIn("Protection level", text)
        self.assertIn('<td class="bad">100.00</td>', text)
        self.assertIn("<td>0.010 m</td><td>0.020 m</td><td>0.5</td>", text)
        self.assertLessEqual({"stanford-1", "status-1"}, figures)

    def testOlderResultsAreComparedWithNewOnes(self):
        levels = {f"level_{axis}": 0.5 for axis in protection.AXES}
        text, printed, figures = self.evaluate(
            self.write("oldest", {}), self.write("older", {INLIER_RATIO: 0.9, STATUS: "degraded"}),
            self.write("new", {STATUS: "localized", **levels}))
        self.assertEqual(figures & {f"{kind}-{index}" for kind in ("stanford", "status") for index in (1, 2, 3)},
                         {"status-2", "stanford-3", "status-3"})
        self.assertEqual(printed.count("above the level"), 1)

    def testWithoutLevelsTheSectionIsMissing(self):
        text, printed, _ = self.evaluate(self.write("old", {STATUS: "lost"}))
        self.assertNotIn("Protection level", text)
        self.assertNotIn("level", printed)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "protection_test", "__main__", sysargs=sys.argv)
