"""scripts/mutate: changes the core in one place at a time and checks that a test fails."""
import argparse
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from .mutants import MutationError, read_list
from .rules import generate
from .test_bench import FAST_PROGRAMS, SYSTEM_PROGRAMS, TestBench

ROOT = Path(__file__).resolve().parents[3]
LIST = ROOT / "test/mutants.yaml"
MIN_KILL_SHARE = 0.95
# Tables and texts: what their mutants change is compared with the documentation by tests.
NOT_GENERATED = re.compile(r"src/core/(?:localizer/(?:foreign_parameter|parameter_)|map/map_summary_text|simd/)")

DESCRIPTION = """Mutation testing of src/core. Makes one edit at a time (a mutant: a parameter ignored, a comparison
flipped, a constant changed, a statement deleted, a sign swapped) in a copy of the source tree, builds the core and runs
the tests, first those of the edited folder. Prints which test kills each mutant; a mutant that no test kills has
survived. The list of hand-written mutants and of those that no test can kill is test/mutants.yaml; others are made by
rules from a seed. Exit status 1 if less than 95 %% of the mutants are killed."""
EPILOG = """A mutant takes 10 s to some minutes, a survivor longest. The copy and its build are in build/mutants."""


def shard(text):
    """(I, N) of 'I/N', I from 1 on."""
    found = re.fullmatch(r"(\d+)/(\d+)", text)
    if not found or not 1 <= int(found.group(1)) <= int(found.group(2)):
        raise argparse.ArgumentTypeError(f"{text}; expected I/N, for example 1/4")
    return int(found.group(1)), int(found.group(2))


def number(least):
    def read(text):
        if not text.isdigit() or int(text) < least:
            raise argparse.ArgumentTypeError(f"{text}; expected a whole number from {least} on")
        return int(text)
    return read


def parse(arguments):
    parser = argparse.ArgumentParser(prog="scripts/mutate", description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument("--jobs", type=number(1), default=1, metavar="N",
                        help="mutants at a time (default: 1)")
    parser.add_argument("--only", metavar="PATTERN", help="mutants whose name matches this regular expression")
    parser.add_argument("--shard", type=shard, default=(1, 1), metavar="I/N",
                        help="every N-th mutant, from the I-th on")
    parser.add_argument("--generated", type=number(0), default=100, metavar="N",
                        help="number of mutants made by rules (default: 100)")
    parser.add_argument("--seed", type=number(0), default=1, metavar="S", help="which of them (default: 1)")
    parser.add_argument("--fast", action="store_true", help="without the tests of whole drives, which take minutes")
    parser.add_argument("--list", action="store_true", help="print the mutants and run nothing")
    return parser.parse_args(arguments)


def sources():
    """The texts of the files that rules apply to, by their names."""
    files = (path.relative_to(ROOT).as_posix() for path in (ROOT / "src/core").rglob("*.cpp"))
    return {file: (ROOT / file).read_text(encoding="utf-8") for file in files if not NOT_GENERATED.match(file)}


def selected(options):
    """The Mutants to run, file by file."""
    listed, equivalent = read_list(ROOT, LIST)
    mutants = listed + generate(sources(), options.seed, options.generated, equivalent)
    if options.only:
        mutants = [mutant for mutant in mutants if re.search(options.only, mutant.name)]
    first, step = options.shard
    return sorted(mutants, key=lambda mutant: mutant.file)[first - 1::step]


def run(mutants, jobs, programs):
    """The Outcomes of mutants; prints a line for each."""
    bench = TestBench(ROOT, ROOT / "build/mutants", programs)
    bench.prepare(jobs)

    def evaluate(mutant):
        outcome = bench.evaluate(mutant)
        print(row(outcome), flush=True)
        return outcome

    with ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(evaluate, mutants))


def row(outcome):
    by = f" by {outcome.by}" if outcome.by else ""
    return f"{outcome.kind:8} {outcome.mutant.file}: {outcome.mutant.name}{by} ({outcome.seconds:.0f} s)"


def kill_share(outcomes):
    """The killed fraction of the mutants that compile."""
    valid = [outcome for outcome in outcomes if outcome.kind != "invalid"]
    return sum(outcome.kind == "killed" for outcome in valid) / len(valid) if valid else 0.0


def report(outcomes):
    """Prints the survivors and the numbers. Returns the exit status."""
    survivors = [outcome for outcome in outcomes if outcome.kind == "survived"]
    if survivors:
        print("survivors:")
    for outcome in survivors:
        print(f"  {outcome.mutant.file}: {outcome.mutant.name}")
        print(f"    - {outcome.mutant.old}\n    + {outcome.mutant.new}")
    share = kill_share(outcomes)
    killed = sum(outcome.kind == "killed" for outcome in outcomes)
    invalid = sum(outcome.kind == "invalid" for outcome in outcomes)
    print(f"{killed} killed, {len(survivors)} survived, {invalid} do not compile: {100.0 * share:.1f} % killed")
    return 0 if share >= MIN_KILL_SHARE else 1


def main(arguments=None):
    options = parse(arguments)
    try:
        mutants = selected(options)
        if options.list:
            for mutant in mutants:
                print(f"{mutant.file}: {mutant.name}")
            return 0
        programs = FAST_PROGRAMS + (() if options.fast else SYSTEM_PROGRAMS)
        return report(run(mutants, options.jobs, programs))
    except (MutationError, OSError) as error:
        print(f"mutate: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("mutate: interrupted", file=sys.stderr)
        return 130
