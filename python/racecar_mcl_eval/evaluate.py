"""scripts/evaluate: an HTML report on one or more runs."""
import argparse
from pathlib import Path

import numpy as np

from . import (EvaluationError, assessment, consistency, grid_map, protection, run_figures, scan_match,
               status_figures)
from .cli import exit_status
from .columns import DEGRADED, INLIER_RATIO, LOST, OUTCOME, REJECTED, STATUS
from .html_report import Cell, HtmlReport
from .run import TRUTH_TOPIC, load_folder, load_recorded, recorded_truth
from .plot_style import BAD, STATUS_COLOURS
from .trajectory import read_tum, spans

DESCRIPTION = """Evaluates localization runs: writes an HTML report (index.html) and its figures as PNG. A RUN is an
output folder of replay, or a bag with a recorded estimate (nav_msgs/Odometry). With ground truth: errors, consistency
and protection levels. With --map and --bag: match of the scans with the map, which needs no ground truth. Several runs
are compared side by side."""


def parse(arguments):
    parser = argparse.ArgumentParser(prog="evaluate", description=DESCRIPTION)
    parser.add_argument("runs", nargs="+", metavar="RUN", type=Path)
    parser.add_argument("--out", required=True, type=Path, help="output folder")
    parser.add_argument("--name", action="append", metavar="NAME",
                        help="name of a run in the report, once per run; default: name of its folder")
    parser.add_argument("--truth", action="append", metavar="T.tum", type=Path,
                        help=f"ground truth, once for all runs or once per run; default: {TRUTH_TOPIC} of "
                        "the bag, if present")
    parser.add_argument("--map", metavar="M.yaml", type=Path, help="map of the runs")
    parser.add_argument("--bag", action="append", metavar="B[,B2]",
                        help="bags with the scans, once for all runs or once per run")
    parser.add_argument("--scan-topic", default="/scan")
    parser.add_argument("--estimate-topic", default="/pf/pose/odom", help="estimate in runs that are bags")
    parser.add_argument("--truth-topic", default=TRUTH_TOPIC)
    parser.add_argument("--base-frame", default="base_link")
    parser.add_argument("--laser-pose", metavar='"X Y YAW"',
                        help="mounting pose of the lidar; default: from the bag's tf")
    parser.add_argument("--max-gap", type=float, default=0.5,
                        metavar="S",
                        help="s, longest gap between poses that is interpolated")
    parser.add_argument("--lost", type=float, default=0.5, metavar="M",
                        help="m, position error above which the car is lost")
    parser.add_argument("--title", default="Localization report")
    return parser.parse_args(arguments)


def per_run(values, count, option):
    """A list with one value per run, from one value for all, one per run, or none (None)."""
    if not values:
        return [None] * count
    if len(values) == 1:
        return values * count
    if len(values) == count:
        return values
    raise EvaluationError(f"{option} is given {len(values)} times; expected once, or once for each "
                          f"of the {count} runs")


def parse_pose(text):
    try:
        x, y, yaw = map(float, text.split())
    except ValueError:
        raise EvaluationError(f"--laser-pose is '{text}'; expected \"x y yaw\" (m, m, rad)") from None
    return x, y, yaw


def load_runs(options):
    """The runs with their ground truths, and the bags of each run."""
    count = len(options.runs)
    names = options.name or [None] * count
    if len(names) != count:
        raise EvaluationError(f"--name is given {len(names)} times; expected once for each of the "
                              f"{count} runs")
    bags = [[Path(part) for part in paths.split(",")] if paths else []
            for paths in per_run(options.bag, count, "--bag")]
    runs = []
    for source, name, truth, recordings in zip(
            options.runs, names, per_run(options.truth, count, "--truth"), bags):
        is_bag = source.suffix == ".bag"
        run = (load_recorded(source, options.estimate_topic, name) if is_bag
               else load_folder(source, name))
        if is_bag and not recordings:
            recordings.append(source)
        known = read_tum(truth) if truth else None
        for recording in recordings:
            known = known or recorded_truth(recording, options.truth_topic)
        if known is not None:
            run.set_truth(known, options.max_gap)
        runs.append(run)
    set_unique_names(runs)
    return runs, bags


