"""scripts/evaluate: a page about one run or several side by side."""
import argparse
from pathlib import Path

import numpy as np

from . import (EvaluationError, consistency, grid_map, judgement, protection, run_figures, scan_fit)
from .command import exit_status
from .page import Cell, Page
from .run import TRUTH_TOPIC, load_folder, load_recorded, recorded_truth
from .style import BAD, VERDICTS
from .trajectory import read_tum, spans

DESCRIPTION = """Shows how well a car was localized: a page (index.html, opens from disk) and its
figures as PNG. A RUN is a folder that replay wrote, or a bag with a recorded estimate
(nav_msgs/Odometry). With a truth: errors and consistency. With --map and --bag: how well the scans lie
on the map, which needs no truth. Several runs are shown side by side."""


def parse(arguments):
    parser = argparse.ArgumentParser(prog="evaluate", description=DESCRIPTION)
    parser.add_argument("runs", nargs="+", metavar="RUN", type=Path)
    parser.add_argument("--out", required=True, type=Path, help="folder for the page and its figures")
    parser.add_argument("--name", action="append", metavar="NAME",
                        help="a run's name on the page, once per run; default: its folder's")
    parser.add_argument("--truth", action="append", metavar="T.tum", type=Path,
                        help=f"once for all runs or once per run; without it {TRUTH_TOPIC} of the bag "
                        "is the truth where a bag holds it")
    parser.add_argument("--map", metavar="M.yaml", type=Path, help="the map the runs were driven on")
    parser.add_argument("--bag", action="append", metavar="B[,B2]",
                        help="the recording with the scans, once for all runs or once per run")
    parser.add_argument("--scan-topic", default="/scan")
    parser.add_argument("--estimate-topic", default="/pf/pose/odom", help="of runs that are bags")
    parser.add_argument("--truth-topic", default=TRUTH_TOPIC)
    parser.add_argument("--base-frame", default="base_link")
    parser.add_argument("--laser-pose", metavar='"X Y YAW"',
                        help="of the lidar on the car, instead of the bag's tf")
    parser.add_argument("--max-gap", type=float, default=0.5,
                        help="s; no error is taken where poses lie further apart")
    parser.add_argument("--lost", type=float, default=0.5, metavar="M",
                        help="position error above which the car counts as lost")
    parser.add_argument("--title", default="Localization, evaluated")
    return parser.parse_args(arguments)


def per_run(values, count, option):
    """One value for each run, from one for all, one each, or none."""
    if not values:
        return [None] * count
    if len(values) == 1:
        return values * count
    if len(values) == count:
        return values
    raise EvaluationError(f"{option} is given {len(values)} times; expected once for all runs or once "
                          f"for each of the {count}")


def parse_pose(text):
    try:
        x, y, yaw = map(float, text.split())
    except ValueError:
        raise EvaluationError(f"--laser-pose is '{text}'; expected \"x y yaw\" (m, m, rad)") from None
    return x, y, yaw


def load_runs(options):
    """The runs with their truths, and each run's bags."""
    count = len(options.runs)
    names = options.name or [None] * count
    if len(names) != count:
        raise EvaluationError(f"--name is given {len(names)} times; expected once for each of the "
                              f"{count} runs")
    bags = [[Path(part) for part in told.split(",")] if told else []
            for told in per_run(options.bag, count, "--bag")]
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
    """Folders of equal names are told apart by their parents'."""
    for run in runs:
        if sum(other.name == run.name for other in runs) > 1:
            run.name = f"{run.source.resolve().parent.name}/{run.name}"


# Rows of the table: label, value of (run, consistency, fit) or None, format, whether less is better.
def rows_of_errors():
    def position(key):
        return lambda run, told, fit: run.errors and run.errors.summary()["position_error_m"][key]

    def heading(key):
        return lambda run, told, fit: run.errors and run.errors.summary()["heading_error_deg"][key]

    rows = [(f"position error, {word} (m)", position(key), "{:.3f}", True) for key, word in (
        ("mean", "mean"), ("median", "median"), ("rmse", "rms"), ("p95", "95th percentile"),
        ("max", "greatest"), ("final", "at the end"))]
    rows += [("cross-track error, mean of its size (m)",
              lambda run, told, fit: run.errors and np.abs(run.errors.cross_track).mean(), "{:.3f}", True)]
    rows += [(f"heading error, {word} (deg)", heading(key), "{:.2f}", True) for key, word in (
        ("mean", "mean"), ("p95", "95th percentile"), ("max", "greatest"))]
    rows += [("truth stamps used", lambda run, told, fit: run.errors and len(run.errors.stamps), "{}", None),
             ("truth stamps skipped (gaps)", lambda run, told, fit: run.errors and run.errors.skipped,
              "{}", None)]
    return rows


