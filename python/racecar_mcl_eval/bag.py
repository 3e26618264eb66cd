"""Reads bags: poses of an odometry topic, laser scans, and the mounting pose of the lidar."""
from dataclasses import dataclass

import numpy as np

from . import EvaluationError
from .trajectory import in_order, yaw_of


@dataclass
class RecordedScan:
    """The beams with a return, as end points in the lidar's frame, not deskewed."""
    stamp: int           # ns, of the first beam
    times: np.ndarray    # ns after the stamp, when each beam was taken
    points: np.ndarray   # (K, 2), m


def open_bag(path):
    # Imported here: everything except bags works without ROS.
    import rosbag
    try:
        return rosbag.Bag(str(path))
    except (OSError, rosbag.ROSBagException) as error:
        raise EvaluationError(f"{path}: the bag cannot be read: {error}") from error


def topic_types(path):
    """A dict from topic to message type."""
    with open_bag(path) as bag:
        return {topic: info.msg_type for topic, info in bag.get_type_and_topic_info().topics.items()}


def find_topic(path, topic, message_type):
    """The topic's name in the bag, with or without the leading slash. Raises EvaluationError if missing."""
    types = topic_types(path)
    for name, kind in types.items():
        if name.strip("/") == topic.strip("/") and kind == message_type:
            return name
    held = ", ".join(f"{name} ({kind})" for name, kind in sorted(types.items())) or "nothing"
    raise EvaluationError(f"{path}: no topic {topic} of type {message_type}; the bag holds: {held}")


def has_topic(path, topic, message_type):
    return any(name.strip("/") == topic.strip("/") and kind == message_type
               for name, kind in topic_types(path).items())


@dataclass
class RecordedPoses:
    trajectory: object      # Trajectory
    covariances: np.ndarray  # (N, 3, 3) of (x, y, yaw), in the trajectory's order


def read_odometry(path, topic):
    """The poses and covariances of a nav_msgs/Odometry topic, by header stamp."""
    topic_in_bag = find_topic(path, topic, "nav_msgs/Odometry")
    stamps, poses, covariances = [], [], []
    with open_bag(path) as bag:
        for _, message, _ in bag.read_messages(topics=[topic_in_bag]):
            position, turn = message.pose.pose.position, message.pose.pose.orientation
            stamps.append(message.header.stamp.to_nsec())
            poses.append((position.x, position.y, yaw_of(turn.x, turn.y, turn.z, turn.w)))
            full = np.reshape(message.pose.covariance, (6, 6))
            covariances.append(full[np.ix_((0, 1, 5), (0, 1, 5))])
    if not stamps:
        raise EvaluationError(f"{path}: {topic} has no messages")
    trajectory = in_order(stamps, poses)
    _, first = np.unique(np.asarray(stamps, dtype=np.int64), return_index=True)
    return RecordedPoses(trajectory, np.asarray(covariances)[first])


def laser_mount(path, laser_frame, base_frame):
    """The 4 x 4 transform from the lidar's frame to the car's base frame, from /tf_static and /tf."""
    from geometry_msgs.msg import TransformStamped
    from rospy import Time
    from tf2_py import BufferCore, TransformException
    transforms = BufferCore()
    frames = set()

    def insert(message, fixed):
        for recorded in message.transforms:
            # rosbag generates its own message classes, which tf2 does not accept.
            transform = TransformStamped()
            transform.header.stamp = recorded.header.stamp
            transform.header.frame_id = recorded.header.frame_id.lstrip("/")
            transform.child_frame_id = recorded.child_frame_id.lstrip("/")
            for part in ("translation", "rotation"):
                source, target = getattr(recorded.transform, part), getattr(transform.transform, part)
                for axis in target.__slots__:
                    setattr(target, axis, getattr(source, axis))
            frames.update((transform.header.frame_id, transform.child_frame_id))
            set_transform = transforms.set_transform_static if fixed else transforms.set_transform
            set_transform(transform, "bag")

    def lookup():
        return transforms.lookup_transform_core(base_frame.lstrip("/"), laser_frame.lstrip("/"),
                                                Time(0)).transform

    with open_bag(path) as bag:
        for _, message, _ in bag.read_messages(topics=["/tf_static", "tf_static"]):
            insert(message, True)
        try:
            return matrix_of(lookup())
        except TransformException:
            pass
        for _, message, _ in bag.read_messages(topics=["/tf", "tf"]):
            insert(message, False)
            try:
                return matrix_of(lookup())
            except TransformException:
                continue
    known = ", ".join(sorted(frames)) or "none"
    raise EvaluationError(f"{path}: no transform from the lidar's frame '{laser_frame}' to "
                          f"'{base_frame}' in /tf_static and /tf; known frames: {known}; give it with "
                          "--laser-pose")


def matrix_of(transform):
    q, t = transform.rotation, transform.translation
    x, y, z, w = np.array((q.x, q.y, q.z, q.w)) / np.sqrt(q.x**2 + q.y**2 + q.z**2 + q.w**2)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), t.x],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), t.y],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), t.z],
        [0.0, 0.0, 0.0, 1.0]])


def matrix_of_pose(x, y, yaw):
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    matrix[:2, 3] = x, y
    return matrix


def read_scans(path, topic, max_scans=1500, beams=200):
    """At most `max_scans` scans, evenly spaced over the bag, with at most `beams` returns each (None: all),
    and the lidar's frame."""
    topic_in_bag = find_topic(path, topic, "sensor_msgs/LaserScan")
    scans, frame = [], None
    with open_bag(path) as bag:
        count = bag.get_message_count(topic_filters=[topic_in_bag])
        every = max(1, -(-count // (max_scans or max(1, count))))
        for index, (_, message, _) in enumerate(bag.read_messages(topics=[topic_in_bag])):
            frame = frame or message.header.frame_id
            if index % every == 0:
                scans.append(to_scan(message, beams))
    if not scans:
        raise EvaluationError(f"{path}: {topic} has no messages")
    return scans, frame


def to_scan(message, beams):
    ranges = np.asarray(message.ranges, dtype=float)
    returned = np.flatnonzero(np.isfinite(ranges) & (ranges > max(message.range_min, 0.0)) &
                              (ranges < message.range_max))
    if beams is not None and len(returned) > beams:
        returned = returned[np.linspace(0, len(returned) - 1, beams).astype(int)]
    bearings = message.angle_min + message.angle_increment * returned
    points = ranges[returned, None] * np.column_stack((np.cos(bearings), np.sin(bearings)))
    times = np.round(returned * message.time_increment * 1e9).astype(np.int64)
    return RecordedScan(message.header.stamp.to_nsec(), times, points)
