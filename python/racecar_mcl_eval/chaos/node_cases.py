"""Cases: nodes are killed, restarted and reloaded."""
import math
import os
import signal
import time

import numpy as np
import rospy
from nav_msgs.msg import OccupancyGrid

from .. import benchmarks, programs, ros_graph
from . import process
from .report import Case, Limit
from .session import MANAGER, SETTLING, Session

PATIENCE = 10.0  # s, for the status localized and for the map
RELOADS = 5  # number of reloads over which the memory is averaged
RELOAD_SECONDS = 6.0  # s, of the drive for each reload


def kill_localizer(lab):
    drive = lab.drive()
    with Session(lab, "killed", drive, respawn="true", last_pose_file=lab.folder / "last_pose.yaml") as session:
        session.continue_until(SETTLING)
        os.kill(session.localizer_pid(), signal.SIGKILL)
        killed = session.now()
        session.continue_until(killed + 1.0)
        session.wait_for_localized(PATIENCE)
        localized = session.now()
        session.continue_until(localized + 5.0)
        seen = session.observation()
    return {"localized again after": localized - killed if math.isfinite(seen.recovery(killed)) else math.inf,
            "max error from then on": seen.max_error(localized)}


def map_server(lab):
    return lab.running("map_server", [*programs.find("map_node"), benchmarks.MAP])


def restart_map_server(lab):
    drive = lab.drive()
    with map_server(lab) as server, Session(lab, "map_restarted", drive, map="") as session:
        session.continue_until(SETTLING)
        server.kill()
        session.continue_until(SETTLING + 2.0)
        with map_server(lab):
            session.continue_until(SETTLING + 2.0 + lab.seconds)
        seen = session.observation()
    return kept_pose(seen)


def repeat_map(lab):
    drive = lab.drive()
    with map_server(lab), Session(lab, "map_repeated", drive, map="") as session:
        grid = rospy.wait_for_message("/map", OccupancyGrid, timeout=PATIENCE)
        publisher = rospy.Publisher("/map", OccupancyGrid, queue_size=1)
        session.continue_until(SETTLING)
        session.continue_until(SETTLING + lab.seconds, lambda: publisher.publish(grid), period=1.0)
        seen = session.observation()
        publisher.unregister()
    return kept_pose(seen)


def kept_pose(seen):
    return {"max error": seen.max_error(SETTLING), "not localized for": seen.longest_unlocalized(SETTLING)}


def reload_nodelet(lab):
    """Loads the localization nodelet into the running manager, and ends its loader, which unloads it."""
    drive = lab.drive(SETTLING + RELOAD_SECONDS * lab.reloads)
    words = ["rosrun", "nodelet", "nodelet", "load", "racecar_mcl/LocalizationNodelet", MANAGER,
             "__name:=localization", "scan:=/scan", "odom:=/vesc/odom"]
    unloaded, localized, resident = [], [], []
    with Session(lab, "reloaded", drive) as session:
        session.continue_until(SETTLING)
        os.kill(process.find_descendant(session.launch.pid, "localization"), signal.SIGINT)
        for _ in range(lab.reloads):
            x, y, yaw = drive.true_pose(session.now())
            rospy.set_param("/localization/initial_pose", f"{x} {y} {yaw}")
            with lab.running("loader", words) as loader:
                localized.append(session.wait_for_localized(PATIENCE))
                begin = time.monotonic()
                ros_graph.end(loader)
                unloaded.append(time.monotonic() - begin)
            resident.append(process.resident_of(session.localizer_pid()))
        begin = time.monotonic()
        ros_graph.end(session.launch)
        shutdown = time.monotonic() - begin
    return {"localized after": max(localized), "growth": reload_growth(resident), "unload": max(unloaded),
            "shutdown": shutdown}


def reload_growth(resident):
    """The growth (%) from the five reloads after the first five to the last five, in the median: single values vary
    with the state of the allocator."""
    return 100.0 * (np.median(resident[-RELOADS:]) / np.median(resident[RELOADS:2 * RELOADS]) - 1.0)


CASES = [
    Case("killed", "SIGKILL to the nodelet manager at 3 m/s, with respawn and last_pose_file",
         [Limit("localized again after", 5.0, "s", ".1f"), Limit("max error from then on", 0.3, "m")],
         kill_localizer),
    Case("map-restarted", "SIGKILL to the map server, and a new one after 2 s",
         [Limit("max error", 0.3, "m"), Limit("not localized for", 1.0, "s", ".1f")], restart_map_server),
    Case("map-repeated", "the map is published at 1 Hz",
         [Limit("max error", 0.3, "m"), Limit("not localized for", 1.0, "s", ".1f")], repeat_map),
    Case("reloaded", "the localization nodelet is loaded into the manager and unloaded, again and again",
         [Limit("localized after", 5.0, "s", ".1f"), Limit("growth", 10.0, "%", ".1f"),
          Limit("unload", 5.0, "s", ".1f"), Limit("shutdown", 5.0, "s", ".1f")], reload_nodelet),
]
