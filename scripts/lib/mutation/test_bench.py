"""Builds the tests once, and compiles, links and tests mutants beside that build."""
import hashlib
import json
import os
import re
import resource
import shlex
import shutil
import subprocess
import tempfile
import time
from collections import namedtuple
from pathlib import Path

from .mutants import MutationError, mutated

# `kind`: killed, survived or invalid (does not compile). `by`: the test that failed.
Outcome = namedtuple("Outcome", "mutant kind by seconds")
# A call of a test program. `filter`: of gtest.
Stage = namedtuple("Stage", "program filter")

FAST_PROGRAMS = ("unit_tests", "contract_tests", "allocation_tests")
SYSTEM_PROGRAMS = ("drive_tests", "parameter_effect_tests")
# Folders whose library is linked again with a mutant, and its target.
LIBRARIES = {"src/core": "racecar_mcl_core", "src/map_io": "racecar_mcl_map_io"}
# Shared libraries, and programs in which LD_LIBRARY_PATH precedes their own path (RUNPATH): a mutant's library takes
# the place of the built one.
CMAKE_OPTIONS = ("-DRACECAR_MCL_CORE_ONLY=ON", "-DBUILD_SHARED_LIBS=ON", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
                 "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG",
                 "-DCMAKE_EXE_LINKER_FLAGS=-Wl,--enable-new-dtags")
SUITE = re.compile(r"^(?:TEST|TEST_F|TEST_P)\(\s*(\w+)", re.MULTILINE)
# CPU time (s) that a test may take: a factor on that without a mutant, and a minimum.
LIMIT_FACTOR = 3
MIN_LIMIT = 20
NOT_STARTED = (126, 127)  # exit statuses of bash for a program that cannot be run
MAX_MEMORY = 4000000  # kB, of a mutant that allocates without end
# Arguments: both limits, the program and its arguments.
LIMITED = 'ulimit -t "$1"; ulimit -v "$2"; shift 2; exec "$@"'


def suites_in(folder):
    """The gtest filter of the suites in the test files of a folder."""
    names = set()
    for path in sorted(folder.glob("*.cpp")):
        names.update(SUITE.findall(path.read_text(encoding="utf-8")))
    return ":".join(f"{name}.*:*/{name}.*" for name in sorted(names))


def stages_for(root, file):
    """The test runs for a mutant in `file`, fastest first."""
    own = suites_in(root / "test/unit" / Path(file).parent.name)
    simulation = suites_in(root / "test/unit/sim")
    others = "*-" + ":".join(filter(None, (own, simulation)))
    stages = [Stage("unit_tests", own)] if own else []
    return stages + [Stage("unit_tests", others), Stage("contract_tests", "*"), Stage("allocation_tests", "*"),
                     Stage("unit_tests", simulation), Stage("parameter_effect_tests", "*"), Stage("drive_tests", "*")]


def killer(output, status):
    """The test that failed, by the output of a gtest program."""
    failed = re.search(r"^\[  FAILED  \] ([^\s,]+)", output, re.MULTILINE)
    if failed:
        return failed.group(1)
    running = re.findall(r"^\[ RUN      \] (\S+)", output, re.MULTILINE)
    return f"{running[-1] if running else 'start of the program'} (ended by {status})"


def replaced(words, old, new):
    """A command with one of its words replaced."""
    if words.count(old) != 1:
        raise MutationError(f"'{old}' is not there once in: {' '.join(words)}")
    return [new if word == old else word for word in words]


