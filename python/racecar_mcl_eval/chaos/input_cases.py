"""Cases: inputs that are too many, late, of another time, or unusable."""
import contextlib
import math
import subprocess

import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped

from .. import EvaluationError, benchmarks
from .observation import Observation, decode_pose
from .observer import Observer
from .process import find_descendant
from .report import Case, Limit
from .session import MANAGER, SETTLING, Session
from .timeline import clock_stepped, doubled_odometry, paused, with_unusable_scans

PAUSE = 3.0  # s
BACK, FORWARD = -10.0, 100.0  # s, steps of the clock
START_RATE = 100.0  # Hz
START_SIGMA = 0.05  # m, rad
OUTSIDE = 1000.0  # m, a coordinate outside the map
FAST_SCANS, FAST_ODOMETRY = 200, 1000  # Hz of the simulator; the odometry is doubled
UNUSABLE_KEYS = ("scans unreadable", "scans without tf", "scans dropped", "scans superseded")
MAX_LATENESS = 0.5  # s, of the player
BAG_SECONDS = 15.0
BAG_SETTLING = 5.0  # s, bag time


def flood(lab):
    drive = lab.fast_drive(SETTLING + lab.seconds + 4.0, FAST_SCANS, FAST_ODOMETRY)
    begin = SETTLING
    with Session(lab, "flood", drive, doubled_odometry(drive.messages)) as session:
        session.continue_until(begin + lab.seconds)
        seen = session.observation()
    late = seen.until - seen.scan_times[-1]
    if late > MAX_LATENESS:
        raise EvaluationError(f"the player is {late:.1f} s late: the machine is too slow for these rates")
    return {"behind the newest scan": seen.max_lag(begin), "max error": seen.max_error(begin),
            "growth": seen.growth(begin)}


def pause_inputs(lab):
    drive = lab.drive()
    end = SETTLING + PAUSE
    with Session(lab, "paused", drive, paused(drive.messages, SETTLING, end)) as session:
        session.continue_until(end + lab.seconds)
        seen = session.observation()
    return {"localized after": seen.recovery(end), "max error from then on": seen.max_error(end + 2.0)}


def start_message(session, valid):
    """A start pose at the truth, or outside the map."""
    message = PoseWithCovarianceStamped()
    message.header.frame_id = "map"
    message.header.stamp = rospy.Time.from_sec(rospy.get_time())
    x, y, yaw = session.drive.true_pose(session.now())
    pose = message.pose.pose
    pose.position.x, pose.position.y = (x, y) if valid else (OUTSIDE, OUTSIDE)
    pose.orientation.z, pose.orientation.w = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    for index in (0, 7, 35):
        message.pose.covariance[index] = START_SIGMA**2
    return message


def step_clock(lab, offset):
    """Without the parameter initial_pose, from which a looping bag starts again."""
    drive = lab.drive()
    messages = clock_stepped(drive.messages, [(SETTLING, offset)])
    publisher = rospy.Publisher("/initialpose", PoseWithCovarianceStamped, queue_size=1)
    with Session(lab, f"clock_{offset:+g}", drive, messages, with_clock=True, initial_pose="") as session:
        session.continue_until(1.0)
        publisher.publish(start_message(session, True))
        session.continue_until(SETTLING + lab.seconds)
        seen = session.observation()
    publisher.unregister()
    return {"max error": seen.max_error(SETTLING), "localized after": seen.recovery(SETTLING)}


def step_clock_back(lab):
    return step_clock(lab, BACK)


def step_clock_forward(lab):
    return step_clock(lab, FORWARD)


def repeat_start_poses(lab):
    drive = lab.drive()
    publisher = rospy.Publisher("/initialpose", PoseWithCovarianceStamped, queue_size=10)
    end = SETTLING + lab.seconds
    sent = []  # whether each start pose was valid

    def send(session):
        sent.append(len(sent) % 2 == 0)
        publisher.publish(start_message(session, sent[-1]))

    with Session(lab, "start_poses", drive) as session:
        session.continue_until(SETTLING)
        before = session.log_lines()
        session.continue_until(end, lambda: send(session), 1.0 / START_RATE)
        lines = session.log_lines() - before
        session.continue_until(end + 4.0)
        seen = session.observation()
    publisher.unregister()
    refused = seen.counted(["start poses rejected"], SETTLING) / sent.count(False)
    return {"log": lines / lab.seconds, "max error": seen.max_error(SETTLING), "localized after": seen.recovery(end),
            "refused ones not counted": 100.0 * (1.0 - refused)}


