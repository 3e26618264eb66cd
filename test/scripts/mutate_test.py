#!/usr/bin/python3
"""scripts/mutate: its list still applies to the source, its rules make the edits that they name, and its verdict is
that of the tests."""
import contextlib
import ctypes
import io
import json
import re
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import rosunit

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts/lib"))
import mutation  # noqa: E402
from mutation import rules, test_bench  # noqa: E402
from mutation.mutants import Mutant, MutationError, located, mutated, read_list  # noqa: E402

SOURCE = """// a < b
constexpr double kReach = 0.5;  // m
constexpr int kSteps = 4;
double reach(double a, double b) {
  for (int i = 0; i < kSteps; ++i) a += b;
  if (a < b) return a - b;
  forget(&a);
  return text("a < b");
}
"""


def generated(count=1000, seed=1, **options):
    return rules.generate({"a.cpp": SOURCE}, seed, count, **options)


class List(unittest.TestCase):
    def testEveryMutantAppliesToTheSource(self):
        mutants, _ = read_list(ROOT, ROOT / "test/mutants.yaml")
        self.assertGreaterEqual(len(mutants), 150)
        self.assertEqual(len({(mutant.file, mutant.name) for mutant in mutants}), len(mutants))
        for mutant in mutants:
            text = (ROOT / mutant.file).read_text(encoding="utf-8")
            self.assertNotEqual(mutated(text, mutant), text, mutant.name)

    def testEveryParameterOfTheLocalizerIsIgnoredOnce(self):
        mutants, _ = read_list(ROOT, ROOT / "test/mutants.yaml")
        words = set(re.findall(r"\w+", " ".join(mutant.name for mutant in mutants)))
        config = (ROOT / "config/default.yaml").read_text(encoding="utf-8")
        lines = [line for line in config.splitlines() if ":" in line and line[0] not in "# "]
        names = [line.split(":")[0].split("/")[-1] for line in lines]
        self.assertIn("num_particles", names)
        # It changes the time alone.
        self.assertEqual([name for name in names if name not in words], ["num_threads"])

    def testATextThatIsNotThereOnceIsNamed(self):
        entry = {"file": "a.cpp", "old": "a < b", "new": "", "why": "no order"}
        for text, count in (("", 0), ("a < b; a < b;", 2)):
            with self.assertRaisesRegex(MutationError, f"a.cpp: 'no order': its text is there {count} times"):
                located(text, entry)
        self.assertEqual(located("if (a < b)", entry), Mutant("no order", "a.cpp", 4, "a < b", ""))

    def testEveryEntryThatDoesNotApplyIsNamed(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "a.cpp").write_text(SOURCE, encoding="utf-8")
            (root / "list.yaml").write_text("mutants:\n- {file: a.cpp, old: gone, new: b, why: first}\n"
                                            "equivalent:\n- {file: a.cpp, old: lost, new: b, why: second}\n",
                                            encoding="utf-8")
            with self.assertRaisesRegex(MutationError, "(?s)first.*there is no line 'lost'"):
                read_list(root, root / "list.yaml")

    def testAnEditAtTheWrongPlaceIsRefused(self):
        with self.assertRaisesRegex(MutationError, "is not at 1"):
            mutated("ab", Mutant("", "a.cpp", 1, "a", "c"))


class Rules(unittest.TestCase):
    def testTheRulesMakeOneEditEach(self):
        lines = {rules.line_of(SOURCE, mutant)[1] for mutant in generated()}
        self.assertEqual(lines, {"constexpr double kReach = 5.0;  // m", "constexpr int kSteps = 40;",
                                 "if (a >= b) return a - b;", "if (a < b) return a + b;", ";"})

    def testTheSameSeedMakesTheSameMutants(self):
        self.assertEqual(generated(3), generated(3))
        self.assertGreater(len({tuple(generated(3, seed)) for seed in range(10)}), 1)

    def testEachRuleHasItsTurn(self):
        self.assertEqual({mutant.name.split()[1] for mutant in generated(4)},
                         {"comparison", "constant", "sign", "statement"})

    def testEquivalentMutantsAreNotMade(self):
        known = frozenset({("a.cpp", "forget(&a);", ";")})
        names = [mutant.name for mutant in generated(equivalent=known)]
        self.assertFalse(any("forget" in name for name in names))
        self.assertTrue(any("forget" in mutant.name for mutant in generated()))


class FakeBench(test_bench.TestBench):
    """Its test program is a shell script, and its library the text of the mutant."""

    compiles = True

    def make(self, mutant, folder):
        text = (self.source / mutant.file).read_text(encoding="utf-8")
        (folder / "library").write_text(mutated(text, mutant), encoding="utf-8")
        return self.compiles


