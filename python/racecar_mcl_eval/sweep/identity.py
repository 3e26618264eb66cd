"""What makes a result: contents of the files, parameters, seed and version of the program, as a hash."""
import functools
import hashlib
import json
import re
import subprocess
from pathlib import Path

from .. import EvaluationError, programs
from .parameters import read_yaml

FORMAT = 1  # of the results; another number makes other results of the same jobs
_BLOCK = 1 << 20  # bytes


def canonical(value):
    """JSON with one text per value."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)


def hash_of(value):
    """SHA-256, in hexadecimal, of a value that JSON can hold."""
    return hashlib.sha256(canonical(value).encode()).hexdigest()


@functools.lru_cache(maxsize=None)
def _contents(path, size, modified):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(_BLOCK), b""):
            digest.update(block)
    return digest.hexdigest()


def contents(path):
    """SHA-256 of a file. It is read again only if its size or time of modification has changed."""
    try:
        status = Path(path).stat()
        return _contents(str(path), status.st_size, status.st_mtime_ns)
    except OSError as error:
        raise EvaluationError(f"{path}: cannot be read: {error.strerror}") from error


@functools.lru_cache(maxsize=None)
def _image_of(path, _):
    """The image of a map's YAML file with these contents."""
    image = read_yaml(path, "a map_server map").get("image")
    if not isinstance(image, str):
        raise EvaluationError(f"map {path}: image is {image!r}; expected the name of its image file")
    return path.parent / image


def map_contents(path):
    """SHA-256 of a map: those of its YAML file and its image."""
    description = contents(path)
    return hash_of([description, contents(_image_of(path, description))])


@functools.lru_cache(maxsize=None)
def _files_of(program):
    """A program and the package's libraries that it loads, since these hold most of its code."""
    linked = subprocess.run(["ldd", str(program)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    libraries = re.findall(r"^\s*(libracecar_mcl\S*) => (\S+)", linked.stdout.decode(errors="replace"), re.MULTILINE)
    return (program, *(Path(path) for _, path in sorted(libraries)))


def version(name="replay"):
    """SHA-256 of a program and of its libraries."""
    return hash_of([contents(path) for path in _files_of(programs.file_of(name))])


def made_from(job):
    """All that the result of a Job depends on, as a dict for JSON; no names or places of files."""
    drive = job.drive
    return {
        "format": FORMAT, "program": version(), "bag": contents(drive.bag), "map": map_contents(drive.map),
        "truth": contents(drive.truth) if drive.truth else None, "options": list(drive.options),
        "parameters": job.parameters, "seed": job.seed}


def key_of(job):
    """The name of the folder of a Job's result."""
    return hash_of(made_from(job))
