"""Scores of runs, and of settings against the defaults."""
from dataclasses import dataclass
from typing import Optional

import numpy as np

from ..columns import LOCALIZED
from .bootstrap import Difference, mean_over_bags, paired_difference
from .jobs import DEFAULTS, Job

MIN_COVERAGE = 0.5  # of a drive; a run with an estimate for less of it is lost
FAILED, LOST, TRACKED = "failed", "lost", "tracked"


@dataclass
class ScoredRun:
    """A job with its result."""
    key: str
    job: Job
    result: dict
    outcome: str   # FAILED, LOST or TRACKED
    error: float   # m, mean position error; that of a lost or failed run is Limits.cost, which bounds it

    @property
    def pair(self):
        """What a run has in common with the run of the defaults that it is compared with."""
        return self.job.drive, self.job.seed


def score(key, job, result, limits):
    """The ScoredRun of a result."""
    outcome = _outcome(result, limits)
    error = min(limits.cost, result["position_error_m"]["mean"]) if outcome == TRACKED else limits.cost
    return ScoredRun(key, job, result, outcome, error)


def _outcome(result, limits):
    if "failure" in result:
        return FAILED
    position = result["position_error_m"]
    values = (position["mean"], position["p95"], position["final"])
    # JSON has no NaN: a number that is not finite is None.
    if None in values or result["coverage"] < MIN_COVERAGE or max(values[1:]) > limits.error:
        return LOST
    return TRACKED


def by_bag(runs, value):
    """value(run) of the runs, in one list per bag."""
    groups = {}
    for run in runs:
        groups.setdefault(run.job.drive.bag, []).append(value(run))
    return list(groups.values())


def mean_error(runs):
    """m, the mean over bags; it includes lost and failed runs."""
    return mean_over_bags(by_bag(runs, lambda run: run.error))


@dataclass
class SettingScore:
    """The runs of one setting. Means are over bags; those of tracked runs are NaN if there are none."""
    name: str
    parameters: dict
    runs: int
    lost: int
    failed: int
    error: float           # m, as mean_error()
    p95: float             # m, of tracked runs
    max: float             # m, the largest of tracked runs
    heading: float         # deg, mean absolute error of tracked runs
    localized: float       # percent of the scans of runs that did not fail
    difference: Optional[Difference] = None  # of the error from that of the defaults, m; None for the defaults


def score_setting(name, runs, baseline=None):
    """The SettingScore of runs; `baseline`: the runs of the defaults, with the same bags, maps and seeds."""
    tracked = [run for run in runs if run.outcome == TRACKED]
    ran = [run for run in runs if run.outcome != FAILED]

    def mean_of(some, value):
        return mean_over_bags(by_bag(some, lambda run: value(run.result))) if some else np.nan

    return SettingScore(
        name, runs[0].job.parameters, len(runs), sum(run.outcome == LOST for run in runs), len(runs) - len(ran),
        mean_error(runs), mean_of(tracked, lambda result: result["position_error_m"]["p95"]),
        max((run.result["position_error_m"]["max"] for run in tracked), default=np.nan),
        mean_of(tracked, lambda result: result["heading_error_deg"]["mean"]),
        mean_of(ran, lambda result: result["status_percent"].get(LOCALIZED, 0.0)),
        _difference(runs, baseline) if baseline else None)


def _difference(runs, baseline):
    errors = {run.pair: run.error for run in baseline}
    return paired_difference(by_bag(runs, lambda run: run.error - errors[run.pair]))


def score_settings(runs):
    """The SettingScores of ScoredRuns, in their order; those of DEFAULTS must be among them."""
    settings = {}
    for run in runs:
        settings.setdefault(run.job.setting, []).append(run)
    baseline = settings[DEFAULTS]
    return [score_setting(name, of_one, None if name == DEFAULTS else baseline) for name, of_one in settings.items()]
