"""scripts/demo: runs the localizer over a bag in a ROS graph and reports its errors."""
import argparse
import math
import os
import signal
import sys
from pathlib import Path

import numpy as np

from . import EvaluationError, bag, live_recording, programs, plot_style, run_figures
from .cli import exit_status
from .columns import LOCALIZED, STATUS
from .grid_map import load_map
from .ros_graph import RosGraph
from .run import TRUTH_TOPIC, load_folder, load_recorded, recorded_truth
from .trajectory import compare, read_tum

ROOT = programs.ROOT
ESTIMATE_TOPIC = "/pf/pose/odom"
MAX_GAP = 0.5  # s; longest gap between poses that is interpolated
START_UP = 90.0  # s, limit for the start and the end of the graph, in addition to the bag

# An optional map of a real building, and a start pose on it.
REAL_MAP = "maps/stata_basement.yaml"
REAL_START = "-53.456 5.101 -1.428"
REAL_DURATION = 30.0  # s

# Limits for the result "localized".
MEAN_LIMIT = 0.10  # m
MAX_LIMIT = 0.50  # m
RATE_LIMIT = 20.0  # Hz
INLIER_LIMIT = 0.5  # fraction of the beams, used without ground truth


def parse(arguments):
    parser = argparse.ArgumentParser(
        prog="scripts/demo",
        description="Runs the localizer over a bag in a ROS graph (roscore, map nodelet, localization nodelet, "
        "rosbag play; rviz if there is a display), prints errors, pose rate and update time, and plots map, "
        "ground truth and estimate. Without --bag, a drive on the corridor map is simulated. Exit status 1 "
        f"if the car was not localized. If {REAL_MAP} exists in the folder given by RACECAR_MCL_DATA "
        "(default: ../shared/data beside the repository), a simulated drive on it follows.")
    parser.add_argument("--headless", action="store_true", help="without rviz")
    parser.add_argument("--bag", type=Path, help="bag with scans and odometry")
    parser.add_argument("--map", type=Path, help="map_server YAML, required with --bag")
    parser.add_argument("--truth", type=Path,
                        help=f"ground truth as a TUM file; default: {TRUTH_TOPIC} of the bag, if present")
    parser.add_argument("--initial-pose", metavar='"X Y YAW"',
                        help="initial pose; default: that of the ground truth, else global localization")
    parser.add_argument("--scan-topic", default="/scan")
    parser.add_argument("--odom-topic", default="/vesc/odom")
    parser.add_argument("--imu-topic", default="/imu", help="sensor_msgs/Imu, optional: its gyro is used")
    parser.add_argument("--config", type=Path, default=ROOT / "config/default.yaml")
    parser.add_argument("--duration", type=float, default=60.0, help="length of the simulated drive, s")
    parser.add_argument("--speed", type=float, default=3.0, help="speed of the simulated drive, m/s")
    parser.add_argument("--odom-noise", type=float, default=0.1,
                        help="odometry noise of the simulated drive: sigma of each twist component, m/s and rad/s")
    parser.add_argument("--out", type=Path, default=ROOT / "build/demo", help="output folder")
    options = parser.parse_args(arguments)
    if (options.bag is None) != (options.map is None):
        parser.error("--bag and --map require each other")
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


def inspect_bag(path, topics):
    """Duration (s) and message counts by topic. Raises EvaluationError if one of `topics` is missing."""
    with bag.open_bag(path) as recording:
        counts = {topic: info.message_count
                  for topic, info in recording.get_type_and_topic_info().topics.items()}
        duration = recording.get_end_time() - recording.get_start_time()
    for topic in topics:
        if topic not in counts:
            raise EvaluationError(f"{path} has no topic {topic}; it has {', '.join(sorted(counts))}")
    return duration, counts


def start_arguments(options, truth):
    """The initial pose as options of replay and as launch arguments."""
    pose = options.initial_pose
    if pose is None and truth is not None:
        pose = " ".join(f"{value:.6f}" for value in truth.poses[0])
    if pose is None:
        return ["--global"], {"global_start": "true"}
    return ["--initial-pose", pose], {"initial_pose": pose}


def gyro_arguments(path, topic):
    """The options of replay for the gyro that the ROS graph uses, if the bag has one."""
    return ["--imu-topic", topic] if bag.has_topic(path, topic, "sensor_msgs/Imu") else []


