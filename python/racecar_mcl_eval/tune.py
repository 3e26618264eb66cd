"""scripts/tune: searches parameters on many bags, and evaluates the winner on others."""
import argparse
import signal
import sys
from dataclasses import dataclass
from pathlib import Path

from . import EvaluationError
from .cli import exit_status
from .html_report import HtmlReport
from .sweep import (add_run_options, by_key, checked_options, finish, jobs, page, parameters, pending_of, run, score,
                    scored)
from .sweep.identity import hash_of, made_from
from .sweep.search_space import default_space, read_space, suggest
from .sweep.store import Store

DESCRIPTION = """Searches the parameters with the smallest mean position error on the bags of jobs.yaml
(docs/tuning.md) with Optuna. The bags in held_apart are replayed only at the end, with the defaults and with the
winner, and reported separately. Writes the winner as best.yaml for --config and localize.launch, a page and the trials as CSV.
The same seeds give the same result, also if the search was ended and continued."""

WINNER = "winner"
_STUDY = "tune"
_MADE_FROM = "made_from"  # attribute of the study: hash of what its trials depend on
_TUNE_KEYS = ("parameters", "trials", "seed")
_TRIALS, _SEED = 50, 1


def parse(arguments):
    parser = argparse.ArgumentParser(prog="tune", description=DESCRIPTION)
    add_run_options(parser)
    parser.add_argument("--trials", type=int, metavar="N", help=f"sets of parameters to try; default: that of the "
                        f"file, or {_TRIALS}")
    parser.add_argument("--seed", type=int, help=f"seed of the search; default: that of the file, or {_SEED}")
    parser.add_argument("--study", type=Path, metavar="FILE.db",
                        help="file of the study, from which a search continues; default: study.db in the output folder")
    return checked_options(parser, parser.parse_args(arguments))


def load_optuna():
    try:
        import optuna
    except ImportError as error:
        raise EvaluationError("tune needs Optuna: apt install python3-optuna") from error
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna


@dataclass
class Search:
    """What is searched, on what, and where the results are."""
    file: object     # JobsFile
    space: dict
    trials: int
    seed: int
    store: Store
    options: object  # of the command line

    def runs(self, name, values, drives):
        """The ScoredRuns of one set of all parameters."""
        all_jobs = self.file.jobs_of(name, values, drives)
        finish(self.store, pending_of(self.store, by_key(all_jobs), self.options), self.options)
        return scored(self.store, all_jobs, self.file.limits)

    def training_error(self, values):
        """m, the mean over the training bags; a lost or failed run counts Limits.cost."""
        return score.mean_error(self.runs("trial", values, self.file.drives))

    def identity(self):
        """The hash of all that the trials depend on, except their number."""
        return hash_of([[made_from(job) for job in self.file.jobs_of("", self.file.defaults, self.file.drives)],
                        self.space, self.seed, self.file.limits.error, self.file.limits.cost])


def read_search(options):
    """The Search of a command line and its jobs.yaml."""
    file = jobs.read(options.jobs_file)
    for key in file.tune:
        if key not in _TUNE_KEYS:
            raise EvaluationError(f"{file.path}: tune: there is no key '{key}'; expected one of "
                                  f"{', '.join(_TUNE_KEYS)}")
    space = (read_space(file.tune["parameters"], f"{file.path}: tune: parameters") if "parameters" in file.tune
             else default_space(file.defaults))
    trials = _whole(file, options.trials, "trials", _TRIALS, 1)
    seed = _whole(file, options.seed, "seed", _SEED, 0)
    return Search(file, space, trials, seed, Store(options.out / "results"), options)


def _whole(file, given, key, default, least):
    """A whole number from the command line, else from the section tune."""
    value = file.tune.get(key, default) if given is None else given
    if isinstance(value, bool) or not isinstance(value, int) or value < least:
        raise EvaluationError(f"{file.path}: tune: {key} is {value!r}; expected a whole number of at least {least}")
    return value


def open_study(optuna, path, search):
    """The study in the file `path`, a new one if there is none. Raises EvaluationError if its trials are of other
    jobs."""
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        study = optuna.create_study(storage=f"sqlite:///{path.resolve()}", study_name=_STUDY, load_if_exists=True)
        made = study.user_attrs.get(_MADE_FROM)
    except Exception as error:  # of any of the libraries that read the file
        raise EvaluationError(f"{path}: cannot be read as a study of Optuna: {error}") from error
    if made is None:
        study.set_user_attr(_MADE_FROM, search.identity())
    elif made != search.identity():
        raise EvaluationError(f"{path}: its trials are of other bags, parameters, ranges, seeds or another version of "
                              "replay; expected another --study or the same jobs")
    return study


def finished_trials(optuna, study):
    return study.get_trials(deepcopy=False, states=(optuna.trial.TrialState.COMPLETE,))


