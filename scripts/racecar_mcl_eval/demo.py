"""scripts/demo: localizes a car over a bag on the real ROS graph, and says how well."""
import argparse
import math
import os
import signal
import sys
from pathlib import Path

import numpy as np

from . import EvaluationError, bag, live_record, programs, run_figures, style
from .command import exit_status
from .grid_map import load_map
from .ros_graph import RosGraph
from .run import TRUTH_TOPIC, load_folder, load_recorded, recorded_truth
from .trajectory import compare, read_tum

ROOT = programs.ROOT
ESTIMATE_TOPIC = "/pf/pose/odom"
MAX_GAP = 0.5  # s; no error is taken where poses lie further apart
START_UP = 90.0  # s a graph may take to come up and go down, besides the bag

# A map of a real building, where it is at hand, and a place in it from where the car drives on.
REAL_MAP = "maps/stata_basement.yaml"
REAL_START = "-53.456 5.101 -1.428"
REAL_DURATION = 30.0  # s

# What counts as localized.
MEAN_LIMIT = 0.10  # m
MAX_LIMIT = 0.50  # m
RATE_LIMIT = 20.0  # Hz
AGREEING_LIMIT = 0.5  # share of the beams, where there is no truth


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="scripts/demo",
        description="Without --bag: simulates a drive on the corridor map. Runs the ROS graph over the "
        "bag (roscore, map nodelet, localization nodelet, rosbag play; rviz if there is a display), "
        "prints errors, rate and update time, and draws map, truth and estimate. Exit status 1 when "
        "the car was not localized. Where the folder that RACECAR_MCL_DATA names, else "
        f"../shared/data beside the repository, holds {REAL_MAP}, a simulated drive there follows.")
    parser.add_argument("--headless", action="store_true", help="no rviz")
    parser.add_argument("--bag", type=Path, help="a bag of your own, with scans and odometry")
    parser.add_argument("--map", type=Path, help="its map, a map_server YAML")
    parser.add_argument("--truth", type=Path,
                        help=f"its truth, a TUM file; without one {TRUTH_TOPIC} of the bag if there")
    parser.add_argument("--initial-pose", metavar='"X Y YAW"',
                        help="where the car starts; default: where the truth starts, else anywhere")
    parser.add_argument("--scan-topic", default="/scan")
    parser.add_argument("--odom-topic", default="/vesc/odom")
    parser.add_argument("--config", type=Path, default=ROOT / "config/default.yaml")
    parser.add_argument("--duration", type=float, default=60.0, help="simulated drive, s")
    parser.add_argument("--speed", type=float, default=3.0, help="simulated drive, m/s")
    parser.add_argument("--odom-noise", type=float, default=0.1,
                        help="simulated drive: sigma of each twist component, m/s and rad/s")
    parser.add_argument("--out", type=Path, default=ROOT / "build/demo", help="folder for all files")
    options = parser.parse_args(arguments)
    if (options.bag is None) != (options.map is None):
        parser.error("--bag and --map belong together")
    return options


def simulate(options):
    path = options.out / "drive.bag"
    world = ROOT / "maps/corridor.yaml"
    print(f"simulating {options.duration:g} s at {options.speed:g} m/s on {world.name}, odometry "
          f"noise {options.odom_noise:g}")
    programs.run("simulate_bag", ["--map", world, "--out", path, "--duration", options.duration,
                                  "--speed", options.speed, "--odom-noise", options.odom_noise,
                                  "--seed", 1])
    return path, world


def look_into(path, topics):
    """Seconds of the bag, and how many messages each of its topics holds; an error names the topic
    that is not in it, and those that are."""
    with bag.open_bag(path) as recording:
        counts = {topic: info.message_count
                  for topic, info in recording.get_type_and_topic_info().topics.items()}
        duration = recording.get_end_time() - recording.get_start_time()
    for topic in topics:
        if topic not in counts:
            raise EvaluationError(f"{path} has no topic {topic}; it has {', '.join(sorted(counts))}")
    return duration, counts


