"""What a recording of the running localizer tells besides its trajectory."""
import math

import numpy
import rosbag

NEAR = 0.2  # m; a return this near to the range expected at the estimate agrees with the map


def last_diagnostics(record):
    """The localizer's last words on /diagnostics."""
    values = {}
    with rosbag.Bag(str(record)) as bag:
        for _, message, _ in bag.read_messages(topics=["/diagnostics"]):
            for status in message.status:
                if status.name.endswith("localization"):
                    values = {pair.key: pair.value for pair in status.values}
    return values


def agreeing_beams(record):
    """Share of the returns that lie within NEAR of the range expected at the estimate."""
    expected = {}
    shares = []
    with rosbag.Bag(str(record)) as bag:
        topics = ["/pf/viz/fake_scan", "/pf/viz/scan"]
        for topic, message, _ in bag.read_messages(topics=topics):
            key = message.header.stamp.to_nsec()
            ranges = numpy.array(message.ranges)
            if key not in expected:
                expected[key] = (topic, ranges)
                continue
            other_topic, other = expected.pop(key)
            if other_topic == topic or other.shape != ranges.shape:
                continue
            real, fake = (other, ranges) if topic == topics[0] else (ranges, other)
            returned = numpy.isfinite(real) & (real >= message.range_min) & (
                real < message.range_max)
            if returned.any():
                # A missing expected return (inf) is as far off as can be.
                difference = numpy.abs(numpy.where(numpy.isfinite(fake), fake, 1e9) - real)
                shares.append(float((difference[returned] <= NEAR).mean()))
    return float(numpy.mean(shares)) if shares else math.nan