def search_trials(optuna, study, search):
    """Adds trials to the study until it has as many as wanted. A trial that was ended counts nothing and is repeated:
    each trial has its own seed, so that it depends on the finished ones only."""
    for number in range(len(finished_trials(optuna, study)), search.trials):
        study.sampler = optuna.samplers.TPESampler(seed=search.seed * 1000003 + number)
        trial = study.ask()
        values = suggest(trial, search.space)
        error = search.training_error({**search.file.defaults, **values})
        trial.set_user_attr("parameters", values)
        study.tell(trial, error)
        print(f"trial {number + 1} of {search.trials}: {100.0 * error:.3f} cm", flush=True)


def best_values(optuna, study, search, default_error):
    """The parameters of the best trial; none if the defaults are as good. Of equal trials the first."""
    finished = finished_trials(optuna, study)[:search.trials]
    best = min(finished, key=lambda trial: trial.value)
    return best.user_attrs["parameters"] if best.value < default_error else {}


def write_best(path, search, winner):
    """Writes the parameters that differ from config/default.yaml."""
    changed = parameters.changes(winner, parameters.defaults())
    head = (f"# Parameters for --config and localize.launch, found by tune with {search.trials} trials on "
            f"{len(search.file.drives)} bags and maps,\n# seed {search.seed}, seeds of the runs "
            f"{', '.join(map(str, search.file.seeds))}. Others keep the values of config/default.yaml.\n")
    path.write_text(head + parameters.to_yaml(changed), encoding="utf-8")


def write_trials(path, optuna, study, search):
    names = list(search.space)
    page.write_csv(path, ["trial", "error_m", *names],
                   [[number, f"{trial.value:.6g}", *(trial.user_attrs["parameters"][name] for name in names)]
                    for number, trial in enumerate(finished_trials(optuna, study)[:search.trials], 1)])


def compare(search, winner, drives):
    """The SettingScores of defaults and winner on these drives."""
    return score.score_settings(search.runs(jobs.DEFAULTS, search.file.defaults, drives) +
                                search.runs(WINNER, winner, drives))


def report(search, held_apart, training):
    """Writes the page; `held_apart` (None: no bags) and `training` are SettingScores. Returns its path."""
    file = search.file
    report_page = HtmlReport(search.options.out, f"Tuning: {file.path.name}",
                             f"{search.trials} trials of {len(search.space)} parameters, seed {search.seed}")
    report_page.command = f"tune {file.path.name} --trials {search.trials} --seed {search.seed}"
    section = report_page.section("Held-apart bags")
    if held_apart:
        page.add_table(section, held_apart, "Bags that the search did not use.")
        for text in page.notes(held_apart, len({drive.bag for drive in file.held_apart}), file.limits):
            section.text(text)
    else:
        section.text("No bag is held apart, so that it is unknown how accurate the winner is on other drives.")
    section = report_page.section("Training bags")
    page.add_table(section, training, "The bags of the search.")
    section.text("The winner was chosen on these bags: its difference here is an optimistic estimate of that on other "
                 "drives, and the interval does not include this.")
    section = report_page.section("Search space")
    section.table(["parameter", "default", "winner", "range"],
                  [[name, file.defaults[name], training[-1].parameters[name], _range_text(interval)]
                   for name, interval in search.space.items()])
    return report_page.write()


def _range_text(interval):
    if "choices" in interval:
        return ", ".join(map(str, interval["choices"]))
    return f"{interval['low']:g} to {interval['high']:g}" + (", logarithmic" if interval["log"] else "")


def print_scores(name, scores):
    defaults, winner = scores
    print(f"{name}: defaults {100.0 * defaults.error:.3f} cm, winner {100.0 * winner.error:.3f} cm; difference "
          f"{100.0 * winner.difference.low:+.3f} to {100.0 * winner.difference.high:+.3f} cm: "
          f"{winner.difference.verdict}")


def tune(options):
    optuna = load_optuna()
    search = read_search(options)
    file = search.file
    print(f"{len(search.space)} parameters, {search.trials} trials, seed {search.seed}; {len(file.drives)} bags and "
          f"maps, seeds {', '.join(map(str, file.seeds))}")
    if not file.held_apart:
        print("tune: warning: no bag is held apart: the error on other drives remains unknown; list bags in held_apart",
              file=sys.stderr)
    run.check(file.jobs_of(jobs.DEFAULTS, file.defaults, file.drives + file.held_apart), file.path)
    study = open_study(optuna, options.study or options.out / "study.db", search)
    default_error = search.training_error(file.defaults)
    print(f"defaults: {100.0 * default_error:.3f} cm")
    search_trials(optuna, study, search)
    values = best_values(optuna, study, search, default_error)
    winner = {**file.defaults, **values}
    write_best(options.out / "best.yaml", search, winner)
    write_trials(options.out / "trials.csv", optuna, study, search)
    if not values:
        print("no trial was better than the defaults: the winner is the defaults")
    training = compare(search, winner, file.drives)
    held_apart = compare(search, winner, file.held_apart) if file.held_apart else None
    print_scores("training bags", training)
    if held_apart:
        print_scores("held-apart bags", held_apart)
    print(f"page: {report(search, held_apart, training)}; parameters: {options.out / 'best.yaml'}")


def main(arguments=None):
    # A scheduler's SIGTERM ends the program as Ctrl-C does: running jobs are finished, the others left.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    return exit_status("tune", lambda: tune(parse(arguments)))
