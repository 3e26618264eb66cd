"""What was observed of a localizer during a drive. Times are in s after the beginning of the drive."""
import math
import struct

import numpy as np

from ..columns import LOCALIZED
from ..trajectory import poses_at, yaw_of

MAX_GAP = 0.5  # s; longest gap of the truth that is interpolated
STATUS_TIMEOUT = 1.0  # s; pf/status comes at 10 Hz
SILENT = "silent"  # the status without a message for STATUS_TIMEOUT


def decode_pose(content):
    """(stamp in us, x, y, yaw) of a serialised nav_msgs/Odometry."""
    seconds, nanoseconds, length = struct.unpack_from("<III", content, 4)
    offset = 16 + length
    offset += 4 + struct.unpack_from("<I", content, offset)[0]
    x, y, _, *orientation = struct.unpack_from("<7d", content, offset)
    return 1000000 * seconds + round(1e-3 * nanoseconds), x, y, float(yaw_of(*orientation))


def nearest_time(stamp, arrival, origins):
    """The time of a stamp (us). `origins`: stamps at the time 0, one per state of the clock; that with which the
    stamp is nearest to its arrival applies."""
    return min((1e-6 * (stamp - origin) for origin in origins), key=lambda time: abs(time - arrival))


def waiting_times(requests, answers):
    """Seconds from each request to the first answer after it; requests after the last answer are left out."""
    requests, answers = np.asarray(requests, dtype=float), np.sort(np.asarray(answers, dtype=float))
    first = np.searchsorted(answers, requests, side="right")
    answered = first < len(answers)
    return answers[first[answered]] - requests[answered]


def with_silence(statuses, until):
    """The statuses (time, text), and SILENT wherever none followed within STATUS_TIMEOUT."""
    result = []
    for (time, text), following in zip(statuses, [time for time, _ in statuses[1:]] + [until]):
        result.append((time, text))
        if following - time > STATUS_TIMEOUT:
            result.append((time + STATUS_TIMEOUT, SILENT))
    return result


def longest_unlocalized(statuses, until):
    """The longest time (s) with other statuses than localized; each lasts until the next one, the last `until`."""
    longest, left = 0.0, None
    for time, text in [*statuses, (until, None)]:
        if left is not None:
            longest = max(longest, time - left)
        if text == LOCALIZED:
            left = None
        elif left is None:
            left = time
    return longest


class Observation:
    """arrivals: when each pose arrived; times: of its stamp; errors: its distance from the truth, m, NaN without a
    truth; statuses: (time, text); samples: of the process; diagnostics: (time, values); until: the end;
    scan_arrivals and scan_times: of the scans that the observer received."""

    def __init__(self, arrivals, times, poses, truth, until, statuses=(), samples=(), diagnostics=(),
                 scans=()):
        """`poses`: (N, 3); `truth`: a Trajectory whose stamps are times in ns; `scans`: (arrival, time)."""
        self.until = until
        self.arrivals, self.times = np.asarray(arrivals, dtype=float), np.asarray(times, dtype=float)
        self.scan_arrivals, self.scan_times = np.asarray(scans, dtype=float).reshape(-1, 2).T
        self.statuses = with_silence(statuses, until)
        self.samples, self.diagnostics = list(samples), list(diagnostics)
        true, valid = poses_at(truth, np.round(1e9 * self.times).astype(np.int64), MAX_GAP)
        difference = np.asarray(poses, dtype=float).reshape(-1, 3) - true
        self.errors = np.where(valid, np.hypot(difference[:, 0], difference[:, 1]), math.nan)

    def errors_between(self, begin, end=math.inf):
        """The errors (m) of the poses that arrived in [begin, end)."""
        selected = (self.arrivals >= begin) & (self.arrivals < end) & np.isfinite(self.errors)
        return self.errors[selected]

    def max_error(self, begin, end=math.inf):
        errors = self.errors_between(begin, end)
        return float(errors.max()) if len(errors) else math.nan

    def max_lag(self, begin):
        """The largest time (s) since `begin` by which the newest pose is behind the newest scan that another
        subscriber has received: before the arrival of the next pose, and at the end."""
        selected = self.arrivals >= begin
        if not selected.any() or not len(self.scan_arrivals):
            return math.nan
        newest_pose = np.maximum.accumulate(self.times[selected])
        checks = np.append(self.arrivals[selected][1:], self.until)
        received = np.searchsorted(self.scan_arrivals, checks) - 1
        return float((np.maximum.accumulate(self.scan_times)[received] - newest_pose).max())

    def recovery(self, begin, end=math.inf):
        """Seconds from `begin` to the status localized that lasts until `end`; infinite without one."""
        since = [(time, text) for time, text in self.statuses if begin <= time < end]
        if not since or since[-1][1] != LOCALIZED:
            return math.inf
        first = max((index + 1 for index, (_, text) in enumerate(since) if text != LOCALIZED), default=0)
        return since[first][0] - begin

    def longest_unlocalized(self, begin, end=math.inf):
        """The longest time (s) with another status than localized."""
        since = [(time, text) for time, text in self.statuses if begin <= time < end]
        return longest_unlocalized(since, min(end, self.until)) if since else math.inf

    def growth(self, begin, end=math.inf):
        """Resident memory (MB): mean of the last second of [begin, end) minus the last value before `begin`."""
        before = [sample for sample in self.samples if sample.time < begin]
        after = [sample for sample in self.samples if begin <= sample.time < end]
        if not before or not after:
            return math.nan
        last = [sample.resident for sample in after if sample.time >= after[-1].time - 1.0]
        return sum(last) / len(last) - before[-1].resident

    def last_value(self, key):
        """A number of the last diagnostics."""
        return float(self.diagnostics[-1][1].get(key, "nan")) if self.diagnostics else math.nan

    def counted(self, keys, begin):
        """The increase of the sum of counters in /diagnostics since the last message before `begin`."""
        sums = [(time, sum(int(values.get(key, 0)) for key in keys)) for time, values in self.diagnostics]
        before = [count for time, count in sums if time < begin]
        return sums[-1][1] - before[-1] if before else math.nan
