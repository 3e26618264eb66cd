"""Evaluation of the localizer: loads runs, measures errors and consistency, draws figures and pages. Used by
the programs in scripts/ and tools/."""


class EvaluationError(Exception):
    """Unusable input; the message names the input, the problem and what was expected."""
