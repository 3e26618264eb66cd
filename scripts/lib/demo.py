"""Localizes a car over a bag on the real ROS graph, and says how well."""
import argparse
import json
import math
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy
import rosbag

import live_record
import picture
import trajectory
from ros_graph import RosGraph

ROOT = Path(__file__).resolve().parents[2]
TRUTH_TOPIC = "/ground_truth/odom"
ESTIMATE_TOPIC = "/pf/pose/odom"
START_UP = 90.0  # s a graph may take to come up and go down, besides the bag

# What counts as localized.
MEAN_LIMIT = 0.10  # m
MAX_LIMIT = 0.50  # m
RATE_LIMIT = 20.0  # Hz
AGREEING_LIMIT = 0.5  # share of the beams, where there is no truth


class DemoError(Exception):
    pass


def parse_arguments():
    parser = argparse.ArgumentParser(
        prog="scripts/demo",
        description="Without --bag: simulates a drive on the corridor map. Runs the ROS graph over the "
        "bag (roscore, map nodelet, localization nodelet, rosbag play; rviz if there is a display), "
        "prints errors, rate and update time, and draws map, truth and estimate. Exit status 1 when "
        "the car was not localized.")
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
    options = parser.parse_args()
    if (options.bag is None) != (options.map is None):
        parser.error("--bag and --map belong together")
    return options


def program(name, arguments, log):
    """Runs one of the package's programs; its output goes to a file, or to the error."""
    result = subprocess.run(["rosrun", "racecar_mcl", name, *map(str, arguments)], check=False,
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT)
    log.write_bytes(result.stdout)
    if result.returncode != 0:
        raise DemoError(f"{name} failed: {result.stdout.decode(errors='replace').strip()}")


def simulate(options):
    bag = options.out / "drive.bag"
    world = ROOT / "maps/corridor.yaml"
    print(f"simulating {options.duration:g} s at {options.speed:g} m/s on {world.name}, odometry "
          f"noise {options.odom_noise:g}")
    program("simulate_bag", ["--map", world, "--out", bag, "--duration", options.duration, "--speed",
                             options.speed, "--odom-noise", options.odom_noise, "--seed", 1],
            options.out / "simulate.log")
    return bag, world


def bag_duration(path, topics):
    """Seconds of the bag; an error names the topic that is not in it, and those that are."""
    try:
        with rosbag.Bag(str(path)) as bag:
            present = bag.get_type_and_topic_info().topics
            duration = bag.get_end_time() - bag.get_start_time()
    except (OSError, rosbag.ROSBagException) as error:
        raise DemoError(f"{path} cannot be read: {error}") from error
    for topic in topics:
        if topic not in present:
            raise DemoError(f"{path} has no topic {topic}; it has {', '.join(sorted(present))}")
    return duration, present


def start_arguments(options, truth):
    """The start as replay's options and as launch arguments."""
    pose = options.initial_pose
    if pose is None and truth is not None:
        pose = f"{truth.x[0]:.6f} {truth.y[0]:.6f} {truth.yaw[0]:.6f}"
    if pose is None:
        return ["--global"], {"global_start": "true"}
    return ["--initial-pose", pose], {"initial_pose": pose}


def run_graph(options, bag, map_yaml, start, duration):
    record = options.out / "estimate.bag"
    record.unlink(missing_ok=True)
    show = bool(os.environ.get("DISPLAY")) and not options.headless
    arguments = {"bag": bag, "map": map_yaml, "record": record, "scan_topic": options.scan_topic,
                 "odom_topic": options.odom_topic, "config": options.config.resolve(),
                 "rviz": str(show).lower(), **start}
    print(f"running the ROS graph over it, {duration:.0f} s" + (" with rviz" if show else ""))
    with RosGraph("racecar_mcl", "demo.launch", arguments, options.out) as graph:
        ended = graph.wait(duration + START_UP, progress(duration))
    if not record.exists():
        raise DemoError(f"the graph recorded nothing; its log: {graph.log}")
    if not ended:
        raise DemoError(f"the bag did not end within {duration + START_UP:.0f} s; log: {graph.log}")
    return record


def progress(duration):
    """A line that counts up, on a terminal only."""
    if not sys.stdout.isatty():
        return lambda elapsed: None
    return lambda elapsed: print(f"\r{min(elapsed, duration):4.0f} of {duration:.0f} s", end="\r",
                                 flush=True)


def error_lines(live, offline, truth):
    """Rows of the summary, and the live position errors."""
    stamps, position, heading = trajectory.errors(live, truth)
    _, position_offline, heading_offline = trajectory.errors(offline, truth)
    if len(position) == 0 or len(position_offline) == 0:
        raise DemoError("the truth and the estimate have no time in common")
    rows = []
    for name, take in (("mean", numpy.mean), ("p95", lambda e: numpy.percentile(e, 95)),
                       ("max", numpy.max)):
        rows.append((f"position error, {name}", f"{100 * take(position):.1f} cm",
                     f"{100 * take(position_offline):.1f} cm"))
    for name, take in (("mean", numpy.mean), ("max", numpy.max)):
        rows.append((f"heading error, {name}", f"{math.degrees(take(heading)):.2f} deg",
                     f"{math.degrees(take(heading_offline)):.2f} deg"))
    return rows, stamps, position


