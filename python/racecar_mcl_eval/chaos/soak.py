"""A long drive of the simulated car at several times real time."""
import array
import threading
import time

import numpy as np
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float32

from .. import EvaluationError
from . import process
from .observation import longest_unlocalized
from .report import Case, Limit
from .session import MANAGER, START_UP

SETTLING = 30.0  # simulated s, before anything counts
ERROR_TOPIC = "/error_monitor/position_error"


class SoakObserver:
    """Errors (m), changes of the status (time, text), and Samples of the process. Times are in s of simulated time
    after the beginning."""

    def __init__(self):
        self.began, self.clock, self.status = None, 0.0, None
        self.errors = array.array("f")
        self.statuses, self.samples = [], []
        self.lock = threading.Lock()
        self.subscribers = [rospy.Subscriber("/clock", Clock, self.on_clock, tcp_nodelay=True),
                            rospy.Subscriber(ERROR_TOPIC, Float32, self.on_error),
                            rospy.Subscriber("/pf/status", DiagnosticStatus, self.on_status)]

    def on_clock(self, message):
        now = message.clock.to_sec()
        self.began = now if self.began is None else self.began
        self.clock = now - self.began

    def on_error(self, message):
        with self.lock:
            if self.clock >= SETTLING:
                self.errors.append(message.data)

    def on_status(self, message):
        with self.lock:
            if self.clock >= SETTLING and message.message != self.status:
                self.status = message.message
                self.statuses.append((self.clock, message.message))

    def sample(self, pid):
        if self.clock < SETTLING:
            return
        found = process.sample(pid, self.clock)
        if found is None:
            raise EvaluationError(f"the localizer has ended after {self.clock:.0f} s of simulated time")
        self.samples.append(found)


def slope_per_hour(samples):
    """The growth (MB per simulated hour) of the line through the resident memory."""
    if len(samples) < 2:
        return np.nan
    times, resident = np.array([(sample.time, sample.resident) for sample in samples]).T
    return 3600.0 * np.polyfit(times, resident, 1)[0]


def values_of(errors, changes, samples, end, factor):
    """The values of the soak's limits, and those that are only reported."""
    if not len(errors) or len(samples) < 2:
        raise EvaluationError("the simulated car was not localized")
    first, last = samples[0], samples[-1]
    values = {"not localized for": longest_unlocalized(changes, end),
              "growth": 100.0 * (last.resident / first.resident - 1.0),
              "change of descriptors": abs(last.descriptors - first.descriptors)}
    details = [("simulated time", f"{end:.0f} s at {factor:.1f} times real time"),
               ("position error", f"mean {100 * np.mean(errors):.1f} cm, p99 {100 * np.percentile(errors, 99):.1f} cm, "
                f"max {100 * np.max(errors):.1f} cm"),
               ("changes of the status", str(max(0, len(changes) - 1))),
               ("resident memory", f"{first.resident:.1f} MB at {first.time:.0f} s, {last.resident:.1f} MB at the end, "
                f"slope {slope_per_hour(samples):+.2f} MB/h"),
               ("descriptors", f"{first.descriptors} and {last.descriptors}")]
    return values, details


def drive(lab, seconds, factor):
    """Localizes the simulated car for `seconds` of simulated time. Returns the values and the details."""
    words = ["roslaunch", "racecar_mcl", "simulate.launch", "localize:=true", f"real_time_factor:={factor}"]
    with lab.running("soak", words) as launch:
        observer = SoakObserver()
        begin, first = time.monotonic(), None
        while observer.clock < seconds:
            if launch.poll() is not None or (first is None and time.monotonic() - begin > START_UP):
                raise EvaluationError(f"the simulation has ended or did not start; log: {lab.folder / 'soak.log'}")
            time.sleep(0.5)
            observer.sample(process.find_descendant(launch.pid, MANAGER))
            if first is None and observer.clock > 0.0:
                first = time.monotonic(), observer.clock
        achieved = (observer.clock - first[1]) / (time.monotonic() - first[0])
        with observer.lock:
            return values_of(observer.errors, observer.statuses, observer.samples, observer.clock, achieved)


def soak_case(hours, factor):
    """The Case of a drive of `hours` of simulated time, and the list that its details are added to."""
    details = []

    def measure(lab):
        values, found = drive(lab, 3600.0 * hours, factor)
        details.extend(found)
        return values

    return Case("soak", f"a simulated drive of {hours:g} h",
                [Limit("not localized for", 1.0, "s", ".1f"), Limit("growth", 5.0, "%", ".1f"),
                 Limit("change of descriptors", 0, "", "d")], measure), details