def rows_of_filter():
    def share(axis):
        return lambda run, told, fit: told and 100.0 * told.within_3_sigma[axis]

    def summary(*keys):
        def look_up(run, told, fit):
            value = run.summary
            for key in keys:
                value = value.get(key) if value else None
            return value
        return look_up

    rows = [(f"{axis} within 3σ (% of updates)", share(index), "{:.1f}", False)
            for index, axis in enumerate(consistency.AXES)]
    rows += [("NEES, mean (3 is right)",
              lambda run, told, fit: told and consistency.round_text(told.mean_nees), "{}", None),
             (f"beams within {scan_fit.NEAR:g} m of a wall (%)",
              lambda run, told, fit: fit and 100.0 * fit.near, "{:.1f}", False),
             ("distance of scan points to walls, mean (m)", lambda run, told, fit: fit and fit.mean,
              "{:.3f}", True),
             ("update, mean (ms)", summary("update_ms", "mean"), "{:.2f}", True),
             ("update, 99th percentile (ms)", summary("update_ms", "p99"), "{:.2f}", True),
             ("scans used", summary("scans_used"), "{}", None),
             ("scans seen", summary("scans_seen"), "{}", None),
             ("particles", summary("num_particles"), "{}", None),
             ("beams", summary("num_beams"), "{}", None),
             ("range method", summary("range_method"), "{}", None),
             ("seed", summary("seed"), "{}", None)]
    return rows


def table_rows(rows, runs, told, fits):
    """The rows that any run has a value for; the best of several in green."""
    table = []
    for label, value_of, text, less_is_better in rows:
        values = [value_of(*each) for each in zip(runs, told, fits)]
        if all(value is None for value in values):
            continue
        cells = [Cell("–" if value is None else text.format(value)) for value in values]
        if less_is_better is not None and len(runs) > 1 and None not in values:
            best = min(values) if less_is_better else max(values)
            for cell, value in zip(cells, values):
                cell.level = "good" if cell.text == text.format(best) else ""
        table.append([label] + cells)
    return table


def timeline_rows(runs, lost_error):
    rows = []
    for index, run in enumerate(runs):
        verdict, outcome = run.updates.column("verdict"), run.updates.column("outcome")
        said = []
        if verdict is not None:
            said += [(spans(run.updates.stamps, verdict == word), shade)
                     for word, shade in VERDICTS.items()]
        if outcome is not None:
            said.append((spans(run.updates.stamps, outcome == "weights_vanished"), "#000000"))
        if verdict is not None or any(stretches for stretches, _ in said):
            rows.append((index, f"{run.name}: said", said))
        if run.errors is not None:
            rows.append((index, f"{run.name}: error > {lost_error:g} m",
                         [(spans(run.errors.stamps, run.errors.position > lost_error), BAD)]))
    return rows


def stretch_table(runs, lost_error, most=20):
    """When which run was lost, and when it said so."""
    rows = []
    for run in runs:
        found = []
        if run.errors is not None:
            found += [(f"error over {lost_error:g} m", stretch) for stretch in
                      spans(run.errors.stamps, run.errors.position > lost_error)]
        verdict = run.updates.column("verdict")
        if verdict is not None:
            found += [(f"said {word}", stretch) for word in ("lost", "degraded")
                      for stretch in spans(run.updates.stamps, verdict == word)]
        found.sort(key=lambda each: each[1][0])
        for what, (first, last) in found[:most]:
            begin, end = (first - run.start) * 1e-9, (last - run.start) * 1e-9
            rows.append([run.name, what, f"{begin:.1f}", f"{end:.1f}", f"{end - begin:.1f}"])
        if len(found) > most:
            rows.append([run.name, f"and {len(found) - most} times more", "", "", ""])
    return rows


def level_table(runs, protected):
    """How often errors exceed the level, and how much greater than the error it usually is."""
    rows = []
    for run, levels in zip(runs, protected):
        for axis, name in enumerate(protection.AXES if levels is not None else ()):
            unit, scale = ("deg", np.degrees(1.0)) if name == "heading" else ("m", 1.0)
            above, medians = levels.share_above(axis), levels.medians_while_localized(axis)
            row = [run.name, name,
                   Cell(f"{100.0 * above:.2f}", "good" if above <= protection.RISK else "bad")]
            if medians is None:
                rows.append(row + ["–"] * 4)
                continue
            level, error = medians
            rows.append(row + [f"{100.0 * levels.share_above_while_localized(axis):.2f}",
                               f"{scale * level:.3f} {unit}", f"{scale * error:.3f} {unit}",
                               f"{level / max(error, 1e-9):.1f}"])
    return rows