def run_graph(options, recording, map_yaml, start, duration):
    """Runs the graph over a bag. Returns the Run and the bag with its output."""
    output = options.out / "estimate.bag"
    output.unlink(missing_ok=True)
    show = bool(os.environ.get("DISPLAY")) and not options.headless
    arguments = {"bag": recording, "map": map_yaml, "record": output, "scan_topic": options.scan_topic,
                 "odom_topic": options.odom_topic, "imu_topic": options.imu_topic,
                 "config": options.config.resolve(),
                 "rviz": str(show).lower(), **start}
    print(f"running the ROS graph, {duration:.0f} s" + (" with rviz" if show else ""))
    with RosGraph("racecar_mcl", "demo.launch", arguments, options.out) as graph:
        ended = graph.wait(duration + START_UP, progress(duration))
    if not output.exists():
        raise EvaluationError(f"no output was recorded; log: {graph.log}")
    if not ended:
        raise EvaluationError(f"the graph did not end within {duration + START_UP:.0f} s; log: {graph.log}")
    try:
        return load_recorded(output, ESTIMATE_TOPIC, "ROS"), output
    except EvaluationError as error:
        raise EvaluationError(f"no pose was published: {error}; log: {graph.log}") from error


def progress(duration):
    """A callback that prints the elapsed time, on a terminal only."""
    if not sys.stdout.isatty():
        return lambda elapsed: None
    return lambda elapsed: print(f"\r{min(elapsed, duration):4.0f} of {duration:.0f} s", end="\r",
                                 flush=True)


def error_rows(runs):
    """Rows of the summary with the errors of each run."""
    rows = []
    for name, take in (("mean", np.mean), ("p95", lambda e: np.percentile(e, 95)), ("max", np.max)):
        rows.append([f"position error, {name}"] +
                    [f"{100 * take(run.errors.position):.1f} cm" for run in runs])
    for name, take in (("mean", np.mean), ("max", np.max)):
        rows.append([f"heading error, {name}"] +
                    [f"{math.degrees(take(np.abs(run.errors.heading))):.2f} deg" for run in runs])
    # A start pose that is corrected by the first scans often sets the maximum, of one run only.
    start = min(run.start for run in runs)
    for name, errors_of in (("position", lambda errors: errors.position),
                            ("heading", lambda errors: np.abs(errors.heading))):
        largest = [int(np.argmax(errors_of(run.errors))) for run in runs]
        rows.append([f"{name} error, time of max"] +
                    [f"{run.errors.seconds(start)[index]:.1f} s" for run, index in zip(runs, largest)])
    return rows


def check_limits(live, inlier_ratio, fast_odometry):
    """The violated limits as text; empty if the car was localized."""
    problems = []
    if live.errors is not None:
        position = live.errors.position
        if position.mean() > MEAN_LIMIT:
            problems.append(f"mean position error {position.mean():.2f} m exceeds {MEAN_LIMIT} m")
        if position.max() > MAX_LIMIT:
            problems.append(f"max position error {position.max():.2f} m exceeds {MAX_LIMIT} m")
    elif not inlier_ratio >= INLIER_LIMIT:
        problems.append(f"only {inlier_ratio:.0%} of the ranges are within "
                        f"{live_recording.INLIER_DISTANCE} m of the expected ones")
    if fast_odometry and live.trajectory.rate() < RATE_LIMIT:
        problems.append(f"pose rate {live.trajectory.rate():.0f} Hz is below {RATE_LIMIT:.0f} Hz")
    return problems


def draw(runs, map_yaml, folder):
    """Plots the trajectories on the map, and with a truth the errors over time. Returns the files."""
    figures = {"trajectory.png": run_figures.trajectories(runs, load_map(map_yaml))}
    if runs[0].errors is not None:
        figures["errors.png"] = run_figures.errors_over_time(runs, MAX_LIMIT)
    for name, figure in figures.items():
        plot_style.save(figure, folder / name)
    return [folder / name for name in figures]


def data_folder():
    """Folder with maps and recordings of real buildings, which are not part of this repository."""
    return Path(os.environ.get("RACECAR_MCL_DATA", ROOT.parent / "shared/data"))


def since_localized(run, truth):
    """The errors from the first update with status localized on, as text."""
    localized = np.flatnonzero(run.updates.column(STATUS) == LOCALIZED)
    if len(localized) == 0:
        return "never localized"
    first = run.updates.stamps[localized[0]]
    errors = compare(run.trajectory, truth, MAX_GAP)
    position = errors.position[errors.stamps >= first]
    return (f"localized after {(first - run.updates.stamps[0]) * 1e-9:.1f} s; position error from then on: "
            f"mean {100 * position.mean():.1f} cm, max {100 * position.max():.1f} cm")


