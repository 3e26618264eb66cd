"""The page of a sweep: a row per setting, its difference from the defaults, and the same as CSV."""
import csv
import io
import math

import numpy as np

from ..html_report import Cell, HtmlReport
from ..plot_style import BAD, GOOD, colour, new_figure
from .bootstrap import BETTER, CONFIDENCE, NO_DIFFERENCE, WORSE
from .parameters import changes
from .score import FAILED, LOST

MIN_BAGS = 6  # with fewer, equal settings agree in sign on all bags in more than 5 % of cases
_LEVELS = {BETTER: "good", WORSE: "bad", NO_DIFFERENCE: ""}
_COLOURS = {BETTER: GOOD, WORSE: BAD, NO_DIFFERENCE: colour(7)}
_HEADER = ("setting", "parameters", "runs", "lost", "failed", "mean error (cm)", "95th percentile (cm)", "max (cm)",
           "heading (deg)", "localized (%)", "difference (cm)", f"{100 * CONFIDENCE:g} % interval (cm)", "result")
_CSV_COLUMNS = ("setting", "parameters", "runs", "lost", "failed", "error_m", "p95_m", "max_m", "heading_deg",
                "localized_percent", "difference_m", "low_m", "high_m", "result")
_RUN_COLUMNS = ("setting", "bag", "map", "seed", "outcome", "error_m", "mean_m", "rmse_m", "p95_m", "max_m",
                "heading_deg", "localized_percent", "coverage", "key", "failure")


def parameters_text(parameters, defaults):
    """The parameters that differ from the defaults."""
    return ", ".join(f"{name}: {str(value).lower() if isinstance(value, bool) else value}"
                     for name, value in changes(parameters, defaults).items())


def _number(value, digits, scale=1.0):
    return "–" if math.isnan(value) else f"{scale * value:.{digits}f}"


def table_row(score, defaults):
    """Cells of one setting."""
    cells = [score.name, parameters_text(score.parameters, defaults), score.runs, _count(score.lost),
             _count(score.failed), _number(score.error, 2, 100.0), _number(score.p95, 2, 100.0),
             _number(score.max, 1, 100.0), _number(score.heading, 2), _number(score.localized, 1)]
    if score.difference is None:
        return cells + ["", "", ""]
    difference = score.difference
    return cells + [f"{100.0 * difference.mean:+.3f}",
                    f"{100.0 * difference.low:+.3f} to {100.0 * difference.high:+.3f}",
                    Cell(difference.verdict, _LEVELS[difference.verdict])]


def _count(number):
    return Cell(str(number), "warning" if number else "")


def add_table(section, scores, caption):
    """The table of SettingScores, the defaults first."""
    section.table(_HEADER, [table_row(score, scores[0].parameters) for score in scores], caption)


def figure_of_differences(scores):
    """The differences from the defaults with their intervals, one line per setting."""
    compared = [score for score in scores if score.difference is not None]
    figure, axes = new_figure(height=1.2 + 0.3 * len(compared))
    plot = axes[0, 0]
    for row, score in enumerate(compared):
        difference = score.difference
        shade = _COLOURS[difference.verdict]
        plot.plot([100.0 * difference.low, 100.0 * difference.high], [row, row], color=shade, linewidth=2.5)
        plot.plot(100.0 * difference.mean, row, "o", color=shade)
    plot.axvline(0.0, color="#000000", linewidth=1.0)
    plot.set_yticks(np.arange(len(compared)))
    plot.set_yticklabels([score.name for score in compared])
    plot.set_ylim(len(compared) - 0.4, -0.6)
    plot.set_xlabel("difference of the mean position error from that of the defaults (cm)")
    return figure


