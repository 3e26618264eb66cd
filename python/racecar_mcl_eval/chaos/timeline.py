"""Timelines: the messages of a drive in the order in which they are sent, and their mistreatments.

Each function takes a list of Messages and returns a new one. Times are in s after the beginning of the drive, stamps
in integer microseconds of the bag's time.
"""
import io
import math
from collections import namedtuple

from sensor_msgs.msg import LaserScan

from ..live_benchmark import ODOMETRY_TOPIC, SCAN_TOPIC, STAMP_OFFSET, stamp_of

# `at`: when it is sent; `clock`: offset of the clock from which its stamp is read, s.
Message = namedtuple("Message", "at stamp topic content clock")

FOREIGN_FRAME = "foreign_laser"


def timeline_of(drive):
    """The messages of a live_benchmark.Drive, as they were recorded."""
    return [Message(at, stamp_of(content, STAMP_OFFSET), topic, bytes(content), 0.0)
            for at, _, topic, content in drive.messages]


def paused(messages, begin, end):
    """The messages of [begin, end) are sent at `end`, all at once and with their own stamps."""
    return [message._replace(at=end) if begin <= message.at < end else message for message in messages]


def clock_stepped(messages, steps):
    """The clock is off by `offset` s from `at` on, for each (at, offset) of `steps`."""
    def offset_at(time):
        return ([0.0] + [offset for at, offset in steps if at <= time])[-1]
    return [message._replace(clock=offset_at(message.at)) for message in messages]


def doubled_odometry(messages):
    """Each odometry message is sent a second time, half a period later."""
    odometry = [message for message in messages if message.topic == ODOMETRY_TOPIC]
    copies = []
    for message, following in zip(odometry, odometry[1:]):
        copies.append(message._replace(at=0.5 * (message.at + following.at),
                                       stamp=(message.stamp + following.stamp) // 2))
    return sorted(messages + copies, key=lambda message: message.at)


def unusable_scans(content):
    """A serialised scan as three that cannot be used: without ranges, with NaN only, and in a frame without tf."""
    results = []
    for change in (lambda scan: setattr(scan, "ranges", []),
                   lambda scan: setattr(scan, "ranges", [math.nan] * len(scan.ranges)),
                   lambda scan: setattr(scan.header, "frame_id", FOREIGN_FRAME)):
        scan = LaserScan().deserialize(content)
        scan.intensities = []
        change(scan)
        buffer = io.BytesIO()
        scan.serialize(buffer)
        results.append(buffer.getvalue())
    return results


def with_unusable_scans(messages, begin, end):
    """An unusable scan, one kind after the other, between each two scans of [begin, end)."""
    scans = [message for message in messages if message.topic == SCAN_TOPIC]
    added = []
    for index, (scan, following) in enumerate(zip(scans, scans[1:])):
        if begin <= scan.at < end:
            added.append(Message(0.5 * (scan.at + following.at), (scan.stamp + following.stamp) // 2, SCAN_TOPIC,
                                 unusable_scans(scan.content)[index % 3], scan.clock))
    return sorted(messages + added, key=lambda message: message.at), len(added)