def show_real_building(out):
    """Simulates and replays a drive on the map of a real building, if that is available."""
    world = data_folder() / REAL_MAP
    if not world.is_file():
        return
    recording, tum = out / "building.bag", out / "building.tum"
    print(f"\nsimulating {REAL_DURATION:g} s on {world.name} and replaying it")
    try:
        programs.run("simulate_bag", ["--map", world, "--out", recording, "--truth", tum, "--start",
                                      REAL_START, "--duration", REAL_DURATION, "--seed", 1])
    except EvaluationError as error:
        print(f"simulation failed: {error}")
        return
    truth = read_tum(tum)
    for name, option, folder in (("true initial pose", "--initial-pose-from-truth", "building"),
                                 ("global localization", "--global", "building_global")):
        programs.run("replay", ["--bag", recording, "--map", world, "--out", out / folder, option])
        print(f"{name}: {since_localized(load_folder(out / folder), truth)}")


def demo(options):
    options.out.mkdir(parents=True, exist_ok=True)
    options.out = options.out.resolve()
    if options.bag is None:
        recording, map_yaml = simulate(options)
    else:
        recording, map_yaml = options.bag.resolve(), options.map.resolve()
    duration, counts = inspect_bag(recording, [options.scan_topic, options.odom_topic])
    truth = read_tum(options.truth) if options.truth else recorded_truth(recording)
    replay_start, launch_start = start_arguments(options, truth)

    live, output = run_graph(options, recording, map_yaml, launch_start, duration)
    print("replaying the bag without ROS")
    programs.run("replay", ["--bag", recording, "--map", map_yaml, "--out", options.out / "replay",
                            "--config", options.config, "--scan-topic", options.scan_topic,
                            "--odom-topic", options.odom_topic,
                            *gyro_arguments(recording, options.imu_topic), *replay_start])
    offline = load_folder(options.out / "replay")
    runs = [live, offline]
    if truth is not None:
        for run in runs:
            run.set_truth(truth, MAX_GAP)
    diagnostics = live_recording.last_diagnostics(output)
    inlier_ratio = live_recording.inlier_ratio(output)

    summary = offline.summary
    rows = error_rows(runs) if truth is not None else []
    rows += [
        ["pose rate"] + [f"{run.trajectory.rate():.0f} Hz" for run in runs],
        ["scans used", f"{diagnostics.get('scans used', '?')} of {counts[options.scan_topic]}",
         f"{summary['scans_used']} of {summary['scans_seen']}"],
        ["update, median", "", f"{summary['update_ms']['p50']:.2f} ms"],
        ["update, p99", "", f"{summary['update_ms']['p99']:.2f} ms"],
        ["latency scan to tf, median", f"{float(diagnostics.get('scan to tf p50 (ms)', 'nan')):.2f} ms", ""],
        [f"ranges within {live_recording.INLIER_DISTANCE} m of the map", f"{inlier_ratio:.0%}", ""],
    ]
    figures = draw(runs, map_yaml, options.out)

    print(f"\n{recording.name}: {live.trajectory.length():.0f} m in {duration:.0f} s on {map_yaml.name}")
    print(f"{'':32}" + "".join(f"{run.name:>14}" for run in runs))
    for name, over_ros, over_replay in rows:
        print(f"{name:32}{over_ros:>14}{over_replay:>14}")
    difference = compare(live.trajectory, offline.trajectory, MAX_GAP)
    if difference is not None:
        print(f"distance between the two: mean {100 * difference.position.mean():.1f} cm, "
              f"max {100 * difference.position.max():.1f} cm")
    if truth is None:
        print("no ground truth in the bag and none given: errors are unknown")
    print("figures: " + ", ".join(map(str, figures)))
    odometry_rate = counts[options.odom_topic] / max(duration, 1e-9)
    problems = check_limits(live, inlier_ratio, odometry_rate >= RATE_LIMIT)
    print("localized" if not problems else "NOT localized: " + "; ".join(problems))
    if options.bag is None:
        show_real_building(options.out)
    return 1 if problems else 0


def main(arguments=None):
    options = parse(arguments)
    # SIGTERM shuts the graph down in order, too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    return exit_status("demo", lambda: demo(options))