def send_unusable_scans(lab):
    drive = lab.drive()
    end = SETTLING + lab.seconds
    messages, added = with_unusable_scans(drive.messages, SETTLING, end)
    with Session(lab, "unusable_scans", drive, messages) as session:
        session.continue_until(end + 2.0)
        seen = session.observation()
    return {"max error": seen.max_error(SETTLING), "not localized for": seen.longest_unlocalized(SETTLING),
            "not counted": 100.0 * (1.0 - seen.counted(UNUSABLE_KEYS, SETTLING) / added)}


def play_bag(lab, name, seconds, **arguments):
    """Localizes a looping bag with replay_bag.launch; returns the position errors (m) by loop, from BAG_SETTLING
    after its start on."""
    drive = lab.drive(BAG_SECONDS)
    words = ["roslaunch", "racecar_mcl", "replay_bag.launch", f"bag:={drive.bag}", f"map:={benchmarks.MAP}",
             f"initial_pose:={drive.start}", "loop:=true"]
    words += [f"{key}:={value}" for key, value in arguments.items()]
    with lab.running(name, words) as launch:
        with Observer(lambda: find_descendant(launch.pid, MANAGER)) as observer:
            with contextlib.suppress(subprocess.TimeoutExpired):
                launch.wait(seconds)
            poses = [decode_pose(content) for _, content in observer.poses]
    times = [1e-6 * (pose[0] - drive.first_stamp) for pose in poses]
    seen = Observation(times, times, [pose[1:] for pose in poses], drive.truth, BAG_SECONDS)
    return loops_of(times, seen.errors)


def loops_of(times, errors):
    """The errors at times from BAG_SETTLING on, in one list per loop: a loop ends where the time goes back by more
    than half of the bag."""
    loops = []
    newest = math.inf
    for time, error in zip(times, errors):
        if time < newest - 0.5 * BAG_SECONDS:
            loops.append([])
            newest = time
        newest = max(newest, time)
        if time >= BAG_SETTLING and math.isfinite(error):
            loops[-1].append(error)
    return [loop for loop in loops if loop]


def bag_values(loops, expected):
    return {"loops without a pose": max(0, expected - len(loops)),
            "max error": max((max(loop) for loop in loops), default=math.nan)}


def loop_bag(lab):
    return bag_values(play_bag(lab, "bag_looped", 3.0 * BAG_SECONDS + 5.0), 3)


def play_bag_fast(lab):
    return bag_values(play_bag(lab, "bag_fast", 15.0, rate=10), 5)


BAG_LIMITS = [Limit("max error", 0.5, "m"), Limit("loops without a pose", 0, "", "d")]
CLOCK_LIMITS = [Limit("max error", 0.3, "m"), Limit("localized after", 2.0, "s", ".1f")]
CASES = [
    Case("flood", f"{FAST_SCANS} scans and {2 * FAST_ODOMETRY} odometry messages per second",
         [Limit("behind the newest scan", 0.2, "s", ".3f"), Limit("max error", 0.3, "m"),
          Limit("growth", 20.0, "MB", ".1f")], flood),
    Case("paused", f"no input for {PAUSE:g} s, then all of it in a burst",
         [Limit("localized after", 2.0, "s", ".1f"), Limit("max error from then on", 0.3, "m")], pause_inputs),
    Case("bag-looped", f"a bag of {BAG_SECONDS:g} s, three times; from {BAG_SETTLING:g} s after each start on",
         BAG_LIMITS, loop_bag),
    Case("bag-fast", f"the same with -r 10; from {BAG_SETTLING:g} s of bag time after each start on", BAG_LIMITS,
         play_bag_fast),
    Case("clock-back", f"the clock of sensors and nodes steps by {BACK:g} s", CLOCK_LIMITS, step_clock_back),
    Case("clock-forward", f"it steps by {FORWARD:g} s", CLOCK_LIMITS, step_clock_forward),
    Case("start-poses", f"{START_RATE:g} start poses per second, at the truth and outside the map by turns",
         [Limit("log", 10.0, "lines/s", ".1f"), Limit("max error", 0.3, "m"),
          Limit("localized after", 2.0, "s", ".1f"), Limit("refused ones not counted", 5.0, "%", ".1f")],
         repeat_start_poses),
    Case("unusable-scans", "scans without ranges, of NaN only, and of a frame without tf, between usable ones",
         [Limit("max error", 0.3, "m"), Limit("not localized for", 1.0, "s", ".1f"),
          Limit("not counted", 1.0, "%", ".1f")], send_unusable_scans),
]