def set_unique_names(runs):
    """Prefixes equal names with the name of the parent folder."""
    for run in runs:
        if sum(other.name == run.name for other in runs) > 1:
            run.name = f"{run.source.resolve().parent.name}/{run.name}"


# Rows of the tables: label, function of (run, Consistency, ScanMatch) that may return None, format, whether lower
# is better (None: neither).
def error_rows():
    def position(key):
        return lambda run, filtered, match: run.errors and run.errors.summary()["position_error_m"][key]

    def heading(key):
        return lambda run, filtered, match: run.errors and run.errors.summary()["heading_error_deg"][key]

    rows = [(f"position error, {word} (m)", position(key), "{:.3f}", True) for key, word in (
        ("mean", "mean"), ("median", "median"), ("rmse", "rms"), ("p95", "95th percentile"),
        ("max", "max"), ("final", "at the end"))]
    rows += [("cross-track error, mean absolute (m)",
              lambda run, filtered, match: run.errors and np.abs(run.errors.cross_track).mean(), "{:.3f}", True)]
    rows += [(f"heading error, {word} (deg)", heading(key), "{:.2f}", True) for key, word in (
        ("mean", "mean"), ("p95", "95th percentile"), ("max", "max"))]
    rows += [("truth stamps used", lambda run, filtered, match: run.errors and len(run.errors.stamps), "{}", None),
             ("truth stamps skipped (gaps)", lambda run, filtered, match: run.errors and run.errors.skipped,
              "{}", None)]
    return rows


def filter_rows():
    def within_3_sigma(axis):
        return lambda run, filtered, match: filtered and 100.0 * filtered.within_3_sigma[axis]

    def summary(*keys):
        def look_up(run, filtered, match):
            value = run.summary
            for key in keys:
                value = value.get(key) if value else None
            return value
        return look_up

    rows = [(f"{axis} within 3σ (% of updates)", within_3_sigma(index), "{:.1f}", False)
            for index, axis in enumerate(consistency.AXES)]
    rows += [("NEES, mean (consistent: 3)",
              lambda run, filtered, match: filtered and consistency.format_nees(filtered.mean_nees), "{}", None),
             (f"beams within {scan_match.INLIER_DISTANCE:g} m of a wall (%)",
              lambda run, filtered, match: match and 100.0 * match.inlier_ratio, "{:.1f}", False),
             ("distance of end points to walls, mean (m)",
              lambda run, filtered, match: match and match.mean_distance,
              "{:.3f}", True),
             ("update, mean (ms)", summary("update_ms", "mean"), "{:.2f}", True),
             ("update, 99th percentile (ms)", summary("update_ms", "p99"), "{:.2f}", True),
             ("scans used", summary("scans_used"), "{}", None),
             ("scans seen", summary("scans_seen"), "{}", None),
             ("particles", summary("num_particles"), "{}", None),
             ("beams", summary("num_beams"), "{}", None),
             ("sensor model", summary("sensor_model"), "{}", None),
             ("range method", summary("range_method"), "{}", None),
             ("seed", summary("seed"), "{}", None)]
    return rows


def table_rows(rows, runs, consistencies, matches):
    """The rows with a value for any run. The best of several runs is marked."""
    table = []
    for label, value_of, text, lower_is_better in rows:
        values = [value_of(*each) for each in zip(runs, consistencies, matches)]
        if all(value is None for value in values):
            continue
        cells = [Cell("–" if value is None else text.format(value)) for value in values]
        if lower_is_better is not None and len(runs) > 1 and None not in values:
            best = min(values) if lower_is_better else max(values)
            for cell, value in zip(cells, values):
                cell.level = "good" if cell.text == text.format(best) else ""
        table.append([label] + cells)
    return table


def timeline_rows(runs, lost_error):
    rows = []
    for index, run in enumerate(runs):
        status, outcome = run.updates.column(STATUS), run.updates.column(OUTCOME)
        bars = []
        if status is not None:
            bars += [(spans(run.updates.stamps, status == state), shade)
                     for state, shade in STATUS_COLOURS.items()]
        if outcome is not None:
            bars.append((spans(run.updates.stamps, outcome == REJECTED), "#000000"))
        if status is not None or any(intervals for intervals, _ in bars):
            rows.append((index, f"{run.name}: status", bars))
        if run.errors is not None:
            rows.append((index, f"{run.name}: error > {lost_error:g} m",
                         [(spans(run.errors.stamps, run.errors.position > lost_error), BAD)]))
    return rows