class TestBench:
    """A copy of the source tree, built once; a mutant has a folder of its own with its object and library."""

    def __init__(self, root, folder, programs):
        self.root = root
        self.programs = programs
        self.source = folder / ".source"  # hidden, or roslaunch finds its launch files beside the package's
        self.build = folder / "build"
        self.limits = {}
        self.environment = dict(os.environ, CCACHE_BASEDIR=str(self.source), CCACHE_NOHASHDIR="1",
                                GTEST_FAIL_FAST="1")

    def run(self, command, **options):
        return subprocess.run(command, check=False, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, **{"env": self.environment, **options})

    def copy_tree(self):
        """Copies the files of the repository that changed. Returns a hash of all."""
        listed = self.run(["git", "-C", str(self.root), "ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        digest = hashlib.sha256()
        for name in sorted(filter(None, listed.stdout.decode().split("\0"))):
            path, copy = self.root / name, self.source / name
            if not path.is_file():
                if copy.exists():
                    copy.unlink()
                continue
            content = path.read_bytes()
            digest.update(name.encode() + content)
            if not copy.exists() or copy.read_bytes() != content:
                copy.parent.mkdir(parents=True, exist_ok=True)
                copy.write_bytes(content)
        return digest.hexdigest()

    def prepare(self, jobs):
        """Builds the tests without a mutant and measures them."""
        tree = self.copy_tree()
        self.build.mkdir(parents=True, exist_ok=True)
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        for command in (["cmake", "-S", str(self.source), "-B", str(self.build), *CMAKE_OPTIONS, *launcher],
                        ["cmake", "--build", str(self.build), "-j", str(jobs), "--target", *self.programs]):
            result = self.run(command)
            if result.returncode != 0:
                output = result.stdout.decode(errors="replace")
                raise MutationError(f"the build without a mutant fails:\n{output[-3000:]}")
        baseline = self.build / "baseline.json"
        known = json.loads(baseline.read_text(encoding="utf-8")) if baseline.exists() else {}
        seconds = known.get("seconds", {}) if known.get("tree") == tree else {}
        for program in self.programs:
            if program not in seconds:
                seconds[program] = self.measure(program)
            baseline.write_text(json.dumps({"tree": tree, "seconds": seconds}), encoding="utf-8")
        self.limits = {program: max(MIN_LIMIT, LIMIT_FACTOR * value) for program, value in seconds.items()}

    def measure(self, program):
        """The CPU time (s) of a test program without a mutant."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        result = self.run([str(self.build / "test" / program)])
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if result.returncode != 0:
            raise MutationError(f"{program} fails without a mutant: "
                                f"{killer(result.stdout.decode(errors='replace'), result.returncode)}")
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    def make(self, mutant, folder):
        """Makes the mutant's library in `folder`; returns whether it compiles."""
        library = next(name for name in LIBRARIES if mutant.file.startswith(name + "/"))
        source = folder / Path(mutant.file).name
        text = (self.source / mutant.file).read_text(encoding="utf-8")
        source.write_text(mutated(text, mutant), encoding="utf-8")
        entries = json.loads((self.build / "compile_commands.json").read_text(encoding="utf-8"))
        entry = next(entry for entry in entries if entry["file"] == str(self.source / mutant.file))
        compiled = shlex.split(entry["command"])
        built_object = compiled[compiled.index("-o") + 1]
        compiled = replaced(replaced(compiled, entry["file"], str(source)), built_object, str(folder / "mutant.o"))
        compiled += ["-iquote", str((self.source / mutant.file).parent)]
        if self.run(compiled, cwd=entry["directory"]).returncode != 0:
            return False
        link_file = self.build / library / f"CMakeFiles/{LIBRARIES[library]}.dir/link.txt"
        linked = shlex.split(link_file.read_text(encoding="utf-8"))
        built_library = linked[linked.index("-o") + 1]
        linked = replaced(replaced(linked, built_object, str(folder / "mutant.o")), built_library,
                          str(folder / built_library))
        return self.run(linked, cwd=self.build / library).returncode == 0

    def test(self, stage, folder):
        """The test of a stage that fails with the library in `folder`, or None."""
        limit = int(self.limits[stage.program])
        command = ["bash", "-c", LIMITED, "bash", str(limit), str(MAX_MEMORY),
                   str(self.build / "test" / stage.program), f"--gtest_filter={stage.filter}"]
        try:
            result = self.run(command, timeout=10 * limit,
                              env=dict(self.environment, LD_LIBRARY_PATH=str(folder), TMPDIR=str(folder)))
        except subprocess.TimeoutExpired as expired:
            return killer((expired.stdout or b"").decode(errors="replace"), "the time limit")
        if result.returncode == 0:
            return None
        output = result.stdout.decode(errors="replace")
        if result.returncode in NOT_STARTED:
            raise MutationError(f"{stage.program} cannot be run: {output}")
        return killer(output, f"status {result.returncode}")

    def evaluate(self, mutant):
        """The Outcome of a mutant."""
        begin = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            kind, by = self.verdict(mutant, Path(folder))
        return Outcome(mutant, kind, by, time.monotonic() - begin)

    def verdict(self, mutant, folder):
        if not self.make(mutant, folder):
            return "invalid", None
        for stage in stages_for(self.source, mutant.file):
            by = self.test(stage, folder) if stage.program in self.programs else None
            if by is not None:
                return "killed", by
        return "survived", None