def judge(live, offline, position, agreeing, fast_odometry):
    """The reasons why the car was not localized; none if it was."""
    problems = []
    if position is not None:
        if position.mean() > MEAN_LIMIT:
            problems.append(f"mean position error {position.mean():.2f} m is over {MEAN_LIMIT} m")
        if position.max() > MAX_LIMIT:
            problems.append(f"position error reached {position.max():.2f} m, over {MAX_LIMIT} m")
    elif not agreeing >= AGREEING_LIMIT:
        problems.append(f"only {agreeing:.0%} of the beams lie within {live_record.NEAR} m of the map")
    if fast_odometry and live.rate < RATE_LIMIT:
        problems.append(f"pose rate {live.rate:.0f} Hz is under {RATE_LIMIT:.0f} Hz")
    if len(offline) == 0:
        problems.append("replay gave no pose")
    return problems


def run(options):
    options.out.mkdir(parents=True, exist_ok=True)
    options.out = options.out.resolve()
    if options.bag is None:
        bag, map_yaml = simulate(options)
    else:
        bag, map_yaml = options.bag.resolve(), options.map.resolve()
    duration, topics = bag_duration(bag, [options.scan_topic, options.odom_topic])
    truth = None
    if options.truth is not None:
        truth = trajectory.read_tum(options.truth)
    elif TRUTH_TOPIC in topics:
        truth = trajectory.read_odometry(bag, TRUTH_TOPIC)
    replay_start, launch_start = start_arguments(options, truth)

    record = run_graph(options, bag, map_yaml, launch_start, duration)
    live = trajectory.read_odometry(record, ESTIMATE_TOPIC)
    if len(live) < 2:
        raise DemoError(f"no pose came out; the log says why: {options.out / 'roslaunch.log'}")
    print("replaying the bag without ROS")
    program("replay", ["--bag", bag, "--map", map_yaml, "--out", options.out / "replay", "--config",
                       options.config, "--scan-topic", options.scan_topic, "--odom-topic",
                       options.odom_topic, *replay_start], options.out / "replay.log")
    offline = trajectory.read_tum(options.out / "replay/trajectory.tum")
    summary = json.loads((options.out / "replay/summary.json").read_text(encoding="utf-8"))
    said = live_record.last_diagnostics(record)
    agreeing = live_record.agreeing_beams(record)

    rows, error, position = [], None, None
    if truth is not None:
        rows, stamps, position = error_lines(live, offline, truth)
        error = (stamps, position)
    update = summary["update_ms"]
    rows += [
        ("pose rate", f"{live.rate:.0f} Hz", f"{offline.rate:.0f} Hz"),
        ("scans used", f"{said.get('scans used', '?')} of {topics[options.scan_topic].message_count}",
         f"{summary['scans_used']} of {summary['scans_seen']}"),
        ("update, median", "", f"{update['p50']:.2f} ms"),
        ("update, p99", "", f"{update['p99']:.2f} ms"),
        ("scan in to pose out, median", f"{float(said.get('scan to tf p50 (ms)', 'nan')):.2f} ms", ""),
        ("beams within 0.2 m of the map", f"{agreeing:.0%}", ""),
    ]
    drawing = options.out / "trajectory.png"
    picture.draw_drive(drawing, map_yaml, live, f"{bag.name}: the estimate over ROS", truth, error)

    print(f"\n{bag.name}: {live.length:.0f} m in {duration:.0f} s on {map_yaml.name}")
    print(f"{'':32}{'over ROS':>14}{'replay':>14}")
    for name, over_ros, over_replay in rows:
        print(f"{name:32}{over_ros:>14}{over_replay:>14}")
    _, apart, _ = trajectory.errors(live, offline)
    if len(apart) > 0:
        print(f"the two lie {100 * apart.mean():.1f} cm apart on average, {100 * apart.max():.1f} cm at most")
    if truth is None:
        print("no truth in the bag and none given: errors cannot be told")
    print(f"picture: {drawing}")
    odometry_rate = topics[options.odom_topic].message_count / max(duration, 1e-9)
    problems = judge(live, offline, position, agreeing, odometry_rate >= RATE_LIMIT)
    print("localized" if not problems else "NOT localized: " + "; ".join(problems))
    return 1 if problems else 0


def main():
    options = parse_arguments()
    # A plain kill ends the graph in order as well.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        return run(options)
    except DemoError as error:
        print(f"demo: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\ndemo: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