def interval_table(runs, lost_error, max_rows=20):
    """Rows of the intervals with a large error or with status degraded or lost, at most `max_rows` per run."""
    rows = []
    for run in runs:
        found = []
        if run.errors is not None:
            found += [(f"error > {lost_error:g} m", interval) for interval in
                      spans(run.errors.stamps, run.errors.position > lost_error)]
        status = run.updates.column(STATUS)
        if status is not None:
            found += [(f"status {state}", interval) for state in (LOST, DEGRADED)
                      for interval in spans(run.updates.stamps, status == state)]
        found.sort(key=lambda each: each[1][0])
        for what, (first, last) in found[:max_rows]:
            begin, end = (first - run.start) * 1e-9, (last - run.start) * 1e-9
            rows.append([run.name, what, f"{begin:.1f}", f"{end:.1f}", f"{end - begin:.1f}"])
        if len(found) > max_rows:
            rows.append([run.name, f"and {len(found) - max_rows} more", "", "", ""])
    return rows


def level_table(runs, protections):
    """Rows per run and axis: fractions of errors above the level, median level and error, and their ratio."""
    rows = []
    for run, levels in zip(runs, protections):
        for axis, name in enumerate(protection.AXES if levels is not None else ()):
            unit, scale = ("deg", np.degrees(1.0)) if name == "heading" else ("m", 1.0)
            above, medians = levels.fraction_above(axis), levels.medians_while_localized(axis)
            row = [run.name, name,
                   Cell(f"{100.0 * above:.2f}", "good" if above <= protection.RISK else "bad")]
            if medians is None:
                rows.append(row + ["–"] * 4)
                continue
            level, error = medians
            rows.append(row + [f"{100.0 * levels.fraction_above_while_localized(axis):.2f}",
                               f"{scale * level:.3f} {unit}", f"{scale * error:.3f} {unit}",
                               f"{level / max(error, 1e-9):.1f}"])
    return rows


