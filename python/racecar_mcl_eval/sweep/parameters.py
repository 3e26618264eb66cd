"""Parameters of the localizer by name: the defaults, and what a setting makes of them."""
import difflib
import functools

import yaml

from .. import EvaluationError
from ..programs import ROOT

DEFAULTS_FILE = ROOT / "config/default.yaml"
EXPERT = "expert"  # section, and prefix of the names in it
# For YAML, `off` and `on` are false and true; quoted they are texts.
_KINDS = {bool: "true or false", str: "a text, in quotes if it is on, off, yes or no", float: "a number"}


def read_yaml(path, what):
    """The mapping in a YAML file. `what`: that which the file holds, for the message of an EvaluationError."""
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise EvaluationError(f"{path}: cannot be read: {' '.join(str(error).split())}") from error
    if not isinstance(values, dict):
        raise EvaluationError(f"{path}: expected {what} as a mapping of names to values")
    return values


def _flat(values):
    """With `expert: {name: value}` as `expert/name: value`."""
    flat = {name: value for name, value in values.items() if name != EXPERT}
    section = values.get(EXPERT, {})
    if isinstance(section, dict):
        flat.update((f"{EXPERT}/{name}", value) for name, value in section.items())
    else:
        flat[EXPERT] = section
    return flat


@functools.lru_cache(maxsize=None)
def defaults():
    """All parameters with their defaults, as a read-only dict."""
    return {name: _canonical(value) for name, value in read_yaml(DEFAULTS_FILE, "parameters").items()}


def _kind(value):
    return type(value) if isinstance(value, (bool, str)) else float


def _canonical(value):
    """The same value for the same parameter, however it is written: 200 for 200.0."""
    if _kind(value) is float and float(value).is_integer():
        return int(value)
    return value


def _number(text):
    """A number that YAML reads as a text, such as 1e-3, else the text."""
    try:
        return float(text)
    except (TypeError, ValueError):
        return text


def checked(values, where):
    """The parameters in `values` (a mapping, sections allowed) with canonical values. Raises EvaluationError, which
    begins with `where`, on an unknown name and on a value of the wrong type; replay checks the ranges."""
    if not isinstance(values, dict):
        raise EvaluationError(f"{where} is {values!r}; expected parameters as a mapping of names to values")
    known = defaults()
    result = {}
    for name, value in _flat(values).items():
        if name not in known:
            near = difflib.get_close_matches(str(name), known, 1, 0.5)
            raise EvaluationError(f"{where}: there is no parameter '{name}'; expected one of docs/parameters.md" +
                                  (f", such as '{near[0]}'" if near else ""))
        expected = _kind(known[name])
        if expected is float:
            value = _number(value) if isinstance(value, str) else value
        if not isinstance(value, (bool, int, float, str)) or _kind(value) is not expected:
            raise EvaluationError(f"{where}: {name} is {value!r}; expected {_KINDS[expected]}")
        result[name] = _canonical(value)
    return result


def read_file(path):
    """The parameters in a file for --config."""
    return checked(read_yaml(path, "parameters"), str(path))


def effective(*layers):
    """All parameters: the defaults, overridden by each of the dicts."""
    values = dict(defaults())
    for layer in layers:
        values.update(layer)
    return values


def changes(parameters, others):
    """The parameters whose values differ from `others`, in the order of config/default.yaml."""
    return {name: parameters[name] for name in defaults() if parameters[name] != others[name]}


def to_yaml(parameters):
    """Text of a file for --config and localize.launch."""
    return yaml.safe_dump(dict(parameters), default_flow_style=False, sort_keys=False) if parameters else "{}\n"