def start_arguments(options, truth):
    """The start as replay's options and as launch arguments."""
    pose = options.initial_pose
    if pose is None and truth is not None:
        pose = " ".join(f"{value:.6f}" for value in truth.poses[0])
    if pose is None:
        return ["--global"], {"global_start": "true"}
    return ["--initial-pose", pose], {"initial_pose": pose}


def run_graph(options, recording, map_yaml, start, duration):
    """The run that the graph recorded over the recording, and that record."""
    record = options.out / "estimate.bag"
    record.unlink(missing_ok=True)
    show = bool(os.environ.get("DISPLAY")) and not options.headless
    arguments = {"bag": recording, "map": map_yaml, "record": record, "scan_topic": options.scan_topic,
                 "odom_topic": options.odom_topic, "config": options.config.resolve(),
                 "rviz": str(show).lower(), **start}
    print(f"running the ROS graph over it, {duration:.0f} s" + (" with rviz" if show else ""))
    with RosGraph("racecar_mcl", "demo.launch", arguments, options.out) as graph:
        ended = graph.wait(duration + START_UP, progress(duration))
    if not record.exists():
        raise EvaluationError(f"the graph recorded nothing; its log: {graph.log}")
    if not ended:
        raise EvaluationError(f"the bag did not end within {duration + START_UP:.0f} s; log: {graph.log}")
    try:
        return load_recorded(record, ESTIMATE_TOPIC, "over ROS"), record
    except EvaluationError as error:
        raise EvaluationError(f"no pose came out: {error}; the log says why: {graph.log}") from error


def progress(duration):
    """A line that counts up, on a terminal only."""
    if not sys.stdout.isatty():
        return lambda elapsed: None
    return lambda elapsed: print(f"\r{min(elapsed, duration):4.0f} of {duration:.0f} s", end="\r",
                                 flush=True)


def error_rows(runs):
    """Rows of the summary."""
    rows = []
    for name, take in (("mean", np.mean), ("p95", lambda e: np.percentile(e, 95)), ("max", np.max)):
        rows.append([f"position error, {name}"] +
                    [f"{100 * take(run.errors.position):.1f} cm" for run in runs])
    for name, take in (("mean", np.mean), ("max", np.max)):
        rows.append([f"heading error, {name}"] +
                    [f"{math.degrees(take(np.abs(run.errors.heading))):.2f} deg" for run in runs])
    return rows


def judge(live, agreeing, fast_odometry):
    """The reasons why the car was not localized; none if it was."""
    problems = []
    if live.errors is not None:
        position = live.errors.position
        if position.mean() > MEAN_LIMIT:
            problems.append(f"mean position error {position.mean():.2f} m is over {MEAN_LIMIT} m")
        if position.max() > MAX_LIMIT:
            problems.append(f"position error reached {position.max():.2f} m, over {MAX_LIMIT} m")
    elif not agreeing >= AGREEING_LIMIT:
        problems.append(f"only {agreeing:.0%} of the beams lie within {live_record.NEAR} m of the map")
    if fast_odometry and live.trajectory.rate() < RATE_LIMIT:
        problems.append(f"pose rate {live.trajectory.rate():.0f} Hz is under {RATE_LIMIT:.0f} Hz")
    return problems


def draw(runs, map_yaml, folder):
    """The drive on its map, and the errors over time where there is a truth."""
    figures = {"trajectory.png": run_figures.trajectories(runs, load_map(map_yaml))}
    if runs[0].errors is not None:
        figures["errors.png"] = run_figures.errors_over_time(runs, MAX_LIMIT)
    for name, figure in figures.items():
        style.save(figure, folder / name)
    return [folder / name for name in figures]


def data_folder():
    """Maps and recordings of real buildings, which are not part of this repository."""
    return Path(os.environ.get("RACECAR_MCL_DATA", ROOT.parent / "shared/data"))


def since_localized(run, truth):
    """Errors from the update on that was first called localized, as a line."""
    said = np.flatnonzero(run.updates.column("verdict") == "localized")
    if len(said) == 0:
        return "never localized"
    first = run.updates.stamps[said[0]]
    errors = compare(run.trajectory, truth, MAX_GAP)
    position = errors.position[errors.stamps >= first]
    return (f"localized after {(first - run.updates.stamps[0]) * 1e-9:.1f} s; from then on position "
            f"error {100 * position.mean():.1f} cm on average, {100 * position.max():.1f} cm at most")


