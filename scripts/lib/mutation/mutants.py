"""Mutants: single edits of the source that a test has to notice."""
from collections import namedtuple

import yaml

# `file`: relative to the repository. `start`: index of `old` in its text.
Mutant = namedtuple("Mutant", "name file start old new")


class MutationError(Exception):
    """A list of mutants, a build or a test run that cannot be used."""


def mutated(text, mutant):
    """The text of the mutant's file with the edit."""
    end = mutant.start + len(mutant.old)
    if text[mutant.start:end] != mutant.old:
        raise MutationError(f"{mutant.file}: '{mutant.old}' is not at {mutant.start}")
    return text[:mutant.start] + mutant.new + text[end:]


def located(text, entry):
    """The Mutant of an entry of the list (file, old, new, why) in the text of its file."""
    count = text.count(entry["old"])
    if count != 1:
        raise MutationError(f"{entry['file']}: '{entry['why']}': its text is there {count} times, expected once: "
                            f"{entry['old']}")
    return Mutant(entry["why"], entry["file"], text.index(entry["old"]), entry["old"], entry["new"])


def read_list(root, path):
    """The listed Mutants, and those that no test can notice as a set of (file, old line, new line). Raises
    MutationError that names every entry which no longer applies."""
    lists = yaml.safe_load(path.read_text(encoding="utf-8"))
    texts, mutants, problems = {}, [], []
    for entry in lists["mutants"] + lists["equivalent"]:
        if entry["file"] not in texts:
            texts[entry["file"]] = (root / entry["file"]).read_text(encoding="utf-8")
    for entry in lists["mutants"]:
        try:
            mutants.append(located(texts[entry["file"]], entry))
        except MutationError as error:
            problems.append(str(error))
    for entry in lists["equivalent"]:
        lines = [line.strip() for line in texts[entry["file"]].splitlines()]
        if entry["old"] not in lines:
            problems.append(f"{entry['file']}: there is no line '{entry['old']}'")
    if problems:
        raise MutationError("\n".join(problems))
    return mutants, {(entry["file"], entry["old"], entry["new"]) for entry in lists["equivalent"]}
