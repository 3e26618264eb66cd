#!/usr/bin/python3
"""Counts the test results of one or more build folders from the files of ctest and the tests.

The last line is `N passed, N failed` (and `, N skipped`). A test program that wrote no results, or failed
without a failed test, counts as one failure, so that a crash does not look like fewer tests. Exit status 1 if
something failed or nothing ran.
"""
import argparse
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

# rostest adds one wrapper case per test program; the program's cases are in a file of their own.
ROSTEST_CLASS = "rostest.runner.RosTest"


class Count:
    def __init__(self):
        self.passed = 0
        self.skipped = 0
        self.failures = []

    def fail(self, where, what):
        self.failures.append(f"{where}: {what}")


def is_skipped(case):
    # gtest marks a skipped case in `result` (since 1.11 also as a child), a disabled case in `status`.
    return (case.find("skipped") is not None or case.get("result") == "skipped" or
            case.get("status") == "notrun")


def count_cases(path, where, count):
    """Adds the cases of one results file. Returns the number of its cases and of the failed ones."""
    try:
        cases = list(ElementTree.parse(path).getroot().iter("testcase"))
    except ElementTree.ParseError as error:
        count.fail(where, f"{path.name} is incomplete: {error}")
        return 1, 1
    failed = 0
    for case in cases:
        wrapped = case.get("classname") == ROSTEST_CLASS
        inside = wrapped and has_failure(path.with_name(f"rosunit-{case.get('name')[len('test'):]}.xml"))
        if inside:
            failed += 1  # counted in the program's own file
        elif case.find("failure") is not None or case.find("error") is not None:
            failed += 1
            count.fail(where, f"{case.get('classname')}.{case.get('name')}")
        elif is_skipped(case):
            count.skipped += 1
        elif not wrapped:
            count.passed += 1
    return len(cases), failed


def has_failure(path):
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError):
        return False
    return root.find(".//failure") is not None or root.find(".//error") is not None


def selected_tests(folder):
    """The names of the tests that ctest was to run, saved by scripts/test."""
    with open(folder / "selected_tests.json", encoding="utf-8") as file:
        return [test["name"] for test in json.load(file)["tests"]]


def failed_programs(folder):
    log = folder / "Testing/Temporary/LastTestsFailed.log"
    if not log.exists():
        return set()
    return {re.sub(r"^\d+:", "", line) for line in log.read_text().split()}


def count_folder(folder, count):
    results = {path.stem: path for path in sorted((folder / "test_results").rglob("*.xml"))}
    outcome = {}
    for name, path in results.items():
        outcome[name] = count_cases(path, f"{folder.name}/{name}", count)
    names = selected_tests(folder)
    if not names:
        count.fail(folder.name, "no test was selected")
    failed = failed_programs(folder)
    for name in names:
        cases, failures = outcome.get(name) or outcome.get(f"rostest-{name}") or (0, 0)
        if failures > 0:
            continue
        if name in failed:
            count.fail(f"{folder.name}/{name}", "the program failed outside of its tests")
        elif cases == 0:
            count.fail(f"{folder.name}/{name}", "wrote no results")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="*", type=Path, help="build folders whose tests ran")
    parser.add_argument("--passed", action="append", default=[], metavar="WHAT",
                        help="counts as one more passed test")
    parser.add_argument("--failed", action="append", default=[], metavar="WHAT",
                        help="counts as one more failed test, e.g. a build")
    options = parser.parse_args()
    count = Count()
    for folder in options.folder:
        count_folder(folder, count)
    count.passed += len(options.passed)
    for what in options.failed:
        count.fail(what, "failed")

    for failure in count.failures:
        print(f"FAILED {failure}")
    skipped = f", {count.skipped} skipped" if count.skipped else ""
    print(f"{count.passed} passed, {len(count.failures)} failed{skipped}")
    return 1 if count.failures or count.passed == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