def show_real_building(out):
    """Simulates a drive in the map of a real building, if it is there, and replays it."""
    world = data_folder() / REAL_MAP
    if not world.is_file():
        return
    recording, tum = out / "building.bag", out / "building.tum"
    print(f"\nsimulating {REAL_DURATION:g} s on {world.name}, and replaying them")
    try:
        programs.run("simulate_bag", ["--map", world, "--out", recording, "--truth", tum, "--start",
                                      REAL_START, "--duration", REAL_DURATION, "--seed", 1])
    except EvaluationError as error:
        print(f"not driven: {error}")
        return
    truth = read_tum(tum)
    for name, option, folder in (("from the true start", "--initial-pose-from-truth", "building"),
                                 ("anywhere on the map", "--global", "building_global")):
        programs.run("replay", ["--bag", recording, "--map", world, "--out", out / folder, option])
        print(f"{name}: {since_localized(load_folder(out / folder), truth)}")


def demo(options):
    options.out.mkdir(parents=True, exist_ok=True)
    options.out = options.out.resolve()
    if options.bag is None:
        recording, map_yaml = simulate(options)
    else:
        recording, map_yaml = options.bag.resolve(), options.map.resolve()
    duration, counts = look_into(recording, [options.scan_topic, options.odom_topic])
    truth = read_tum(options.truth) if options.truth else recorded_truth(recording)
    replay_start, launch_start = start_arguments(options, truth)

    live, record = run_graph(options, recording, map_yaml, launch_start, duration)
    print("replaying the bag without ROS")
    programs.run("replay", ["--bag", recording, "--map", map_yaml, "--out", options.out / "replay",
                            "--config", options.config, "--scan-topic", options.scan_topic,
                            "--odom-topic", options.odom_topic, *replay_start])
    offline = load_folder(options.out / "replay")
    runs = [live, offline]
    if truth is not None:
        for run in runs:
            run.set_truth(truth, MAX_GAP)
    said = live_record.last_diagnostics(record)
    agreeing = live_record.agreeing_beams(record)

    summary = offline.summary
    rows = error_rows(runs) if truth is not None else []
    rows += [
        ["pose rate"] + [f"{run.trajectory.rate():.0f} Hz" for run in runs],
        ["scans used", f"{said.get('scans used', '?')} of {counts[options.scan_topic]}",
         f"{summary['scans_used']} of {summary['scans_seen']}"],
        ["update, median", "", f"{summary['update_ms']['p50']:.2f} ms"],
        ["update, p99", "", f"{summary['update_ms']['p99']:.2f} ms"],
        ["scan in to pose out, median", f"{float(said.get('scan to tf p50 (ms)', 'nan')):.2f} ms", ""],
        [f"beams within {live_record.NEAR} m of the map", f"{agreeing:.0%}", ""],
    ]
    pictures = draw(runs, map_yaml, options.out)

    print(f"\n{recording.name}: {live.trajectory.length():.0f} m in {duration:.0f} s on {map_yaml.name}")
    print(f"{'':32}" + "".join(f"{run.name:>14}" for run in runs))
    for name, over_ros, over_replay in rows:
        print(f"{name:32}{over_ros:>14}{over_replay:>14}")
    apart = compare(live.trajectory, offline.trajectory, MAX_GAP)
    if apart is not None:
        print(f"the two lie {100 * apart.position.mean():.1f} cm apart on average, "
              f"{100 * apart.position.max():.1f} cm at most")
    if truth is None:
        print("no truth in the bag and none given: errors cannot be told")
    print("pictures: " + ", ".join(map(str, pictures)))
    odometry_rate = counts[options.odom_topic] / max(duration, 1e-9)
    problems = judge(live, agreeing, odometry_rate >= RATE_LIMIT)
    print("localized" if not problems else "NOT localized: " + "; ".join(problems))
    if options.bag is None:
        show_real_building(options.out)
    return 1 if problems else 0


def main(arguments=None):
    options = parse(arguments)
    # A plain kill ends the graph in order as well.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    return exit_status("demo", lambda: demo(options))