def notes(scores, bags, limits):
    """What a reader must know about the table, as sentences."""
    texts = [f"The error of a run is its mean position error. A run is lost if the 95th percentile of its position "
             f"error, or the error at the end, is above {limits.error:g} m, or if there is an estimate for less than "
             f"half of the drive. A lost or failed run counts {limits.cost:g} m, which is also the largest error of "
             "any run. The 95th percentile, the maximum and the heading error are those of the other runs."]
    compared = len(scores) - 1
    if compared > 0:
        texts.append("Differences are those of runs with the same bag, map and seed, setting minus defaults; a "
                     f"negative one is an improvement. Their {100 * CONFIDENCE:g} % intervals are from a bootstrap "
                     f"over bags, and over the runs of each bag. A setting is \"{BETTER}\" or \"{WORSE}\" if its "
                     "interval excludes zero.")
    if compared > 1:
        texts.append(f"Of {compared} settings without an effect, {(1.0 - CONFIDENCE) * compared:.1f} have such a "
                     "result by chance. Confirm a result on other bags.")
    if compared > 0 and bags < MIN_BAGS:
        number = "is one bag" if bags == 1 else f"are {bags} bags"
        texts.append(f"There {number} only, so that the intervals say little about other drives; use at least "
                     f"{MIN_BAGS}.")
    return texts


def add_failures(page, runs):
    """Adds a section with the runs that were lost or failed, if any."""
    bad = [run for run in runs if run.outcome in (FAILED, LOST)]
    if bad:
        page.section("Lost and failed runs").table(
            ["setting", "bag", "map", "seed", "outcome", "max (m)"],
            [[run.job.setting, run.job.drive.name, run.job.drive.map_name, run.job.seed,
              run.result.get("failure", run.outcome), _max_error(run.result)] for run in bad])


def _max_error(result):
    """The largest position error as text; empty if the run has none."""
    value = result.get("position_error_m", {}).get("max")
    return "" if value is None else f"{value:.2f}"


def write_page(folder, source, scores, runs, limits):
    """Writes index.html with its figure and the CSV files settings.csv and runs.csv. `source`: name of the file of
    the jobs. Returns the path of the page."""
    bags = len({run.job.drive.bag for run in runs})
    page = HtmlReport(folder, f"Sweep: {source}", f"{len(scores)} settings, {bags} bags, {len(runs)} runs")
    # Without the options of this run of the program: the page is the same whatever they were.
    page.command = f"sweep {source}"
    section = page.section("Settings")
    add_table(section, scores, "Mean over bags. Parameters: those that differ from the defaults.")
    if len(scores) > 1:
        section.figure(figure_of_differences(scores), "differences",
                       "Difference of each setting from the defaults with its confidence interval.")
    for text in notes(scores, bags, limits):
        section.text(text)
    add_failures(page, runs)
    write_csv(page.folder / "settings.csv", _CSV_COLUMNS, (csv_row(score, scores[0].parameters) for score in scores))
    write_csv(page.folder / "runs.csv", _RUN_COLUMNS, (run_row(run) for run in runs))
    return page.write()


def csv_row(score, defaults):
    difference = score.difference
    return [score.name, parameters_text(score.parameters, defaults), score.runs, score.lost, score.failed,
            *(_csv_number(value) for value in (score.error, score.p95, score.max, score.heading, score.localized)),
            *((_csv_number(difference.mean), _csv_number(difference.low), _csv_number(difference.high),
               difference.verdict) if difference else ("", "", "", ""))]


def _csv_number(value):
    return "" if value is None or math.isnan(value) else f"{value:.6g}"


def run_row(run):
    position = run.result.get("position_error_m", {})
    return [run.job.setting, run.job.drive.name, run.job.drive.map_name, run.job.seed, run.outcome,
            _csv_number(run.error), *(_csv_number(position.get(name)) for name in ("mean", "rmse", "p95", "max")),
            _csv_number(run.result.get("heading_error_deg", {}).get("mean")),
            _csv_number(run.result.get("status_percent", {}).get("localized", 0.0)),
            _csv_number(run.result.get("coverage")), run.key, run.result.get("failure", "")]


def write_csv(path, header, rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    path.write_text(text.getvalue(), encoding="utf-8")
