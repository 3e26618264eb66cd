"""Loading, measuring and showing what the localizer did; used by scripts/demo, scripts/evaluate and
scripts/experiments."""


class EvaluationError(Exception):
    """Something the user gave that cannot be used; says what, where, and what was expected."""
