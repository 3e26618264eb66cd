"""The parameters that tune varies, and their ranges."""
import math

from .. import EvaluationError
from .parameters import EXPERT, checked, defaults

FACTOR = 4.0  # by which the default ranges go below and above the default
# Public parameters that are not varied by default, with the reason.
NOT_TUNED = {
    "num_particles": "more are more accurate; the processor limits them",
    "num_beams_per_particle": "more are more accurate; the processor limits them",
    "num_threads": "does not change the result",
    "motion_model": "a choice of the method", "sensor_model": "a choice of the method",
    "range_method": "a choice of the method", "relocalization": "a choice of the behaviour",
    "motion_from": "a property of the odometry", "max_odometry_gap": "a property of the odometry",
    "scan_field_of_view": "a property of the lidar", "scan_direction": "a property of the lidar",
    "deskew": "a property of the lidar",
    "alpha_hit": "calibrate_beam_model estimates the fractions, whose sum is 1",
    "alpha_short": "as alpha_hit", "alpha_max": "as alpha_hit", "alpha_rand": "as alpha_hit",
    "max_range": "is derived from others", "max_particles": "applies to a global start only",
    "integrity_risk": "does not change the pose"}
# Parameters that apply only with this value of another one.
_APPLIES = {
    "longitudinal_noise_from_translation": ("motion_model", "ackermann"),
    "lateral_noise_from_translation": ("motion_model", "ackermann"),
    "yaw_noise_from_translation": ("motion_model", "ackermann"),
    "yaw_noise_from_rotation": ("motion_model", "ackermann"),
    "field_scale": ("sensor_model", "likelihood_field"), "z_rand": ("sensor_model", "likelihood_field"),
    "sigma_hit": ("sensor_model", "beam"), "distance_filter": ("sensor_model", "beam")}


def default_space(base):
    """The search space of all public parameters that apply with the parameters `base` and are not in NOT_TUNED: a dict
    from the name to {"low", "high", "log"} or {"choices"}."""
    space = {}
    for name in defaults():
        other, value = _APPLIES.get(name, (None, None))
        if name.startswith(f"{EXPERT}/") or name in NOT_TUNED or (other and base[other] != value):
            continue
        if base[name] == 0 and not isinstance(base[name], bool):
            continue  # switched off; no factor gives a range
        space[name] = ({"choices": [False, True]} if isinstance(base[name], bool) else
                       {"low": base[name] / FACTOR, "high": base[name] * FACTOR, "log": True})
    return space


def read_space(values, where):
    """The search space from YAML: name: {low, high, log} or name: [choices]. Raises EvaluationError, beginning with
    `where`."""
    if not isinstance(values, dict) or not values:
        raise EvaluationError(f"{where} is {values!r}; expected a mapping of parameters to their ranges")
    return {name: _read_range(name, value, f"{where}: {name}") for name, value in values.items()}


def _read_range(name, value, where):
    expected = "{low: NUMBER, high: NUMBER, log: true or false}, or a list of at least two values"
    if isinstance(value, list) and len(value) > 1:
        choices = [checked({name: each}, where)[name] for each in value]
        return {"choices": choices}
    if not isinstance(value, dict) or not {"low", "high"} <= set(value) <= {"low", "high", "log"}:
        raise EvaluationError(f"{where} is {value!r}; expected {expected}")
    low, high = (checked({name: value[end]}, where)[name] for end in ("low", "high"))
    log = value.get("log", False)
    if isinstance(low, (bool, str)) or not isinstance(log, bool):
        raise EvaluationError(f"{where} is {value!r}; expected {expected}")
    if not low < high or (log and low <= 0) or not math.isfinite(high - low):
        positive = ", and above 0 with log" if log else ""
        raise EvaluationError(f"{where} is {value!r}; expected low below high{positive}")
    return {"low": low, "high": high, "log": log}


def is_whole(interval):
    """Whether the values of a range are whole numbers: both ends are."""
    return isinstance(interval["low"], int) and isinstance(interval["high"], int)


def suggest(trial, space):
    """Values for all parameters of the space from an Optuna trial, with four significant digits."""
    values = {}
    for name, interval in space.items():
        if "choices" in interval:
            values[name] = trial.suggest_categorical(name, interval["choices"])
        elif is_whole(interval):
            values[name] = trial.suggest_int(name, interval["low"], interval["high"], log=interval["log"])
        else:
            value = trial.suggest_float(name, interval["low"], interval["high"], log=interval["log"])
            values[name] = min(max(float(f"{value:.4g}"), interval["low"]), interval["high"])
    return checked(values, "trial")
