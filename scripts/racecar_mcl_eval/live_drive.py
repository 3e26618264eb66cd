"""Plays a recorded drive to a running ROS graph as the car's drivers would, and times the answers.

`play` and `listen` run in processes of their own, so that neither delays the other. Both read
CLOCK_MONOTONIC, which all processes share. Times are in s, stamps in whole microseconds.
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

SCAN_TOPIC = "/scan"
ODOMETRY_TOPIC = "/vesc/odom"
TRUTH_TOPIC = "/ground_truth/odom"
# A serialised header begins with seq, secs and nsecs; a TFMessage with how many transforms it holds.
STAMP_OFFSET = 4
TF_STAMP_OFFSET = 8
# Stamps of what is played are multiples of this. The localizer steps on by 1 us where it would
# publish two poses of one stamp, so that a transform tells whether odometry or a scan brought it.
STAMP_GRAIN = 100  # us


def stamp_of(content, offset):
    seconds, nanoseconds = struct.unpack_from("<II", content, offset)
    return 1000000 * seconds + round(1e-3 * nanoseconds)


def quantiles(seconds):
    """The median and the 99th percentile in ms; NaN where there is nothing."""
    if len(seconds) == 0:
        return math.nan, math.nan
    return tuple(1e3 * numpy.percentile(seconds, [50, 99]))


def raw(message_class):
    """The class with its bytes ready, so that publishing a message serialises nothing."""

    class Raw(message_class):
        def __init__(self, content):
            super().__init__()
            self.content = content

        def serialize(self, buff):
            buff.write(self.content)

    return Raw


class Drive:
    """A bag's scans and odometry in the order they arrived, the truth at its beginning as "x y yaw",
    and the lidar's mount."""

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


class Sent:
    """When which stamp was sent, of scans and of odometry."""

    def __init__(self):
        self.stamps = {SCAN_TOPIC: [], ODOMETRY_TOPIC: []}
        self.times = {SCAN_TOPIC: [], ODOMETRY_TOPIC: []}

    def scans_between(self, begin, end):
        times = self.times[SCAN_TOPIC]
        return bisect.bisect_left(times, end) - bisect.bisect_left(times, begin)


def play(drive, answer, listeners):
    """Plays the drive in real time, stamped by the clock, once the localizer and all `listeners` of
    the odometry are there. To `answer` goes the time of its beginning, and at the end a `Sent`."""
    rospy.init_node("player", disable_signals=True)
    mount = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    mount.publish(drive.mount)
    classes = {SCAN_TOPIC: raw(LaserScan), ODOMETRY_TOPIC: raw(Odometry)}
    with warnings.catch_warnings():
        # Without a queue `publish` itself writes to the sockets, as it should here; rospy warns of it.
        warnings.simplefilter("ignore", SyntaxWarning)
        publishers = {topic: rospy.Publisher(topic, message_class, tcp_nodelay=True, queue_size=None)
                      for topic, message_class in classes.items()}
    wanted = {SCAN_TOPIC: 1, ODOMETRY_TOPIC: 1 + listeners}
    while any(publishers[topic].get_num_connections() < wanted[topic] for topic in wanted):
        time.sleep(0.05)
    time.sleep(1.0)  # for the map, and the listeners of what the localizer publishes
    sent = Sent()
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


class Heard:
    """When which stamp was heard on tf and of odometry, and the localizer's last diagnostics."""

    def __init__(self):
        self.transforms = []
        self.odometry = []
        self.diagnostics = {}

    def answers_to_scans(self, sent, tolerance, begin, end):
        """s from each scan's publication to the transform that it brought, for those in a period.

        Transforms of odometry carry its stamp, `tolerance` (us) ahead; the others are of scans. The
        newest scan is the one that is answered, for the localizer leaves those before it out.
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
        """s that a message itself is on its way from the player to the listener, in a period."""
        times = dict(zip(sent.stamps[ODOMETRY_TOPIC], sent.times[ODOMETRY_TOPIC]))
        return [arrival - times[stamp] for arrival, stamp in self.odometry
                if begin <= arrival < end and stamp in times]


def listen(answer):
    """Listens until something comes from `answer`, then answers with a `Heard`."""
    rospy.init_node("listener", disable_signals=True)
    heard = Heard()
    lock = threading.Lock()

    # The bytes are looked at later: nothing keeps the next message waiting.
    def on_transforms(message):
        arrival = time.monotonic()
        with lock:
            heard.transforms.append((arrival, message._buff))

    def on_odometry(message):
        arrival = time.monotonic()
        with lock:
            heard.odometry.append((arrival, message._buff))

    def on_diagnostics(message):
        for status in message.status:
            if status.name.endswith("localization"):
                with lock:
                    heard.diagnostics = {pair.key: pair.value for pair in status.values}

    subscribers = [rospy.Subscriber("/tf", AnyMsg, on_transforms, tcp_nodelay=True),
                   rospy.Subscriber(ODOMETRY_TOPIC, AnyMsg, on_odometry, tcp_nodelay=True),
                   rospy.Subscriber("/diagnostics", DiagnosticArray, on_diagnostics)]
    answer.recv()
    for subscriber in subscribers:
        subscriber.unregister()
    with lock:
        heard.transforms = [(t, stamp_of(b, TF_STAMP_OFFSET)) for t, b in heard.transforms]
        heard.odometry = [(t, stamp_of(b, STAMP_OFFSET)) for t, b in heard.odometry]
        answer.send(heard)
