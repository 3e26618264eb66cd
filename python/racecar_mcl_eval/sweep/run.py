"""Runs jobs: on this machine, or on the workers of a Dask cluster."""
import concurrent.futures
import json
import tempfile
from pathlib import Path

from tqdm import tqdm

from .. import EvaluationError, programs
from ..bag import has_topic
from ..run import TRUTH_TOPIC
from ..trajectory import read_tum
from . import identity, parameters

# Of replay's summary.json; the others are times of the machine, or repeat what the result is made from.
_KEPT = ("position_error_m", "heading_error_deg", "truth_stamps_used", "truth_stamps_skipped", "status_percent",
         "scans_seen", "scans_used", "duration_s")
CONNECT_TIMEOUT = 10.0  # s, for the connection to a scheduler


def run_job(job, key):
    """The result of a Job, a dict for JSON. A replay that ends with an error results in {"failure": message}. Raises
    EvaluationError if the result would not be that of `key`, and if replay was ended from outside."""
    if identity.key_of(job) != key:
        raise EvaluationError(f"{job.drive.name}: the bag, the map, the truth or the program is not the same here as "
                              "where the sweep was started")
    with tempfile.TemporaryDirectory(prefix="racecar_mcl_sweep_") as folder:
        config = Path(folder) / "parameters.yaml"
        config.write_text(parameters.to_yaml(job.parameters), encoding="utf-8")
        try:
            programs.run("replay", job.words(config, Path(folder) / "run"))
        except programs.ProgramError as error:
            if error.status != 1:
                raise
            return {"failure": _without_folders(str(error), job, folder)}
        return _measure(Path(folder) / "run")


def _without_folders(message, job, folder):
    """The message without what differs between machines."""
    for place in (folder, job.drive.bag.parent, job.drive.map.parent):
        message = message.replace(f"{place}/", "")
    return message


def _measure(folder):
    """Errors, status shares and coverage of a run from its output folder; nothing that depends on the machine."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    result = {name: summary[name] for name in _KEPT}
    estimated = read_tum(folder / "trajectory.tum").seconds()[-1] / max(summary["duration_s"], 1e-9)
    used, skipped = summary["truth_stamps_used"], summary["truth_stamps_skipped"]
    # Fraction of the drive with an estimate that was compared with the truth.
    result["coverage"] = min(1.0, estimated) * used / max(1, used + skipped)
    return result


def check(jobs, source):
    """Raises EvaluationError for a drive without a truth, and for a setting with a value out of range, so that wrong
    jobs are not found one by one. `source`: the file of the jobs, for messages."""
    settings = {}
    for job in jobs:
        settings.setdefault(job.setting, job)
    for drive in {job.drive for job in jobs if job.drive.truth is None}:
        if not has_topic(drive.bag, TRUTH_TOPIC, "nav_msgs/Odometry"):
            raise EvaluationError(f"{source}: {drive.name} has no ground truth; expected the key truth, "
                                  f"{drive.bag.stem}_gt.tum beside the bag, or {TRUTH_TOPIC} (nav_msgs/Odometry) in it")
    for name, job in settings.items():
        _check_parameters(job, f"{source}: settings: {name}")


def _check_parameters(job, where):
    """Replay checks its parameters before it opens the bag, so a missing bag is the error of valid ones."""
    with tempfile.TemporaryDirectory() as folder:
        config, bag = Path(folder) / "parameters.yaml", Path(folder) / "missing.bag"
        config.write_text(parameters.to_yaml(job.parameters), encoding="utf-8")
        try:
            programs.run("replay", ["--bag", bag, "--map", job.drive.map, "--config", config, "--out", folder])
        except programs.ProgramError as error:
            if str(bag) not in str(error):
                raise EvaluationError(f"{where}: {error}") from error


def run_here(tasks, workers):
    """Runs the jobs in `tasks` (a dict by key) in `workers` processes of replay. Yields (key, result or exception) as
    they end."""
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        running = {pool.submit(run_job, job, key): key for key, job in tasks.items()}
        try:
            for done in concurrent.futures.as_completed(running):
                yield running[done], _outcome(done)
        finally:
            # After Ctrl-C: skips the remaining jobs.
            for future in running:
                future.cancel()


def run_on_cluster(tasks, address):
    """As run_here, on the workers of the Dask scheduler at `address`. The scheduler runs the job of a worker that
    died on another one."""
    try:
        from distributed import Client, as_completed
    except ImportError as error:
        raise EvaluationError("--dask needs Dask's distributed: apt install python3-distributed") from error
    try:
        client = Client(address, timeout=CONNECT_TIMEOUT)
    except (OSError, ValueError) as error:
        raise EvaluationError(f"--dask {address}: no scheduler answers there; expected its address, such as "
                              "tcp://host:8786") from error
    with client:
        running = {client.submit(run_job, job, key, key=f"replay-{key}", pure=False): key
                   for key, job in tasks.items()}
        for done in as_completed(running):
            yield running[done], _outcome(done)


def _outcome(future):
    """The result of a future, or its exception."""
    error = future.exception()
    if isinstance(error, ModuleNotFoundError):
        return EvaluationError(f"a worker lacks a module ({error}): start it after `source build/devel/setup.bash`")
    return error or future.result()


def complete(tasks, store, options):
    """Runs `tasks` (Jobs by key) as the options --jobs or --dask say and stores the results, with a progress bar.
    Returns the messages of those that did not end, by key."""
    outcomes = run_on_cluster(tasks, options.dask) if options.dask else run_here(tasks, options.jobs)
    unfinished = {}
    with tqdm(total=len(tasks), unit="run", disable=None, smoothing=0.05) as bar:
        for key, outcome in outcomes:
            if isinstance(outcome, dict):
                store.write(key, identity.made_from(tasks[key]), outcome)
            else:
                unfinished[key] = f"{tasks[key].drive.name}: {outcome}"
            bar.update()
    return unfinished
