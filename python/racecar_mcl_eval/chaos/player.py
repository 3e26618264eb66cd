"""Processes that mistreat the localizer from outside: the player of a timeline, and programs that occupy a core."""
import contextlib
import multiprocessing
import os
import signal
import struct
import threading
import time
import warnings
from collections import namedtuple

import rospy
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from ..live_benchmark import ODOMETRY_TOPIC, SCAN_TOPIC, STAMP_GRAIN, STAMP_OFFSET, raw

CLOCK_RATE = 100.0  # Hz
# Not forked: a copy of a process that uses rospy has its node, without its threads.
CONTEXT = multiprocessing.get_context("spawn")

# `begin`: CLOCK_MONOTONIC, s; `shift`: the stamp of a message minus its stamp in the bag, us.
Beginning = namedtuple("Beginning", "begin shift")


def run_child(target, *arguments):
    # Ctrl-C in a terminal reaches all processes; the parent ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    target(*arguments)


@contextlib.contextmanager
def child(target, *arguments):
    """Runs `target(*arguments, pipe)` in a process; yields the other end of the pipe."""
    mine, theirs = CONTEXT.Pipe()
    process = CONTEXT.Process(target=run_child, args=(target, *arguments, theirs), daemon=True)
    process.start()
    theirs.close()
    try:
        yield mine
    finally:
        process.terminate()
        process.join()


def occupy_core(core, _):
    os.sched_setaffinity(0, {core})
    while True:
        pass


class PlayedClock:
    """The wall clock plus an offset that can be changed; on /clock if `published`."""

    def __init__(self, published):
        self.offset = 0.0  # s
        if published:
            self.publisher = rospy.Publisher("/clock", Clock, queue_size=1, tcp_nodelay=True)
            threading.Thread(target=self.publish, daemon=True).start()

    def publish(self):
        while True:
            self.publisher.publish(rospy.Time.from_sec(time.time() + self.offset))
            time.sleep(1.0 / CLOCK_RATE)


def publishers_of_sensors():
    classes = {SCAN_TOPIC: raw(LaserScan), ODOMETRY_TOPIC: raw(Odometry)}
    with warnings.catch_warnings():
        # Without a queue, publish() writes to the sockets itself, as intended; rospy warns about it.
        warnings.simplefilter("ignore", SyntaxWarning)
        publishers = {topic: rospy.Publisher(topic, message_class, tcp_nodelay=True, queue_size=None)
                      for topic, message_class in classes.items()}
    return classes, publishers


def sent_stamp(message, shift):
    """The stamp (us) with which a Message is sent."""
    return (message.stamp + shift + round(1e6 * message.clock)) // STAMP_GRAIN * STAMP_GRAIN


def play(messages, first_stamp, mount, with_clock, environment, answer):
    """Sends the Messages in real time, once the localizer is connected, with the stamps of the current time.

    `first_stamp`: the bag's time at the beginning of the drive, us. Sends the Beginning to the pipe `answer`.
    """
    os.environ.update(environment)
    rospy.init_node("player", disable_signals=True)
    clock = PlayedClock(with_clock)
    mounting = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    mounting.publish(mount)
    classes, publishers = publishers_of_sensors()
    while any(publisher.get_num_connections() < 1 for publisher in publishers.values()):
        time.sleep(0.05)
    time.sleep(1.0)  # for the map, and for the subscribers of the localizer
    beginning = Beginning(time.monotonic(), round(1e6 * time.time()) - first_stamp)
    answer.send(beginning)
    for message in messages:
        time.sleep(max(0.0, beginning.begin + message.at - time.monotonic()))
        clock.offset = message.clock
        stamp = sent_stamp(message, beginning.shift)
        content = bytearray(message.content)
        struct.pack_into("<II", content, STAMP_OFFSET, stamp // 1000000, stamp % 1000000 * 1000)
        publishers[message.topic].publish(classes[message.topic](content))
    threading.Event().wait()