class Verdict(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.bench = FakeBench(ROOT, self.folder, ("unit_tests",))
        self.bench.limits = {"unit_tests": 1}
        (self.folder / ".source/src").mkdir(parents=True)
        (self.folder / "build/test").mkdir(parents=True)
        (self.folder / ".source/src/a.cpp").write_text("a < b", encoding="utf-8")

    def verdict(self, script):
        program = self.folder / "build/test/unit_tests"
        program.write_text("#!/bin/bash\n" + script, encoding="utf-8")
        program.chmod(0o755)
        outcome = self.bench.evaluate(Mutant("flipped", "src/a.cpp", 2, "<", ">="))
        return outcome.kind, outcome.by

    def testAFailedTestKills(self):
        script = "grep -q 'a >= b' $LD_LIBRARY_PATH/library || exit 0\necho '[  FAILED  ] Order.Holds (0 ms)'\nexit 1\n"
        self.assertEqual(self.verdict(script), ("killed", "Order.Holds"))

    def testAMutantThatAllTestsPassSurvives(self):
        self.assertEqual(self.verdict("exit 0\n"), ("survived", None))

    def testAnEndlessLoopKills(self):
        kind, by = self.verdict("echo '[ RUN      ] Order.Ends'\nwhile :; do :; done\n")
        self.assertEqual(kind, "killed")
        self.assertRegex(by, "Order.Ends .ended by")

    def testAProgramThatCannotBeRunIsNoKill(self):
        with self.assertRaisesRegex(MutationError, "unit_tests cannot be run"):
            self.verdict("exit 126\n")

    def testAMutantThatDoesNotCompileIsNotTested(self):
        self.bench.compiles = False
        self.assertEqual(self.verdict("exit 1\n"), ("invalid", None))

    def testAMutantIsCompiledAndLinkedBesideTheBuild(self):
        library = self.folder / "build/src/core"
        (library / "CMakeFiles/racecar_mcl_core.dir").mkdir(parents=True)
        (self.folder / ".source/src/core").mkdir()
        file = self.folder / ".source/src/core/a.cpp"
        file.write_text("extern \"C\" int steps() { return 1; }\n", encoding="utf-8")
        command = {"directory": str(library), "file": str(file), "command": f"g++ -fPIC -o a.o -c {file}"}
        (self.folder / "build/compile_commands.json").write_text(json.dumps([command]), encoding="utf-8")
        (library / "CMakeFiles/racecar_mcl_core.dir/link.txt").write_text("g++ -shared -o libcore.so a.o\n",
                                                                         encoding="utf-8")
        bench = test_bench.TestBench(ROOT, self.folder, ())
        made = self.folder / "made"
        made.mkdir()
        text = file.read_text(encoding="utf-8")
        for new, compiles in (("nonsense", False), ("return 2", True)):
            mutant = Mutant("two", "src/core/a.cpp", text.index("return 1"), "return 1", new)
            self.assertEqual(bench.make(mutant, made), compiles)
        self.assertEqual(ctypes.CDLL(str(made / "libcore.so")).steps(), 2)
        self.assertEqual(file.read_text(encoding="utf-8"), text)
        self.assertEqual([path.name for path in library.iterdir()], ["CMakeFiles"])

    def testTheTestsOfTheFolderComeFirst(self):
        stages = test_bench.stages_for(ROOT, "src/core/scan/scan_preprocessor.cpp")
        self.assertIn("ScanPreprocessor.*", stages[0].filter)
        self.assertNotIn("RecoveryPolicy.*", stages[0].filter)
        self.assertEqual([stage.program for stage in stages[-2:]], list(reversed(test_bench.SYSTEM_PROGRAMS)))
        tested = [stage for stage in stages if stage.program == "unit_tests"]
        self.assertTrue(tested[1].filter.startswith("*-"))
        self.assertIn("ScanPreprocessor.*", tested[1].filter)


class Report(unittest.TestCase):
    def report(self, *kinds):
        mutant = Mutant("flipped", "a.cpp", 0, "<", ">=")
        outcomes = [test_bench.Outcome(mutant, kind, None, 1.0) for kind in kinds]
        with contextlib.redirect_stdout(io.StringIO()) as text:
            status = mutation.report(outcomes)
        return status, text.getvalue()

    def testTheExitStatusSaysWhether95PercentAreKilled(self):
        self.assertEqual(self.report(*["killed"] * 19, "survived")[0], 0)
        self.assertEqual(self.report(*["killed"] * 18, "survived")[0], 1)

    def testMutantsThatDoNotCompileDoNotCount(self):
        status, text = self.report(*["killed"] * 19, "survived", "invalid")
        self.assertEqual(status, 0)
        self.assertIn("19 killed, 1 survived, 1 do not compile: 95.0 % killed", text)

    def testSurvivorsAreListed(self):
        self.assertIn("survivors:\n  a.cpp: flipped\n    - <\n    + >=\n", self.report("survived")[1])

    def testNothingRunIsNoSuccess(self):
        self.assertEqual(self.report()[0], 1)


class Selection(unittest.TestCase):
    def listed(self, *arguments):
        with contextlib.redirect_stdout(io.StringIO()) as text:
            self.assertEqual(mutation.main(["--list", *arguments]), 0)
        return text.getvalue().splitlines()

    def testShardsAreDisjointAndComplete(self):
        whole = self.listed("--generated", "10")
        parts = [self.listed("--generated", "10", "--shard", f"{index}/3") for index in (1, 2, 3)]
        self.assertEqual(sorted(sum(parts, [])), sorted(whole))

    def testAPatternSelects(self):
        self.assertEqual(self.listed("--only", "^deskew off$"), ["src/core/scan/scan_preprocessor.cpp: deskew off"])

    def testABadShardIsRefused(self):
        with mock.patch("sys.stderr", io.StringIO()) as errors, self.assertRaises(SystemExit):
            mutation.main(["--shard", "4/3"])
        self.assertIn("expected I/N", errors.getvalue())


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "mutate_test", "__main__", sysargs=sys.argv)