def build(page, runs, told, fits, protected, plan, lost_error):
    """Everything that the runs have something to show for."""
    named = ["what"] + [run.name for run in runs]
    numbers = page.section("Figures of merit")
    errors = table_rows(rows_of_errors(), runs, told, fits)
    if errors:
        numbers.table(named, errors, "Errors against the truth, without any alignment." +
                      (" Green: the best." if len(runs) > 1 else ""))
    numbers.table(named, table_rows(rows_of_filter(), runs, told, fits),
                  "What the filter claimed and needed.")

    way = page.section("Trajectory")
    way.figure(run_figures.trajectories(runs, plan), "trajectory",
               "The estimate" + (" on the map" if plan else "") +
               (", coloured by its error, over the truth (grey)." if errors else "."))
    known = [run for run in runs if run.errors is not None]
    if known:
        section = page.section("Errors")
        section.figure(run_figures.errors_over_time(known, lost_error), "errors",
                       "Position, heading and cross-track error at every stamp of the truth.")
        section.figure(run_figures.histograms(known), "histogram",
                       "How often which position error. The dotted line marks 95 %.")
    measured = [(run, each) for run, each in zip(runs, told) if each is not None]
    if measured:
        section = page.section("Consistency")
        section.text("Are the errors as large as the filter claims? Per axis 99.7 % should lie within "
                     "3σ, and the normalised estimation error squared (NEES) should be 3 on average: "
                     "more is over-confident, much less is too modest.")
        for index, (run, each) in enumerate(measured):
            section.figure(run_figures.consistency(run, each), f"consistency-{index + 1}",
                           f"{run.name}: error of each update and the band of ±3σ it claimed.")
    levels = level_table(runs, protected)
    if levels:
        section = page.section("Protection level")
        section.text("Is the error as small as the level promises? At most "
                     f"{100.0 * protection.RISK:g} % of updates may exceed it; a level much greater "
                     "than the error is safe but of little use.")
        section.table(["run", "axis", "error above level (% of updates)", "while localized (%)",
                       "median level", "median error", "level / error"], levels,
                      "Medians and their ratio while localized. Along and across the estimated car.")
        for index, (run, each) in enumerate(zip(runs, protected)):
            if each is not None:
                section.figure(run_figures.stanford(run, each), f"stanford-{index + 1}",
                               f"{run.name}: error against level of every update (Stanford diagram). Below "
                               "the diagonal the level misleads; above the alarm limit of "
                               f"{protection.ALARM_LIMIT:g} m it is unavailable. What lies outside is "
                               "shown at the edge.")
    if any(fit is not None for fit in fits):
        shown = [(run, fit) for run, fit in zip(runs, fits) if fit is not None]
        section = page.section("Scans on the map")
        section.text("Needs no truth: scans drawn from where the estimate says they were taken must "
                     "lie on the walls. Things that are on no map (people, chairs) never do.")
        section.figure(run_figures.scans_on_map(*zip(*shown), plan), "scans",
                       f"Scan points, at most {scan_fit.NEAR:g} m from a wall in green, others in red.")
        section.figure(run_figures.fit_over_time(*zip(*shown)), "scan-fit",
                       f"Scan by scan: mean distance from its points to the nearest wall (counted up "
                       f"to {grid_map.FARTHEST:g} m), and share of beams within {scan_fit.NEAR:g} m.")
    if any(run.updates.column("update_ms") is not None for run in runs):
        section = page.section("The filter at work")
        section.figure(run_figures.filter_over_time(runs), "filter",
                       "Time per update, effective sample size and number of particles.")
    rows = timeline_rows(runs, lost_error)
    if rows:
        section = page.section("Lost and found")
        section.figure(run_figures.timeline(runs, rows), "timeline",
                       "What each run said of itself, and when it truly was lost.")
        stretches = stretch_table(runs, lost_error)
        if stretches:
            section.table(["run", "what", "from (s)", "to (s)", "lasted (s)"], stretches,
                          "Times count from the run's first estimate.")
        else:
            section.text("No run was lost or said so.")
        for index, (run, each) in enumerate(zip(runs, protected)):
            if run.updates.column("verdict") is not None:
                section.figure(run_figures.status_over_time(run, each), f"status-{index + 1}",
                               f"{run.name}: what it said of itself" +
                               (" under its error" if run.errors is not None else "") +
                               (", and what the map made of the scans."
                                if run.updates.column("explained") is not None else "."))


def evaluate(options):
    runs, bags = load_runs(options)
    plan = grid_map.load_map(options.map) if options.map else None
    laser_pose = parse_pose(options.laser_pose) if options.laser_pose else None
    told, fits, protected = [], [], []
    for run, recordings in zip(runs, bags):
        known = run.errors is not None
        told.append(consistency.measure(run, options.max_gap) if known else None)
        protected.append(protection.measure(run, options.max_gap) if known else None)
        fits.append(scan_fit.measure(run, plan, recordings, options.scan_topic, options.base_frame,
                                     laser_pose, options.max_gap) if plan and recordings else None)
    page = Page(options.out, options.title, ", ".join(
        f"{run.name}: {run.trajectory.seconds()[-1]:.0f} s, {run.trajectory.length():.0f} m"
        for run in runs))
    page.banners = [judgement.judge(*each, options.lost) for each in zip(runs, told, fits)]
    build(page, runs, told, fits, protected, plan, options.lost)
    path = page.write()
    for banner in page.banners:
        print(f"{banner.name}: {banner.headline}: {'; '.join(banner.reasons)}")
    for run, levels in zip(runs, protected):
        if levels is not None:
            print(f"{run.name}: error above its level in " + ", ".join(
                f"{100.0 * levels.share_above(axis):.2f} % {name}"
                for axis, name in enumerate(protection.AXES)) + " of updates")
    print(f"page: {path}")


def main(arguments=None):
    return exit_status("evaluate", lambda: evaluate(parse(arguments)))
