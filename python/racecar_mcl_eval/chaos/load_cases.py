"""Cases: many subscribers, and a busy processor."""
import contextlib
import os

import numpy as np

from .. import EvaluationError
from .crowd import read_and_ignore
from .player import child, occupy_core
from .report import Case, Limit
from .session import SETTLING, START_UP, Session

SUBSCRIBERS = 50
TOPICS = ["/pf/pose/odom", "/tf", "/pf/viz/particles", "/pf/viz/scan", "/pf/viz/fake_scan"]
CROWD_SETTLING = 3.0  # s, for the buffers of the connections


def connections(answer):
    """The number of connections that read_and_ignore sends to its pipe; 0 if it ends or takes too long."""
    try:
        return answer.recv() if answer.poll(START_UP) else 0
    except EOFError:
        return 0


def crowd(lab):
    drive = lab.drive()
    with contextlib.ExitStack() as stack:
        session = stack.enter_context(Session(lab, "crowd", drive))
        session.continue_until(SETTLING)
        answer = stack.enter_context(child(read_and_ignore, TOPICS, SUBSCRIBERS, lab.environment))
        if connections(answer) != SUBSCRIBERS + len(TOPICS):
            raise EvaluationError("the subscribers did not connect")
        begin = session.now() + CROWD_SETTLING
        session.continue_until(begin + lab.seconds)
        seen, waits = session.observation(), session.waits_for_transforms(begin)
    return {"scan to tf, p99": 1e3 * np.percentile(waits, 99) if len(waits) else np.nan,
            "in the node, p99": seen.last_value("scan to tf p99 (ms)"), "max error": seen.max_error(begin),
            "growth": seen.growth(begin)}


def occupy_all_cores(lab):
    drive = lab.drive()
    with contextlib.ExitStack() as stack:
        session = stack.enter_context(Session(lab, "busy", drive))
        session.continue_until(SETTLING)
        for core in sorted(os.sched_getaffinity(0)):
            stack.enter_context(child(occupy_core, core))
        begin = session.now()
        session.continue_until(begin + lab.seconds)
        seen = session.observation()
    return {"error, p99": np.percentile(seen.errors_between(begin), 99),
            "not localized for": seen.longest_unlocalized(begin)}


CASES = [
    Case("crowd", f"{SUBSCRIBERS} subscribers that read, and one per topic that never reads",
         [Limit("scan to tf, p99", 100.0, "ms", ".1f"), Limit("in the node, p99", 100.0, "ms", ".1f"),
          Limit("max error", 0.3, "m"), Limit("growth", 20.0, "MB", ".1f")], crowd),
    Case("busy", "all cores are kept busy by other programs of the same priority",
         [Limit("error, p99", 0.1, "m", ".3f"), Limit("not localized for", 1.0, "s", ".1f")], occupy_all_cores),
]
