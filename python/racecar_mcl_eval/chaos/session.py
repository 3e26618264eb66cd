"""The localizer, a player and an observer in one ROS graph."""
import contextlib
import os
import time

import rospy

from .. import EvaluationError, benchmarks, live_benchmark, programs, ros_graph
from ..columns import LOCALIZED
from ..run import recorded_truth
from ..trajectory import Trajectory, poses_at
from . import process
from .observation import MAX_GAP, Observation, decode_pose, nearest_time, waiting_times
from .observer import Observer
from .player import child, play, sent_stamp
from .timeline import timeline_of

START_UP = 30.0  # s, limit for the connections and for the start of the localizer
MANAGER = "localization_manager"
SETTLING = 6.0  # s after the beginning of the drive, before the mistreatment
TOLERANCE = 30000  # us, the localizer's transform_tolerance


class RecordedDrive:
    """A drive in a bag: `messages`, the start pose "x y yaw", the mounting of the lidar, the truth (its stamps: ns
    after the beginning) and the bag's time at the beginning (us)."""

    def __init__(self, bag):
        self.bag = bag
        drive = live_benchmark.Drive(bag)
        self.messages, self.start, self.mount = timeline_of(drive), drive.start, drive.mount
        at, age, _, content = drive.messages[0]
        self.first_stamp = live_benchmark.stamp_of(content, live_benchmark.STAMP_OFFSET) + age - round(1e6 * at)
        truth = recorded_truth(bag)
        self.truth = Trajectory(truth.stamps - 1000 * self.first_stamp, truth.poses)

    def true_pose(self, at):
        """(x, y, yaw) at a time of the drive."""
        poses, valid = poses_at(self.truth, [round(1e9 * at)], MAX_GAP)
        if not valid[0]:
            raise EvaluationError(f"{self.bag}: the drive has no pose at {at:.1f} s")
        return poses[0]


class Session:
    """Context manager: localizes a RecordedDrive with localize.launch while `messages` are played.

    `arguments`: of localize.launch; `with_clock`: the player publishes the time on /clock; `name`: of the log.
    """

    def __init__(self, lab, name, drive, messages=None, with_clock=False, **arguments):
        self.lab, self.drive, self.with_clock = lab, drive, with_clock
        self.messages = drive.messages if messages is None else messages
        self.log = lab.folder / f"{name}.log"
        self.arguments = {"map": benchmarks.MAP, "initial_pose": drive.start, **arguments}
        self.stack = contextlib.ExitStack()

    def __enter__(self):
        with contextlib.ExitStack() as stack:
            rospy.set_param("/use_sim_time", self.with_clock)
            words = ["roslaunch", "racecar_mcl", "localize.launch"]
            words += [f"{name}:={value}" for name, value in self.arguments.items()]
            log = stack.enter_context(open(self.log, "wb"))
            self.launch = stack.enter_context(ros_graph.running(words, self.lab.environment, log))
            self.observer = stack.enter_context(Observer(self.localizer_pid))
            self.player = stack.enter_context(
                child(play, self.messages, self.drive.first_stamp, self.drive.mount, self.with_clock,
                      self.lab.environment))
            if not self.player.poll(START_UP):
                raise EvaluationError(f"the localizer did not come up within {START_UP:.0f} s; log: {self.log}")
            self.begin, self.shift = self.player.recv()
            self.stack = stack.pop_all()
        return self

    def __exit__(self, *_):
        self.stack.close()

    def localizer_pid(self):
        return process.find_descendant(self.launch.pid, MANAGER)

    def now(self):
        """Seconds after the beginning of the drive."""
        return time.monotonic() - self.begin

    def continue_until(self, at, act=lambda: None, period=0.05):
        """Observes until the time `at`; calls act() every `period` seconds."""
        due = self.now()
        while self.now() < at:
            act()
            self.observer.sample()
            due = max(due + period, self.now())
            time.sleep(max(0.0, min(due, at) - self.now()))

    def wait_for_localized(self, seconds):
        """The seconds until the status, of a message that arrives from now on, is localized; infinite after
        `seconds`."""
        begin = time.monotonic()
        while time.monotonic() - begin < seconds:
            if self.observer.status_since(begin) == LOCALIZED:
                return time.monotonic() - begin
            self.observer.sample()
            time.sleep(0.02)
        return float("inf")

    def log_lines(self):
        """Number of lines that the nodes have logged."""
        return self.log.read_bytes().count(b"\n")

    def waits_for_transforms(self, begin):
        """Seconds from the time at which each scan since `begin` was due to the next transform of a scan."""
        odometry = {sent_stamp(message, self.shift) for message in self.messages
                    if message.topic == live_benchmark.ODOMETRY_TOPIC}
        # A transform caused by odometry has its stamp plus the tolerance.
        answers = [arrival - self.begin for arrival, stamp in self.observer.stamped_transforms()
                   if stamp - TOLERANCE not in odometry]
        scans = [message.at for message in self.messages
                 if message.topic == live_benchmark.SCAN_TOPIC and message.at >= begin]
        return waiting_times(scans, answers)

    def observation(self):
        """The Observation up to now."""
        until = self.now()
        with self.observer.lock:
            poses, scans = list(self.observer.poses), list(self.observer.scans)
            statuses, diagnostics = list(self.observer.statuses), list(self.observer.diagnostics)
        decoded = [decode_pose(content) for _, content in poses]
        arrivals = self.since_begin([arrival for arrival, _ in poses])
        scan_arrivals = self.since_begin([arrival for arrival, _ in scans])
        return Observation(
            arrivals, self.times_of([pose[0] for pose in decoded], arrivals), [pose[1:] for pose in decoded],
            self.drive.truth, until, [(arrival - self.begin, text) for arrival, text in statuses],
            [sample._replace(time=sample.time - self.begin) for sample in self.observer.samples],
            [(arrival - self.begin, values) for arrival, values in diagnostics],
            list(zip(scan_arrivals, self.times_of([stamp for _, stamp in scans], scan_arrivals))))

    def since_begin(self, arrivals):
        return [arrival - self.begin for arrival in arrivals]

    def times_of(self, stamps, arrivals):
        """The times of stamps (us) that arrived at `arrivals`, both after the beginning of the drive."""
        offsets = sorted({message.clock for message in self.messages})
        origins = [self.drive.first_stamp + self.shift + round(1e6 * offset) for offset in offsets]
        return [nearest_time(stamp, arrival, origins) for stamp, arrival in zip(stamps, arrivals)]


