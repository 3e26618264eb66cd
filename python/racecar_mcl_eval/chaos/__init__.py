"""scripts/chaos: mistreats the running localizer and checks what it promises nevertheless."""
import argparse
import signal
import sys
import tempfile
from pathlib import Path

from .. import EvaluationError
from ..cli import exit_status
from . import report

DESCRIPTION = """Runs the localizer in a ROS graph of its own (roscore on a free port, localize.launch, a simulated
drive that is played in real time) and mistreats it: nodes are killed, inputs stop, flood or step in time, subscribers
do not read, the processor is busy. Each case has promises: upper bounds of errors against the ground truth, of times,
latency and memory. Prints a table; exit status 1 if a promise is broken. Uses the package of the sourced
environment."""
MIN_RELOADS = 10  # the memory after the first five is compared with that after the last five
EPILOG = "A case takes about 30 s, 'reloaded' longer. Other programs on the machine affect latencies and times."


def all_cases():
    # Imported here: --help needs no ROS.
    from . import input_cases, load_cases, node_cases
    return node_cases.CASES + input_cases.CASES + load_cases.CASES


def positive(text):
    value = float(text)
    if not value > 0.0:
        raise argparse.ArgumentTypeError(f"{text}; expected more than 0")
    return value


def parse(arguments):
    parser = argparse.ArgumentParser(prog="scripts/chaos", description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument("--only", nargs="+", metavar="CASE", help="names of the cases to run; default: all")
    parser.add_argument("--list", action="store_true", help="print the cases and their promises, and run nothing")
    parser.add_argument("--seconds", type=positive, default=10.0, metavar="S",
                        help="mistreatment per case, s (default: 10)")
    parser.add_argument("--reloads", type=int, default=20, metavar="N", help="reloads of the nodelet (default: 20)")
    parser.add_argument("--out", type=Path, metavar="FILE.md", help="write the table to a file, too")
    parser.add_argument("--logs", type=Path, metavar="FOLDER", help="keep the logs and bags there")
    parser.add_argument("--soak", type=positive, metavar="HOURS",
                        help="instead of the cases: a drive of HOURS of simulated time; reports errors, status, "
                        "memory and descriptors")
    parser.add_argument("--factor", type=positive, default=3.0, metavar="F",
                        help="simulated seconds per second with --soak (default: 3)")
    options = parser.parse_args(arguments)
    if options.reloads < MIN_RELOADS:
        parser.error(f"--reloads {options.reloads}; expected at least {MIN_RELOADS}")
    return options


def selected(cases, names):
    """The cases with these names, in the order of all; all of them without names."""
    known = [case.name for case in cases]
    for name in names or []:
        if name not in known:
            raise EvaluationError(f"no case '{name}'; expected some of {', '.join(known)}")
    return [case for case in cases if not names or case.name in names]


def run_case(case, lab):
    """The Result of a case; a case that cannot be measured has failed."""
    try:
        return report.Result(case, case.measure(lab))
    except (EvaluationError, OSError) as error:
        return report.Result(case, None, str(error))
    except Exception as error:  # of any other kind: the other cases are run all the same
        return report.Result(case, None, f"{type(error).__name__}: {error}")


def run_cases(cases, options, details):
    """Runs the cases and prints a line for each. Returns the Results."""
    from .session import Lab
    results = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = (options.logs or Path(temporary)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        with Lab(folder, options.seconds, options.reloads) as lab:
            print(report.HEADING, flush=True)
            for case in cases:
                results.append(run_case(case, lab))
                print(report.row(results[-1]), flush=True)
    for name, text in details:
        print(f"{name}: {text}")
    return results


def chaos(options):
    if options.soak is not None:
        from .soak import soak_case
        case, details = soak_case(options.soak, options.factor)
        cases = [case]
    else:
        cases, details = selected(all_cases(), options.only), []
    if options.list:
        for case in cases:
            print(f"{case.name}: {case.action}. Promise: {report.promise(case)}")
        return 0
    results = run_cases(cases, options, details)
    print(report.summary(results))
    if options.out is not None:
        options.out.write_text(report.page(results, details), encoding="utf-8")
    return 0 if all(map(report.passed, results)) else 1


def main(arguments=None):
    options = parse(arguments)
    # SIGTERM ends the started programs, too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    return exit_status("chaos", lambda: chaos(options))
