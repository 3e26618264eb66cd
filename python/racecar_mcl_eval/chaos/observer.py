"""Subscribes to the outputs of the localizer and samples its process."""
import threading
import time

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rospy.msg import AnyMsg

from ..live_benchmark import SCAN_TOPIC, STAMP_OFFSET, TF_STAMP_OFFSET, stamp_of
from ..live_recording import localizer_values
from . import process

SAMPLE_PERIOD = 0.2  # s
POSE_TOPIC = "/pf/pose/odom"


class Observer:
    """Context manager. `poses` and `transforms`: (arrival, serialised message); `scans`: (arrival, stamp in us);
    `statuses`: (arrival, text); `diagnostics`: (arrival, values). Arrivals are CLOCK_MONOTONIC in s."""

    def __init__(self, find_process):
        """`find_process()`: the process id of the localizer, or None."""
        self.find_process = find_process
        self.poses, self.transforms, self.scans = [], [], []
        self.statuses, self.diagnostics, self.samples = [], [], []
        self.last_sample = 0.0
        self.lock = threading.Lock()

    def __enter__(self):
        # Messages are decoded at the end, so that the callbacks stay short.
        self.subscribers = [
            rospy.Subscriber(POSE_TOPIC, AnyMsg, lambda m: self.add(self.poses, m._buff), tcp_nodelay=True),
            rospy.Subscriber("/tf", AnyMsg, lambda m: self.add(self.transforms, m._buff), tcp_nodelay=True),
            rospy.Subscriber(SCAN_TOPIC, AnyMsg, lambda m: self.add(self.scans, stamp_of(m._buff, STAMP_OFFSET)),
                             tcp_nodelay=True),
            rospy.Subscriber("/pf/status", DiagnosticStatus, lambda m: self.add(self.statuses, m.message)),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self.on_diagnostics)]
        return self

    def __exit__(self, *_):
        for subscriber in self.subscribers:
            subscriber.unregister()

    def add(self, messages, content):
        arrival = time.monotonic()
        with self.lock:
            messages.append((arrival, content))

    def on_diagnostics(self, message):
        values = localizer_values(message)
        if values:
            self.add(self.diagnostics, values)

    def sample(self):
        """Adds a Sample of the localizer's process, if one is due."""
        now = time.monotonic()
        if now - self.last_sample < SAMPLE_PERIOD:
            return
        self.last_sample = now
        found = process.sample(self.find_process(), now)
        if found is not None:
            self.samples.append(found)

    def status_since(self, arrival):
        """The last status that arrived after `arrival`; None without one."""
        with self.lock:
            return self.statuses[-1][1] if self.statuses and self.statuses[-1][0] > arrival else None

    def stamped_transforms(self):
        """(arrival, stamp in us) of the transforms."""
        with self.lock:
            return [(arrival, stamp_of(content, TF_STAMP_OFFSET)) for arrival, content in self.transforms]
