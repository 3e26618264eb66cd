#!/usr/bin/python3
"""Prints the line coverage that gcov finds in a build folder, per folder of the localizer's sources.

A line or function in a header counts as run if it is run in any of the files that include it.
"""
import argparse
import gzip
import json
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

FOLDERS = ("src/core", "src/ros", "include/racecar_mcl")


class Coverage:
    """Counts per file: of lines by their number, and of functions by the line where they begin."""

    def __init__(self):
        self.lines = {}
        self.functions = {}

    def add(self, name, report):
        """Adds gcov's report (JSON) of a file."""
        lines = self.lines.setdefault(name, {})
        for line in report["lines"]:
            lines[line["line_number"]] = lines.get(line["line_number"], 0) + line["count"]
        functions = self.functions.setdefault(name, {})
        for function in report["functions"]:
            count, _ = functions.get(function["start_line"], (0, ""))
            functions[function["start_line"]] = (count + function["execution_count"], function["demangled_name"])

    def per_folder(self):
        """Rows (folder, lines run, lines) by folder, and one per top folder with the sum."""
        rows = {}
        for name, lines in self.lines.items():
            top = next(folder for folder in FOLDERS if name.startswith(folder + "/"))
            for folder in {top, str(Path(name).parent)}:
                run, total = rows.get(folder, (0, 0))
                rows[folder] = (run + sum(count > 0 for count in lines.values()), total + len(lines))
        return [(folder, *rows[folder]) for folder in sorted(rows)]

    def uncovered_lines(self):
        """(file, intervals as text) of the files with lines that are not run."""
        for name in sorted(self.lines):
            numbers = sorted(self.lines[name])
            missed = [number for number in numbers if self.lines[name][number] == 0]
            if missed:
                yield name, intervals(missed, numbers)

    def uncovered_functions(self):
        """(file, line, name) of the functions that are not called."""
        for name in sorted(self.functions):
            for line, (count, function) in sorted(self.functions[name].items()):
                if count == 0:
                    yield name, line, function


def intervals(missed, numbers):
    """The missed ones of all line `numbers` as text; lines without code do not end an interval."""
    texts, begin, missed = [], None, set(missed)
    for number, following in zip(numbers, numbers[1:] + [None]):
        if number not in missed:
            continue
        begin = number if begin is None else begin
        if following not in missed:
            texts.append(str(begin) if begin == number else f"{begin}-{number}")
            begin = None
    return ", ".join(texts)


def reports_of(data_file):
    """gcov's reports (JSON) for the data file of one object."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gcov", "--json-format", str(data_file)], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
        for path in sorted(Path(folder).glob("*.json.gz")):
            with gzip.open(path, "rt", encoding="utf-8") as stream:
                report = json.load(stream)
            working_folder = Path(report["current_working_directory"])
            for file in report["files"]:
                yield (working_folder / file["file"]).resolve(), file


def read_coverage(root, build):
    """The Coverage of the sources below `root` by the counts in a build folder."""
    coverage = Coverage()
    notes = sorted(build.rglob("*.gcno"))
    with ThreadPoolExecutor() as pool:
        # A data file is missing if no test loaded the object; its notes alone give counts of zero.
        for reports in pool.map(lambda note: list(reports_of(note)), notes):
            for path, report in reports:
                name = path.relative_to(root).as_posix() if root in path.parents else ""
                if name.startswith(tuple(folder + "/" for folder in FOLDERS)):
                    coverage.add(name, report)
    return coverage


def share(run, total):
    return 100.0 * run / total if total else 0.0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", type=Path, help="the repository")
    parser.add_argument("build", type=Path, help="a folder that was built with --coverage")
    parser.add_argument("--lines", action="store_true", help="print the lines that are not run")
    options = parser.parse_args()
    coverage = read_coverage(options.root.resolve(), options.build.resolve())
    if not coverage.lines:
        print(f"coverage: no counts in {options.build}: was it built with --coverage?", file=sys.stderr)
        return 1
    print("functions that no test calls:")
    for name, line, function in coverage.uncovered_functions():
        print(f"  {name}:{line}: {function}")
    if options.lines:
        print("lines that no test runs:")
        for name, text in coverage.uncovered_lines():
            print(f"  {name}: {text}")
    print("| folder | lines run | lines | |\n|---|---|---|---|")
    for folder, run, total in coverage.per_folder():
        print(f"| {folder} | {run} | {total} | {share(run, total):.1f} % |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
