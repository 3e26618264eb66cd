#!/usr/bin/python3
"""scripts/chaos: promises and their table, mistreated timelines, observed errors, /proc; one case with a roscore."""
import contextlib
import io
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy
import rosunit
from nav_msgs.msg import Odometry
from program_module import ROOT
from sensor_msgs.msg import LaserScan

from racecar_mcl_eval import EvaluationError, chaos
from racecar_mcl_eval.chaos import crowd, input_cases, node_cases, process, report, soak, timeline
from racecar_mcl_eval.chaos.observation import Observation, decode_pose, nearest_time, waiting_times
from racecar_mcl_eval.live_benchmark import ODOMETRY_TOPIC, SCAN_TOPIC
from racecar_mcl_eval.trajectory import Trajectory

LIMITS = [report.Limit("max error", 0.3, "m"), report.Limit("lost", 0, "", "d")]


def case(name="push", measure=None):
    return report.Case(name, "is pushed", LIMITS, measure)


def result(**values):
    return report.Result(case(), {key.replace("_", " "): value for key, value in values.items()})


class Report(unittest.TestCase):
    def testAPromiseHoldsUpToItsBound(self):
        self.assertTrue(report.passed(result(max_error=0.3, lost=0)))
        self.assertFalse(report.passed(result(max_error=0.31, lost=0)))
        self.assertFalse(report.passed(result(max_error=0.1, lost=1)))

    def testAValueThatIsMissingOrUndefinedBreaksThePromise(self):
        for value in (math.nan, math.inf):
            self.assertFalse(report.passed(result(max_error=value, lost=0)))
        self.assertFalse(report.passed(result(max_error=0.1)))
        self.assertIn("**lost: none**", report.row(result(max_error=0.1)))
        self.assertFalse(report.passed(report.Result(case(), None, "no master")))

    def testARowNamesPromiseAndMeasuredValues(self):
        self.assertEqual(report.row(result(max_error=0.456, lost=0)),
                         "| push | is pushed | max error at most 0.3 m; lost at most 0 | **max error 0.46 m**; lost 0 "
                         "| **FAIL** |")
        self.assertTrue(report.row(result(max_error=0.1, lost=0)).endswith("max error 0.10 m; lost 0 | pass |"))
        self.assertIn("| no master | **FAIL** |", report.row(report.Result(case(), None, "no master")))

    def testThePageHasTableDetailsAndSummary(self):
        page = report.page([result(max_error=0.1, lost=0), result(max_error=1.0, lost=0)], [("slope", "1 MB/h")])
        self.assertEqual(page.splitlines()[0], report.HEADING.splitlines()[0])
        self.assertIn("\n- slope: 1 MB/h\n\n1 passed, 1 failed: push\n", page)


