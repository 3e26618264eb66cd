"""Exit status and error messages of the package's command-line programs."""
import sys

from . import EvaluationError


def exit_status(name, work):
    """Runs work(). Returns its result as the exit status (None: 0). An EvaluationError or OSError becomes
    one line on stderr and status 1."""
    try:
        return work() or 0
    except (EvaluationError, OSError) as error:
        print(f"{name}: error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print(f"{name}: interrupted", file=sys.stderr)
        return 130