def build(page, runs, consistencies, matches, protections, plan, lost_error):
    """Adds all sections for which the runs have data."""
    header = ["quantity"] + [run.name for run in runs]
    numbers = page.section("Summary")
    errors = table_rows(error_rows(), runs, consistencies, matches)
    if errors:
        numbers.table(header, errors, "Errors against the ground truth, without alignment." +
                      (" Green: best." if len(runs) > 1 else ""))
    numbers.table(header, table_rows(filter_rows(), runs, consistencies, matches),
                  "Consistency, scan match and computing time.")

    section = page.section("Trajectory")
    section.figure(run_figures.trajectories(runs, plan), "trajectory",
                   "Estimate" + (" on the map" if plan else "") +
                   (", coloured by position error, over the ground truth (grey)." if errors else "."))
    with_truth = [run for run in runs if run.errors is not None]
    if with_truth:
        section = page.section("Errors")
        section.figure(run_figures.errors_over_time(with_truth, lost_error), "errors",
                       "Position, heading and cross-track error at every stamp of the ground truth.")
        section.figure(run_figures.histograms(with_truth), "histogram",
                       "Histogram and cumulative distribution of the position error. Dotted line: 95 %.")
    measured = [(run, each) for run, each in zip(runs, consistencies) if each is not None]
    if measured:
        section = page.section("Consistency")
        section.text("If the covariance is correct, 99.7 % of the errors per axis are within 3σ and the mean "
                     "normalised estimation error squared (NEES) is 3. A higher NEES means overconfidence, a "
                     "much lower one a pessimistic covariance.")
        for index, (run, each) in enumerate(measured):
            section.figure(run_figures.consistency(run, each), f"consistency-{index + 1}",
                           f"{run.name}: error of each update and the estimated ±3σ band.")
    levels = level_table(runs, protections)
    if levels:
        section = page.section("Protection level")
        section.text(f"At most {100.0 * protection.RISK:g} % of the updates may have an error above the level. A level "
                     "much larger than the error is safe but of little use.")
        section.table(["run", "axis", "error above level (% of updates)", "while localized (%)",
                       "median level", "median error", "level / error"], levels,
                      "Medians and their ratio while localized. Axes of the estimated pose.")
        for index, (run, each) in enumerate(zip(runs, protections)):
            if each is not None:
                section.figure(status_figures.stanford(run, each), f"stanford-{index + 1}",
                               f"{run.name}: level against error of every update (Stanford diagram). Below the "
                               "diagonal: misleading; level above the alarm limit of "
                               f"{protection.ALARM_LIMIT:g} m: unavailable. Outliers are drawn at the edge.")
    if any(match is not None for match in matches):
        shown = [(run, match) for run, match in zip(runs, matches) if match is not None]
        section = page.section("Scan match")
        section.text("Scans transformed with the estimated poses must lie on the walls of the map; no ground truth is "
                     "needed. Unmapped objects (people, chairs) do not match.")
        section.figure(run_figures.scans_on_map(*zip(*shown), plan), "scans",
                       f"End points of the beams: green within {scan_match.INLIER_DISTANCE:g} m of a wall, else red.")
        section.figure(run_figures.match_over_time(*zip(*shown)), "scan-match",
                       f"Per scan: mean distance of the end points to the nearest wall (truncated at "
                       f"{grid_map.MAX_DISTANCE:g} m), and inlier ratio (within {scan_match.INLIER_DISTANCE:g} m).")
    if any(run.updates.column("update_ms") is not None for run in runs):
        section = page.section("Filter")
        section.figure(status_figures.filter_over_time(runs), "filter",
                       "Update time, effective sample size and number of particles.")
    rows = timeline_rows(runs, lost_error)
    if rows:
        section = page.section("Status timeline")
        section.figure(status_figures.timeline(runs, rows), "timeline",
                       "Status reported by each run, and intervals with a large error.")
        intervals = interval_table(runs, lost_error)
        if intervals:
            section.table(["run", "what", "from (s)", "to (s)", "duration (s)"], intervals,
                          "Times since the first estimate of the run.")
        else:
            section.text("No large errors; no status degraded or lost.")
        for index, (run, each) in enumerate(zip(runs, protections)):
            if run.updates.column(STATUS) is not None:
                section.figure(status_figures.status_over_time(run, each), f"status-{index + 1}",
                               f"{run.name}: " + ("error and " if run.errors is not None else "") + "status" +
                               (", and classification of the beams."
                                if run.updates.column(INLIER_RATIO) is not None else "."))


def evaluate(options):
    runs, bags = load_runs(options)
    plan = grid_map.load_map(options.map) if options.map else None
    laser_pose = parse_pose(options.laser_pose) if options.laser_pose else None
    consistencies, matches, protections = [], [], []
    for run, recordings in zip(runs, bags):
        has_truth = run.errors is not None
        consistencies.append(consistency.measure(run, options.max_gap) if has_truth else None)
        protections.append(protection.measure(run, options.max_gap) if has_truth else None)
        matches.append(scan_match.measure(run, plan, recordings, options.scan_topic, options.base_frame,
                                          laser_pose, options.max_gap) if plan and recordings else None)
    page = HtmlReport(options.out, options.title, ", ".join(
        f"{run.name}: {run.trajectory.seconds()[-1]:.0f} s, {run.trajectory.length():.0f} m"
        for run in runs))
    page.banners = [assessment.assess(*each, options.lost) for each in zip(runs, consistencies, matches)]
    build(page, runs, consistencies, matches, protections, plan, options.lost)
    path = page.write()
    for banner in page.banners:
        print(f"{banner.name}: {banner.headline}: {'; '.join(banner.reasons)}")
    for run, levels in zip(runs, protections):
        if levels is not None:
            print(f"{run.name}: error above the level in " + ", ".join(
                f"{100.0 * levels.fraction_above(axis):.2f} % {name}"
                for axis, name in enumerate(protection.AXES)) + " of updates")
    print(f"report: {path}")


def main(arguments=None):
    return exit_status("evaluate", lambda: evaluate(parse(arguments)))
