"""How every program of this package ends."""
import sys

from . import EvaluationError


def exit_status(name, work):
    """Runs work(). What it returns is the exit status, nothing being 0; what the user can mend is
    one line on stderr, not a traceback."""
    try:
        return work() or 0
    except (EvaluationError, OSError) as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"{name}: stopped", file=sys.stderr)
        return 130
