"""Reads a recording of the running localizer: diagnostics, and agreement of the scans with the map."""
import math

import numpy
import rosbag

INLIER_DISTANCE = 0.2  # m; largest difference of an inlier's range from the expected range


def localizer_values(message):
    """The key-value pairs of the localizer in a DiagnosticArray, as a dict; empty if it is not in it."""
    for status in message.status:
        if status.name.endswith("localization"):
            return {pair.key: pair.value for pair in status.values}
    return {}


def last_diagnostics(recording):
    """The localizer's last values on /diagnostics."""
    values = {}
    with rosbag.Bag(str(recording)) as bag:
        for _, message, _ in bag.read_messages(topics=["/diagnostics"]):
            values = localizer_values(message) or values
    return values


def inlier_ratio(recording):
    """Fraction of the returns within INLIER_DISTANCE of the range expected at the estimate, mean over the
    scans; NaN without scans."""
    waiting = {}  # stamp to (topic, ranges) of the message that came first
    ratios = []
    with rosbag.Bag(str(recording)) as bag:
        topics = ["/pf/viz/fake_scan", "/pf/viz/scan"]
        for topic, message, _ in bag.read_messages(topics=topics):
            key = message.header.stamp.to_nsec()
            ranges = numpy.array(message.ranges)
            if key not in waiting:
                waiting[key] = (topic, ranges)
                continue
            other_topic, other = waiting.pop(key)
            if other_topic == topic or other.shape != ranges.shape:
                continue
            real, expected = (other, ranges) if topic == topics[0] else (ranges, other)
            returned = numpy.isfinite(real) & (real >= message.range_min) & (
                real < message.range_max)
            if returned.any():
                # An expected range of infinity (no return) never agrees.
                difference = numpy.abs(numpy.where(numpy.isfinite(expected), expected, 1e9) - real)
                ratios.append(float((difference[returned] <= INLIER_DISTANCE).mean()))
    return float(numpy.mean(ratios)) if ratios else math.nan
