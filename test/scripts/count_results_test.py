#!/usr/bin/python3
"""The last line of scripts/test counts the tests that ran and those that should have."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

PROGRAM = Path(__file__).resolve().parents[2] / "scripts/lib/count_results.py"

PASSED = '<testcase classname="A" name="Passes" status="run" result="completed"/>'
FAILED = '<testcase classname="A" name="Fails" status="run"><failure message="no"/></testcase>'
SKIPPED = '<testcase classname="A" name="Skips" status="run" result="skipped"/>'
DISABLED = '<testcase classname="A" name="Off" status="notrun"/>'


class CountResults(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "build"
        (self.folder / "test_results/racecar_mcl").mkdir(parents=True)
        (self.folder / "Testing/Temporary").mkdir(parents=True)

    def select(self, *names):
        tests = {"tests": [{"name": name} for name in names]}
        (self.folder / "selected_tests.json").write_text(json.dumps(tests), encoding="utf-8")

    def results(self, name, *cases):
        text = f"<testsuites><testsuite>{''.join(cases)}</testsuite></testsuites>"
        (self.folder / "test_results" / f"{name}.xml").write_text(text, encoding="utf-8")

    def programFailed(self, name):
        log = self.folder / "Testing/Temporary/LastTestsFailed.log"
        log.write_text(f"1:{name}\n", encoding="utf-8")

    def count(self, *arguments):
        run = subprocess.run([sys.executable, str(PROGRAM), str(self.folder), *arguments],
                             check=False, stdout=subprocess.PIPE, universal_newlines=True)
        return run.stdout.splitlines()[-1], run.returncode

    def testCountsPassedAndSkipped(self):
        self.select("unit")
        self.results("unit", PASSED, PASSED, SKIPPED, DISABLED)
        self.assertEqual(self.count(), ("2 passed, 0 failed, 2 skipped", 0))

    def testAFailureFails(self):
        self.select("unit")
        self.results("unit", PASSED, FAILED)
        self.programFailed("unit")
        self.assertEqual(self.count(), ("1 passed, 1 failed", 1))

    def testAProgramWithoutResultsFails(self):
        self.select("unit", "crashed")
        self.results("unit", PASSED)
        self.assertEqual(self.count(), ("1 passed, 1 failed", 1))

    def testAProgramThatFailsAfterItsTestsFails(self):
        self.select("leaky")
        self.results("leaky", PASSED)
        self.programFailed("leaky")
        self.assertEqual(self.count(), ("1 passed, 1 failed", 1))

    def testResultsCutShortFail(self):
        self.select("unit")
        (self.folder / "test_results/unit.xml").write_text("<testsuites><tests", encoding="utf-8")
        self.assertEqual(self.count(), ("0 passed, 1 failed", 1))

    def testNothingSelectedFails(self):
        self.select()
        self.assertEqual(self.count(), ("0 passed, 1 failed", 1))

    def testOtherChecksCount(self):
        self.select("unit")
        self.results("unit", PASSED)
        self.assertEqual(self.count("--passed", "the demo"), ("2 passed, 0 failed", 0))
        self.assertEqual(self.count("--failed", "the build"), ("1 passed, 1 failed", 1))

    def testRostestsAreCountedByTheirInnerCases(self):
        wrapper = '<testcase classname="rostest.runner.RosTest" name="testinner"{}'
        self.select("node")
        self.results("racecar_mcl/rosunit-inner", PASSED, PASSED)
        self.results("racecar_mcl/rostest-node", wrapper.format("/>"))
        self.assertEqual(self.count(), ("2 passed, 0 failed", 0))
        # A failure inside is counted once, whether or not the wrapper repeats it.
        self.programFailed("node")
        self.results("racecar_mcl/rosunit-inner", PASSED, FAILED)
        self.assertEqual(self.count(), ("1 passed, 1 failed", 1))
        failed_wrapper = wrapper.format("><failure/></testcase>")
        self.results("racecar_mcl/rostest-node", failed_wrapper)
        self.assertEqual(self.count(), ("1 passed, 1 failed", 1))
        # A program that died has no results of its own.
        (self.folder / "test_results/racecar_mcl/rosunit-inner.xml").unlink()
        self.assertEqual(self.count(), ("0 passed, 1 failed", 1))


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "count_results_test", CountResults, sysargs=sys.argv)