class Program(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_chaos(self, *arguments, results=()):
        output = io.StringIO()
        with mock.patch.object(chaos, "run_cases", lambda *_: list(results)):
            with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
                status = chaos.main(list(arguments))
        return status, output.getvalue()

    def testTheExitStatusIsOneIfAPromiseIsBroken(self):
        good, bad = result(max_error=0.1, lost=0), result(max_error=1.0, lost=0)
        self.assertEqual(self.run_chaos(results=[good, good])[0], 0)
        status, output = self.run_chaos("--out", str(self.folder / "table.md"), results=[good, bad])
        self.assertEqual(status, 1)
        self.assertIn("1 passed, 1 failed: push", output)
        self.assertIn(report.row(bad), (self.folder / "table.md").read_text())

    def testListsEachCaseWithItsPromise(self):
        status, output = self.run_chaos("--list")
        self.assertEqual(status, 0)
        names = [line.split(":")[0] for line in output.splitlines()]
        self.assertEqual(names, [case.name for case in chaos.all_cases()])
        self.assertEqual(len(set(names)), len(names))
        self.assertEqual(output.count("Promise: "), len(names))

    def testSelectsCasesByName(self):
        _, output = self.run_chaos("--list", "--only", "busy", "killed")
        self.assertEqual([line.split(":")[0] for line in output.splitlines()], ["killed", "busy"])
        status, output = self.run_chaos("--only", "flod")
        self.assertEqual(status, 1)
        self.assertIn("no case 'flod'; expected some of killed, ", output)

    def testACaseThatCannotBeMeasuredHasFailed(self):
        failing = case(measure=mock.Mock(side_effect=EvaluationError("no master")))
        self.assertEqual(chaos.run_case(failing, None), report.Result(failing, None, "no master"))
        failing = case(measure=mock.Mock(side_effect=IndexError("empty")))
        self.assertEqual(chaos.run_case(failing, None), report.Result(failing, None, "IndexError: empty"))

    def testRefusesTimesThatAreNotPositive(self):
        for arguments in (["--seconds", "0"], ["--soak", "-1"], ["--reloads", "9"]):
            with self.assertRaises(SystemExit), contextlib.redirect_stderr(io.StringIO()):
                chaos.parse(arguments)


def message(at, topic=SCAN_TOPIC, content=b""):
    return timeline.Message(at, round(1e6 * at), topic, content, 0.0)


class Timelines(unittest.TestCase):
    def testAPauseDelaysMessagesAndKeepsTheirStamps(self):
        sent = timeline.paused([message(0.9), message(1.0), message(1.9), message(2.0)], 1.0, 2.0)
        self.assertEqual([m.at for m in sent], [0.9, 2.0, 2.0, 2.0])
        self.assertEqual([m.stamp for m in sent], [900000, 1000000, 1900000, 2000000])

    def testTheLastStepOfTheClockApplies(self):
        sent = timeline.clock_stepped([message(0.0), message(1.0), message(2.5)], [(1.0, -10.0), (2.0, 90.0)])
        self.assertEqual([m.clock for m in sent], [0.0, -10.0, 90.0])

    def testDoublesTheOdometryOnly(self):
        sent = timeline.doubled_odometry([message(0.0, ODOMETRY_TOPIC), message(0.5), message(1.0, ODOMETRY_TOPIC),
                                          message(3.0, ODOMETRY_TOPIC)])
        self.assertEqual([(m.at, m.stamp, m.topic) for m in sent],
                         [(0.0, 0, ODOMETRY_TOPIC), (0.5, 500000, SCAN_TOPIC), (0.5, 500000, ODOMETRY_TOPIC),
                          (1.0, 1000000, ODOMETRY_TOPIC), (2.0, 2000000, ODOMETRY_TOPIC),
                          (3.0, 3000000, ODOMETRY_TOPIC)])

    def testUnusableScansAreOfThreeKinds(self):
        scan = LaserScan(ranges=[1.0, 2.0])
        scan.header.frame_id = "laser"
        buffer = io.BytesIO()
        scan.serialize(buffer)
        empty, undefined, foreign = (LaserScan().deserialize(content)
                                     for content in timeline.unusable_scans(buffer.getvalue()))
        self.assertEqual((len(empty.ranges), empty.header.frame_id), (0, "laser"))
        self.assertTrue(numpy.isnan(undefined.ranges).all())
        self.assertEqual((foreign.ranges, foreign.header.frame_id), ((1.0, 2.0), timeline.FOREIGN_FRAME))
        scans = [message(at, content=buffer.getvalue()) for at in (0.0, 1.0, 2.0, 3.0)]
        sent, added = timeline.with_unusable_scans(scans, 1.0, 3.0)
        self.assertEqual(added, 2)
        self.assertEqual([m.at for m in sent], [0.0, 1.0, 1.5, 2.0, 2.5, 3.0])


def observation(arrivals=(), xs=(), lag=0.0, until=10.0, **observed):
    """Poses (x, 0, 0) of a car that stands in the origin."""
    arrivals = numpy.asarray(arrivals, dtype=float)
    truth = Trajectory(numpy.arange(1000, dtype=numpy.int64) * 10**8, numpy.zeros((1000, 3)))
    return Observation(arrivals, arrivals - lag, [(x, 0.0, 0.0) for x in xs], truth, until, **observed)


class Observed(unittest.TestCase):
    def testDecodesASerialisedPose(self):
        odometry = Odometry(child_frame_id="base_link")
        odometry.header.frame_id = "map"
        odometry.header.stamp.secs, odometry.header.stamp.nsecs = 12, 345678000
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = 1.5, -2.5
        odometry.pose.pose.orientation.z, odometry.pose.pose.orientation.w = math.sin(0.35), math.cos(0.35)
        buffer = io.BytesIO()
        odometry.serialize(buffer)
        stamp, x, y, yaw = decode_pose(buffer.getvalue())
        self.assertEqual((stamp, x, y), (12345678, 1.5, -2.5))
        self.assertAlmostEqual(yaw, 0.7)

    def testAStampBelongsToTheNearestStateOfTheClock(self):
        origins = [100 * 10**6, 90 * 10**6]
        self.assertEqual(nearest_time(105 * 10**6, 5.1, origins), 5.0)
        self.assertEqual(nearest_time(96 * 10**6, 6.1, origins), 6.0)

    def testMeasuresErrorsWithinAPeriod(self):
        seen = observation([1.0, 2.0, 3.0], [0.5, 0.1, 0.4])
        self.assertAlmostEqual(seen.max_error(2.0, 3.0), 0.1)
        self.assertAlmostEqual(seen.max_error(2.0), 0.4)
        self.assertTrue(math.isnan(seen.max_error(4.0)))

    def testAPoseIsBehindTheNewestScanUntilTheNextPose(self):
        # At 1.4 s a scan of 1.35 s is known, and the newest pose is that of 1.05 s.
        def lag(until):
            return observation([1.0, 1.1, 1.5, 1.6], [0.0] * 4, 0.05, until,
                               scans=[(0.9, 0.9), (1.0, 0.95), (1.4, 1.35), (2.5, 2.4)]).max_lag(0.0)
        self.assertAlmostEqual(lag(1.7), 0.3)
        self.assertAlmostEqual(lag(3.0), 0.85)
        self.assertTrue(math.isnan(observation([1.0], [0.0]).max_lag(0.0)))

    def testRecoveryEndsWithTheLastOtherStatus(self):
        seen = observation(statuses=[(1.0, "localized"), (2.0, "degraded"), (2.5, "localized"), (3.0, "lost"),
                                     (3.5, "localized")], until=4.0)
        self.assertAlmostEqual(seen.recovery(2.0), 1.5)
        self.assertAlmostEqual(seen.recovery(2.0, 3.0), 0.5)
        self.assertEqual(seen.recovery(2.0, 3.2), math.inf)
        self.assertEqual(seen.recovery(3.9), math.inf)

    def testMeasuresTheLongestTimeWithAnotherStatus(self):
        seen = observation(statuses=[(1.0, "localized"), (1.5, "degraded"), (1.8, "lost"), (2.2, "localized"),
                                     (2.5, "lost"), (2.7, "localized")], until=3.0)
        self.assertAlmostEqual(seen.longest_unlocalized(0.0), 0.7)
        self.assertEqual(seen.longest_unlocalized(3.0), math.inf)

    def testALocalizerThatFallsSilentIsNotLocalized(self):
        seen = observation(statuses=[(1.0, "localized"), (1.5, "localized")], until=9.0)
        self.assertAlmostEqual(seen.longest_unlocalized(0.0), 6.5)
        self.assertEqual(seen.recovery(1.0), math.inf)

    def testGrowthComparesTheLastSecondWithTheTimeBefore(self):
        samples = [process.Sample(time, resident, 20) for time, resident in
                   ((0.0, 10.0), (0.9, 12.0), (1.5, 40.0), (3.5, 14.0), (4.0, 16.0))]
        self.assertAlmostEqual(observation(samples=samples).growth(1.0), 3.0)
        self.assertTrue(math.isnan(observation(samples=samples).growth(0.0)))

    def testCountersIncreaseFromTheLastDiagnosticsBefore(self):
        seen = observation(diagnostics=[(0.0, {"a": "1"}), (1.0, {"a": "2", "b": "1"}), (3.0, {"a": "7", "b": "2"})])
        self.assertEqual(seen.counted(["a", "b"], 2.0), 6)
        self.assertEqual(seen.last_value("a"), 7.0)

    def testWaitsEndWithTheFirstAnswerAfterARequest(self):
        waits = waiting_times([1.0, 2.0, 3.0], [1.5, 0.5, 2.25])
        self.assertEqual(list(waits), [0.5, 0.25])

    def testLoopsOfABagEndWhereTimeGoesBack(self):
        loops = input_cases.loops_of([1.0, 6.0, 14.0, 13.9, 0.1, 7.0, 14.0, 0.2],
                                     [9.0, 0.1, 0.2, 0.3, 9.0, 0.4, 0.5, 9.0])
        self.assertEqual(loops, [[0.1, 0.2, 0.3], [0.4, 0.5]])


class Processes(unittest.TestCase):
    def testReadsTheResidentMemory(self):
        self.assertEqual(process.resident_megabytes("Name:\tx\nVmHWM:\t  9 kB\nVmRSS:\t    2048 kB\n"), 2.0)
        self.assertEqual(process.resident_megabytes("Name:\tzombie\n"), 0.0)

    def testSamplesARunningProcess(self):
        found = process.sample(os.getpid(), 1.5)
        self.assertGreater(found.resident, 10.0)
        with open(os.devnull, encoding="utf-8"):
            self.assertEqual(process.sample(os.getpid(), 2.0).descriptors, found.descriptors + 1)
        self.assertIsNone(process.sample(None, 0.0))

    def testAConnectionHeaderHasTheLengthOfEachField(self):
        header = crowd.connection_header({"a": "1", "topic": "/t"})
        self.assertEqual(header, struct.pack("<I", 19) + struct.pack("<I", 3) + b"a=1" + struct.pack("<I", 8) +
                         b"topic=/t")


class Reloads(unittest.TestCase):
    def testGrowthIgnoresTheFirstReloadsAndSingleValues(self):
        settling, steady = [10.0, 20.0, 30.0, 40.0, 50.0], [80.0, 80.0, 99.0, 80.0, 80.0]
        self.assertAlmostEqual(node_cases.reload_growth(settling + steady + steady), 0.0)
        self.assertAlmostEqual(node_cases.reload_growth(settling + steady + [88.0] * 5), 10.0)


class Soak(unittest.TestCase):
    def testReportsErrorsGrowthAndStatus(self):
        samples = [process.Sample(0.0, 40.0, 20), process.Sample(1800.0, 41.0, 22), process.Sample(3600.0, 42.0, 21)]
        changes = [(30.0, "localized"), (100.0, "degraded"), (102.5, "localized"), (3599.0, "lost")]
        values, details = soak.values_of([0.01, 0.03], changes, samples, 3600.0, 4.0)
        self.assertEqual(values["not localized for"], 2.5)
        self.assertAlmostEqual(values["growth"], 5.0)
        self.assertEqual(values["change of descriptors"], 1)
        details = dict(details)
        self.assertIn("slope +2.00 MB/h", details["resident memory"])
        self.assertEqual(details["changes of the status"], "3")
        self.assertTrue(details["position error"].startswith("mean 2.0 cm"))

    def testADriveWithoutAPoseIsAnError(self):
        with self.assertRaisesRegex(EvaluationError, "was not localized"):
            soak.values_of([], [], [], 60.0, 4.0)


class RunningLocalizer(unittest.TestCase):
    # With a roscore of its own.
    def testAPauseOfTheInputsIsSurvived(self):
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / "table.md"
            program = subprocess.run([str(ROOT / "scripts/chaos"), "--only", "paused", "--seconds", "3", "--out",
                                      str(table)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                     stderr=subprocess.PIPE, timeout=120, check=False)
            self.assertEqual(program.returncode, 0, program.stdout.decode() + program.stderr.decode())
            self.assertIn("| paused |", table.read_text())
            self.assertIn("1 passed, 0 failed", program.stdout.decode())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "chaos_test", "__main__", sysargs=sys.argv)