class Lab:
    """Context manager: a roscore, a folder for logs and bags, and the drives that the cases share."""

    def __init__(self, folder, seconds, reloads):
        """`seconds`: of mistreatment in a case; `reloads`: of the nodelet."""
        self.folder, self.seconds, self.reloads = folder, seconds, reloads
        self.drive_seconds = 30.0 + seconds
        self.drives = {}
        self.stack = contextlib.ExitStack()

    def __enter__(self):
        with contextlib.ExitStack() as stack:
            port = ros_graph.free_port()
            self.environment = dict(ros_graph.environment(port, self.folder), ROSCONSOLE_STDOUT_LINE_BUFFERED="1")
            log = stack.enter_context(open(self.folder / "roscore.log", "wb"))
            stack.enter_context(ros_graph.running(["roscore", "-p", port], self.environment, log))
            ros_graph.wait_for_master(port)
            os.environ.update(self.environment)
            rospy.init_node("chaos", disable_signals=True)
            self.stack = stack.pop_all()
        return self

    def __exit__(self, *_):
        rospy.signal_shutdown("end")
        self.stack.close()

    def drive(self, seconds=None):
        """A simulated RecordedDrive at 3 m/s in the corridor, by default as long as a case needs it."""
        seconds = self.drive_seconds if seconds is None else seconds
        if seconds not in self.drives:
            bag = self.folder / f"drive_{seconds:g}.bag"
            benchmarks.record_drive(bag, seconds)
            self.drives[seconds] = RecordedDrive(bag)
        return self.drives[seconds]

    @contextlib.contextmanager
    def running(self, name, words):
        """Runs a program of the graph that logs to a file of its own."""
        with open(self.folder / f"{name}.log", "ab") as log:
            with ros_graph.running(words, self.environment, log) as started:
                yield started

    def fast_drive(self, seconds, scan_rate, odometry_rate):
        """A RecordedDrive of the simulator with these rates (Hz), recorded in real time."""
        bag = self.folder / "fast_drive.bag"
        rospy.set_param("/use_sim_time", False)
        simulator = [*programs.find("simulator_node"), "scan:=/scan", "odom:=/vesc/odom", f"_map:={benchmarks.MAP}",
                     f"_scan_rate:={scan_rate}", f"_odom_rate:={odometry_rate}"]
        topics = ["/scan", "/vesc/odom", "/ground_truth/odom", "/tf_static"]
        with self.running("simulator", simulator):
            with self.running("record", ["rosbag", "record", "--buffsize", 0, "-O", bag, *topics]):
                time.sleep(seconds)
        return RecordedDrive(bag)
