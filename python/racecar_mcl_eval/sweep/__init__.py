"""scripts/sweep: settings of the localizer compared over many bags."""
import argparse
import os
import signal
from pathlib import Path

from .. import EvaluationError
from ..cli import exit_status
from . import identity, jobs, page, run, score
from .store import Store

DESCRIPTION = """Replays bags x maps x settings x seeds, as jobs.yaml lists them (docs/tuning.md), and writes a page
with a row per setting: its errors and their difference from those of the defaults, with a confidence interval. Each
result is stored under a hash of what made it, so that a job with a result is not run again, and a sweep that was ended
continues where it was."""


def add_run_options(parser):
    """The options on where and how runs are executed, of sweep and tune."""
    parser.add_argument("jobs_file", metavar="jobs.yaml", type=Path, help="bags, maps, settings and seeds")
    parser.add_argument("--out", required=True, type=Path, help="output folder; the results are in its folder results")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="parallel runs on this machine")
    parser.add_argument("--dask", metavar="ADDRESS", help="run on the workers of this Dask scheduler, such as "
                        "tcp://host:8786, instead of on this machine; they read the bags under the same names")
    parser.add_argument("--retry-failed", action="store_true", help="also run jobs again whose replay failed")


def shard_of(text):
    """(i, n) of "i/n"."""
    try:
        part, count = map(int, text.split("/"))
    except ValueError:
        part = count = 0
    if not 1 <= part <= count:
        raise argparse.ArgumentTypeError(f"'{text}'; expected i/n with 1 <= i <= n, such as 1/4")
    return part, count


def parse(arguments):
    parser = argparse.ArgumentParser(prog="sweep", description=DESCRIPTION)
    add_run_options(parser)
    parser.add_argument("--shard", type=shard_of, default=(1, 1), metavar="i/n",
                        help="run only part i of n of the jobs; the page is written once all have a result")
    return checked_options(parser, parser.parse_args(arguments))


def checked_options(parser, options):
    if options.jobs is not None and options.jobs < 1:
        parser.error("--jobs must be at least 1")
    return options


def by_key(all_jobs):
    """The Jobs by the keys of their results. Jobs that give the same result are one."""
    return {identity.key_of(job): job for job in reversed(all_jobs)}


def pending_of(store, tasks, options):
    """The tasks (Jobs by key) that are to be run."""
    pending = {}
    for key, job in tasks.items():
        result = store.read(key)
        if result is None or (options.retry_failed and "failure" in result):
            pending[key] = job
    return pending


def finish(store, pending, options):
    """Runs these tasks and stores their results. Raises EvaluationError if some were not finished."""
    unfinished = run.complete(pending, store, options) if pending else {}
    if unfinished:
        raise EvaluationError(f"{len(unfinished)} of {len(pending)} runs were not finished, among them "
                              f"{next(iter(unfinished.values()))}. Start the program again to continue")


def scored(store, all_jobs, limits):
    """The ScoredRuns of jobs; None if a result is missing."""
    runs = []
    for job in all_jobs:
        key = identity.key_of(job)
        result = store.read(key)
        if result is None:
            return None
        runs.append(score.score(key, job, result, limits))
    return runs


def sweep(options):
    file = jobs.read(options.jobs_file)
    all_jobs, store = file.jobs(), Store(options.out / "results")
    tasks = by_key(all_jobs)
    part = jobs.shard(sorted(tasks), *options.shard)
    pending = pending_of(store, {key: tasks[key] for key in part}, options)
    print(f"{len(all_jobs)} jobs, {len(tasks)} different; {len(part)} in this part, {len(part) - len(pending)} of them "
          f"with a result, {len(pending)} to run", flush=True)
    run.check(pending.values(), options.jobs_file)
    finish(store, pending, options)
    runs = scored(store, all_jobs, file.limits)
    if runs is None:
        print("other parts have no result yet; the page is written once all have one")
        return
    scores = score.score_settings(runs)
    path = page.write_page(options.out, file.path.name, scores, runs, file.limits)
    for each in scores[1:]:
        print(f"{each.name}: {each.difference.verdict} ({100.0 * each.difference.mean:+.3f} cm, "
              f"{100.0 * each.difference.low:+.3f} to {100.0 * each.difference.high:+.3f})")
    print(f"page: {path}")


def main(arguments=None):
    # A scheduler's SIGTERM ends the program as Ctrl-C does: running jobs are finished, the others left.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    return exit_status("sweep", lambda: sweep(parse(arguments)))
