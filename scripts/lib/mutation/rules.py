"""Mutants made by rules from the lines of a source: comparisons, constants, statements and signs."""
import random
import re

from .mutants import Mutant

FLIPPED = {"<": ">=", ">": "<=", "<=": ">", ">=": "<", "==": "!=", "!=": "=="}
SWAPPED = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
# By how much a constant changes. A smaller change is a question of tuning, which benchmarks answer.
CONSTANT_FACTOR = 10

COMPARISON = re.compile(r"(?<= )(?:<=|>=|==|!=|<|>)(?= )")
SIGN = re.compile(r"(?<=[\w)\]] )(?:\+=|-=|\+|-)(?= )")
CONSTANT = re.compile(r"constexpr (?:double|float|int|std::size_t) k\w+ = (-?[\d.]+(?:e-?\d+)?)(?=[f;]|F;)")
# An assignment or a call, a whole line, that declares nothing.
STATEMENT = re.compile(r"(?:(?:\+\+|--)?[\w.\[\]>-]+(?:\([^;]*\))?(?: [-+*/|]?= [^;]+)?);")
NO_STATEMENT = re.compile(r"(?:return|throw|break|continue|using|const|auto|static)\b|\w+;$")
# A loop's condition never survives: the loop ends at once or never.
LOOP = re.compile(r"\s*(?:for|while) \(")


def code_lines(text):
    """Yields (number, start, line, begins) for lines of code: no comments, directives or texts. `begins`: a statement
    begins on the line."""
    start, before = 0, ""
    for number, line in enumerate(text.splitlines(keepends=True), 1):
        code = line.split("//")[0].rstrip()
        if code.strip():
            if not code.lstrip().startswith("#") and '"' not in code and "template" not in code:
                yield number, start, code, before[-1:] in (";", "{", "}")
            before = code
        start += len(line)


def multiplied(number):
    """The text of a number times CONSTANT_FACTOR, a whole number again if it was one."""
    if re.fullmatch(r"-?\d+", number):
        return str(CONSTANT_FACTOR * int(number))
    return repr(CONSTANT_FACTOR * float(number))


def edits(code, begins):
    """Yields (rule, start, old, new) of one line; `begins`: as code_lines."""
    if not LOOP.match(code):
        for found in COMPARISON.finditer(code):
            yield "comparison", found.start(), found.group(), FLIPPED[found.group()]
        for found in SIGN.finditer(code):
            yield "sign", found.start(), found.group(), SWAPPED[found.group()]
    for found in CONSTANT.finditer(code):
        if float(found.group(1)) != 0.0:
            yield "constant", found.start(1), found.group(1), multiplied(found.group(1))
    stripped = code.strip()
    if begins and STATEMENT.fullmatch(stripped) and not NO_STATEMENT.match(stripped):
        yield "statement", code.index(stripped), stripped, ";"


def line_of(text, mutant):
    """The line before and after the edit, without indentation."""
    begin = text.rfind("\n", 0, mutant.start) + 1
    line = text[begin:text.find("\n", mutant.start)]
    at = mutant.start - begin
    return line.strip(), (line[:at] + mutant.new + line[at + len(mutant.old):]).strip()


def generate(sources, seed, count, equivalent=frozenset()):
    """`count` Mutants of the `sources` (a dict from file to text), each rule in turn, without those that are
    `equivalent`: (file, old line, new line). The same for the same seed and sources."""
    by_rule = {}
    for file, text in sorted(sources.items()):
        for number, start, code, begins in code_lines(text):
            for rule, column, old, new in edits(code, begins):
                name = f"{file}:{number}: {rule} '{old}' -> '{new}'"
                mutant = Mutant(name, file, start + column, old, new)
                if (file,) + line_of(text, mutant) not in equivalent:
                    by_rule.setdefault(rule, []).append(mutant)
    chooser = random.Random(seed)
    for _, mutants in sorted(by_rule.items()):
        chooser.shuffle(mutants)
    chosen = []
    while len(chosen) < count and any(by_rule.values()):
        for _, mutants in sorted(by_rule.items()):
            if mutants and len(chosen) < count:
                chosen.append(mutants.pop())
    return chosen
