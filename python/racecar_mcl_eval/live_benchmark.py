"""Plays a recorded drive to a running localizer in real time and measures its latency.

`play` and `listen` run in separate processes, so that neither delays the other. Both use CLOCK_MONOTONIC,
which is common to all processes. Times are in s, stamps in integer microseconds.
"""
import bisect
import math
import struct
import threading
import time
import warnings

import numpy
import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rospy.msg import AnyMsg
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from .live_recording import localizer_values
from .run import TRUTH_TOPIC

SCAN_TOPIC = "/scan"
ODOMETRY_TOPIC = "/vesc/odom"
# Byte offsets: a serialised header begins with seq, secs and nsecs; a TFMessage with its number of transforms.
STAMP_OFFSET = 4
TF_STAMP_OFFSET = 8
# Stamps of played messages are multiples of this. The localizer adds 1 us where it would publish two poses of
# one stamp, so that a transform's stamp shows whether odometry or a scan caused it.
STAMP_GRAIN = 100  # us


def stamp_of(content, offset):
    seconds, nanoseconds = struct.unpack_from("<II", content, offset)
    return 1000000 * seconds + round(1e-3 * nanoseconds)


def quantiles(seconds):
    """Median and 99th percentile in ms; NaN of an empty list."""
    if len(seconds) == 0:
        return math.nan, math.nan
    return tuple(1e3 * numpy.percentile(seconds, [50, 99]))


def raw(message_class):
    """A message class that holds serialised bytes, so that publishing does not serialise."""

    class Raw(message_class):
        def __init__(self, content):
            super().__init__()
            self.content = content

        def serialize(self, buff):
            buff.write(self.content)

    return Raw


class Drive:
    """Scans and odometry of a bag in order of arrival, the first true pose as "x y yaw", and the mounting of
    the lidar."""

    def __init__(self, path):
        self.messages = []  # (s after the beginning, us from stamp to arrival, topic, bytes)
        with rosbag.Bag(str(path)) as bag:
            begin = bag.get_start_time()
            for topic, message, arrival in bag.read_messages(topics=[SCAN_TOPIC, ODOMETRY_TOPIC],
                                                             raw=True):
                content = bytearray(message[1])
                age = round(1e6 * arrival.to_sec()) - stamp_of(content, STAMP_OFFSET)
                self.messages.append((arrival.to_sec() - begin, age, topic, content))
            _, truth, _ = next(bag.read_messages(topics=[TRUTH_TOPIC]))
            _, self.mount, _ = next(bag.read_messages(topics=["/tf_static"]))
        pose = truth.pose.pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        self.start = f"{pose.position.x:.6f} {pose.position.y:.6f} {yaw:.6f}"


class SentMessages:
    """Stamps and send times of scans and odometry, by topic."""

    def __init__(self):
        self.stamps = {SCAN_TOPIC: [], ODOMETRY_TOPIC: []}
        self.times = {SCAN_TOPIC: [], ODOMETRY_TOPIC: []}

    def scans_between(self, begin, end):
        times = self.times[SCAN_TOPIC]
        return bisect.bisect_left(times, end) - bisect.bisect_left(times, begin)


def play(drive, answer, listeners):
    """Plays the drive in real time with current stamps, as soon as the localizer and `listeners` subscribers of
    the odometry are connected. Sends the start time to the pipe `answer`, and at the end the SentMessages."""
    rospy.init_node("player", disable_signals=True)
    mount = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    mount.publish(drive.mount)
    classes = {SCAN_TOPIC: raw(LaserScan), ODOMETRY_TOPIC: raw(Odometry)}
    with warnings.catch_warnings():
        # Without a queue, publish() writes to the sockets itself, as intended; rospy warns about it.
        warnings.simplefilter("ignore", SyntaxWarning)
        publishers = {topic: rospy.Publisher(topic, message_class, tcp_nodelay=True, queue_size=None)
                      for topic, message_class in classes.items()}
    wanted = {SCAN_TOPIC: 1, ODOMETRY_TOPIC: 1 + listeners}
    while any(publishers[topic].get_num_connections() < wanted[topic] for topic in wanted):
        time.sleep(0.05)
    time.sleep(1.0)  # for the map, and for the subscribers of the localizer
    sent = SentMessages()
    begin = time.monotonic()
    answer.send(begin)
    for after_begin, age, topic, content in drive.messages:
        time.sleep(max(0.0, begin + after_begin - time.monotonic()))
        stamp = (round(1e6 * time.time()) - age) // STAMP_GRAIN * STAMP_GRAIN
        struct.pack_into("<II", content, STAMP_OFFSET, stamp // 1000000, stamp % 1000000 * 1000)
        sent.stamps[topic].append(stamp)
        sent.times[topic].append(time.monotonic())
        publishers[topic].publish(classes[topic](content))
    answer.send(sent)


class ReceivedMessages:
    """(arrival time, stamp) of transforms and odometry, and the localizer's last diagnostics."""

    def __init__(self):
        self.transforms = []
        self.odometry = []
        self.diagnostics = {}

    def answers_to_scans(self, sent, tolerance, begin, end):
        """Latencies (s) from the publication of a scan to the arrival of its transform in [begin, end).

        A transform caused by odometry has its stamp plus `tolerance` (us); all others are caused by the latest
        scan, as the localizer skips older ones.
        """
        odometry = set(sent.stamps[ODOMETRY_TOPIC])
        scan_times = sent.times[SCAN_TOPIC]
        delays = []
        for arrival, stamp in self.transforms:
            if not begin <= arrival < end or stamp - tolerance in odometry:
                continue
            scan = bisect.bisect_right(scan_times, arrival) - 1
            if scan >= 0:
                delays.append(arrival - scan_times[scan])
        return delays

    def odometry_delays(self, sent, begin, end):
        """Transport times (s) of odometry messages from player to listener in [begin, end)."""
        times = dict(zip(sent.stamps[ODOMETRY_TOPIC], sent.times[ODOMETRY_TOPIC]))
        return [arrival - times[stamp] for arrival, stamp in self.odometry
                if begin <= arrival < end and stamp in times]


def listen(answer):
    """Receives until the pipe `answer` has a message, then answers with the ReceivedMessages."""
    rospy.init_node("listener", disable_signals=True)
    received = ReceivedMessages()
    lock = threading.Lock()

    # Stamps are decoded at the end, so that the callbacks stay short.
    def on_transforms(message):
        arrival = time.monotonic()
        with lock:
            received.transforms.append((arrival, message._buff))

    def on_odometry(message):
        arrival = time.monotonic()
        with lock:
            received.odometry.append((arrival, message._buff))

    def on_diagnostics(message):
        with lock:
            received.diagnostics = localizer_values(message) or received.diagnostics

    subscribers = [rospy.Subscriber("/tf", AnyMsg, on_transforms, tcp_nodelay=True),
                   rospy.Subscriber(ODOMETRY_TOPIC, AnyMsg, on_odometry, tcp_nodelay=True),
                   rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)]
    answer.recv()
    for subscriber in subscribers:
        subscriber.unregister()
    with lock:
        received.transforms = [(t, stamp_of(b, TF_STAMP_OFFSET)) for t, b in received.transforms]
        received.odometry = [(t, stamp_of(b, STAMP_OFFSET)) for t, b in received.odometry]
        answer.send(received)
