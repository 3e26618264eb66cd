"""Cases, their promises, and the table of their results."""
from collections import namedtuple

# An upper bound of a measured value. `spec`: how values are printed.
Limit = namedtuple("Limit", "name bound unit spec", defaults=("", ".2f"))
# `action`: what is done to the localizer; `measure(lab)`: does it, and returns a dict of values by the limits' names.
Case = namedtuple("Case", "name action limits measure")
# `values`: None if the case could not be measured, for the reason in `problem`.
Result = namedtuple("Result", "case values problem", defaults=("",))

HEADING = ("| case | what is done | promise | measured | |\n"
           "|---|---|---|---|---|")


def quantity(value, limit):
    return f"{value:{limit.spec}}{' ' + limit.unit if limit.unit else ''}"


def holds(limit, values):
    """False also for a value that is missing or NaN."""
    value = values.get(limit.name)
    return value is not None and value <= limit.bound


def passed(result):
    return result.values is not None and all(holds(limit, result.values) for limit in result.case.limits)


def promise(case):
    return "; ".join(f"{limit.name} at most {limit.bound:g}{' ' + limit.unit if limit.unit else ''}"
                     for limit in case.limits)


def measured(result):
    if result.values is None:
        return result.problem
    texts = []
    for limit in result.case.limits:
        text = f"{limit.name} {quantity(result.values[limit.name], limit)}" if limit.name in result.values else (
            f"{limit.name}: none")
        texts.append(text if holds(limit, result.values) else f"**{text}**")
    return "; ".join(texts)


def row(result):
    """A line of the table below HEADING; broken limits are bold."""
    return (f"| {result.case.name} | {result.case.action} | {promise(result.case)} | {measured(result)} | "
            f"{'pass' if passed(result) else '**FAIL**'} |")


def summary(results):
    failed = [result.case.name for result in results if not passed(result)]
    return f"{len(results) - len(failed)} passed, {len(failed)} failed" + (f": {', '.join(failed)}" if failed else "")


def page(results, details):
    """The table, the (name, text) details below it, and the summary, as Markdown."""
    lines = [HEADING, *map(row, results), "", *(f"- {name}: {text}" for name, text in details)]
    return "\n".join(lines + ([""] if details else []) + [summary(results), ""])
