#!/usr/bin/python3
"""scripts/lib/coverage.py reports what gcov counts, and counts what no program loaded as not run."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rosunit

PROGRAM = Path(__file__).resolve().parents[2] / "scripts/lib/coverage.py"
FILES = {
    "include/racecar_mcl/map/half.h": "inline int half(int a) {\n  return a / 2;\n}\n",
    "src/core/map/sign.cpp": """#include "half.h"
int sign(int a) {
  if (a < 0) {
    a = half(a);
    return -1;
  }
  return 1;
}
""",
    "src/core/map/unused.cpp": "#include \"half.h\"\nint unused() {\n  return half(2);\n}\n",
    "test/main.cpp": "int sign(int a);\nint main() {\n  return sign(3) - 1;\n}\n"}


class Coverage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()
        self.build = self.root / "build"
        self.build.mkdir()
        for name, text in FILES.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def run_in_build(self, *command):
        subprocess.run(command, cwd=self.build, check=True)

    def compile_and_run(self):
        for name in ("src/core/map/sign", "src/core/map/unused", "test/main"):
            self.run_in_build("g++", "-O0", "--coverage", "-I", "../include/racecar_mcl/map", "-c", f"../{name}.cpp")
        self.run_in_build("g++", "--coverage", "sign.o", "main.o", "-o", "main")
        self.run_in_build("./main")

    def coverage(self, *arguments):
        run = subprocess.run([sys.executable, str(PROGRAM), str(self.root), str(self.build), *arguments], check=False,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        return run.returncode, run.stdout, run.stderr

    def testCountsTheLinesThatRun(self):
        self.compile_and_run()
        status, text, _ = self.coverage("--lines")
        self.assertEqual(status, 0)
        self.assertIn("| src/core/map | 3 | 7 | 42.9 % |", text)
        self.assertIn("| src/core | 3 | 7 | 42.9 % |", text)
        self.assertIn("src/core/map/sign.cpp: 4-5\n", text)
        self.assertIn("src/core/map/unused.cpp: 2-3\n", text)
        self.assertNotIn("test/main", text)

    def testNamesTheFunctionsThatNothingCalls(self):
        self.compile_and_run()
        _, text, _ = self.coverage()
        self.assertIn("  src/core/map/unused.cpp:2: unused()\n", text)
        self.assertIn("  include/racecar_mcl/map/half.h:1: half(int)\n", text)
        self.assertNotIn("sign(int)", text)

    def testABuildWithoutCountsIsAnError(self):
        status, _, errors = self.coverage()
        self.assertEqual(status, 1)
        self.assertIn("was it built with --coverage?", errors)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "coverage_test", Coverage, sysargs=sys.argv)
