"""Benchmarks over recordings: finds the recordings, replays them, runs seeds in parallel."""
import argparse
import concurrent.futures
import json
import pathlib
import sys
import typing

from . import programs


class Recording(typing.NamedTuple):
    bag: pathlib.Path
    map: pathlib.Path
    truth: pathlib.Path


def find_map(bag):
    named = [bag.with_name(bag.stem + ending) for ending in (".yaml", "_full.yaml")]
    candidates = [path for path in named if path.exists()] or sorted(bag.parent.glob("*.yaml"))
    return candidates[0] if len(candidates) == 1 or candidates[:1] == named[:1] else None


def find_truth(bag):
    candidates = [bag.with_name(bag.stem + ending) for ending in ("_gt.tum", "_ref.tum")]
    return next((path for path in candidates if path.exists()), None)


def find_recordings(root, only):
    """The Recordings below `root`, of the names in `only` if given. Bags without map or truth are reported on
    stderr."""
    found = []
    for bag in sorted(root.rglob("*.bag")):
        if only and bag.stem not in only:
            continue
        map_file, truth = find_map(bag), find_truth(bag)
        if map_file and truth:
            found.append(Recording(bag, map_file, truth))
        else:
            print(f"skipped: {bag} has no {'map' if truth else 'truth'} beside it", file=sys.stderr)
    if not found:
        print(f"skipped: {root} has no recording with a map and a truth")
    return found


def option_parser(description):
    """A parser with the options common to these benchmarks."""
    parser = argparse.ArgumentParser(description=description,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, help="folder with the recordings")
    parser.add_argument("--seeds", type=int, default=3, help="runs per recording, with seeds 1 to N", metavar="N")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only these recordings")
    parser.add_argument("--odom-topic", default="/odom")
    add_run_options(parser)
    return parser


def add_run_options(parser):
    """Adds the options of the replays and of the output."""
    parser.add_argument("--config", help="YAML file of parameters")
    parser.add_argument("--set", action="append", default=[], metavar="NAME:=VALUE", help="a parameter of every run")
    parser.add_argument("--jobs", type=int, default=1, help="parallel runs")
    parser.add_argument("--json", metavar="FILE", help="also write the table to this file")


def replay(recording, seed, arguments, start, folder):
    """Runs replay with output to `folder`."""
    bag, map_file, truth = recording
    words = ["--bag", bag, "--map", map_file, "--truth", truth, "--out", folder, "--odom-topic",
             arguments.odom_topic, "--seed", seed, *start]
    if arguments.config:
        words += ["--config", arguments.config]
    for setting in arguments.set:
        words += ["--set", setting]
    programs.run("replay", words)


def run_parallel(run, cases, jobs):
    """The results of run(*case) for each case, in their order, with up to `jobs` at a time. The first error ends
    the rest."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = [pool.submit(run, *case) for case in cases]
        try:
            return [future.result() for future in futures]
        except BaseException:
            for future in futures:
                future.cancel()
            raise


def run_seeds(run, cases, arguments):
    """The results of run(case, seed, arguments), a list over the seeds for each case."""
    seeds = range(1, arguments.seeds + 1)
    results = iter(run_parallel(run, [(case, seed, arguments) for case in cases for seed in seeds], arguments.jobs))
    return [[next(results) for _ in seeds] for _ in cases]


def print_table(header, rows):
    """Prints rows of text in aligned columns, the first one to the left."""
    table = [header] + rows
    widths = [max(map(len, column)) for column in zip(*table)]
    for line in table:
        print("  ".join(text.ljust(width) if index == 0 else text.rjust(width)
                        for index, (text, width) in enumerate(zip(line, widths))))


def write_json(rows, path):
    """Writes the rows of a table to `path` unless that is None."""
    if path:
        pathlib.Path(path).write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
