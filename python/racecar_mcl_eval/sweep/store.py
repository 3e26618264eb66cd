"""Results on disk: RESULTS/<hash of what made it>/result.json."""
import json
import os
import tempfile
from pathlib import Path

from .identity import hash_of

FILE = "result.json"


class Store:
    """Results by the keys of their jobs. Processes on several machines may write to one store: a result appears
    complete or not at all, and two results of the same job are the same bytes."""

    def __init__(self, folder):
        self.folder = Path(folder)

    def path(self, key):
        return self.folder / key / FILE

    def read(self, key):
        """The result, or None if it is missing or damaged."""
        try:
            saved = json.loads(self.path(key).read_text(encoding="utf-8"))
            intact = hash_of(saved["made_from"]) == key and hash_of(saved["result"]) == saved["sha256"]
        except (OSError, ValueError, KeyError, TypeError):
            return None
        return saved["result"] if intact else None

    def write(self, key, made_from, result):
        """Writes a result; `key` is the hash of `made_from`."""
        saved = {"made_from": made_from, "result": result, "sha256": hash_of(result)}
        path = self.path(key)
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=str(path.parent), suffix=".tmp", delete=False,
                                         encoding="utf-8") as file:
            file.write(json.dumps(saved, indent=2, sort_keys=True) + "\n")
        try:
            os.chmod(file.name, 0o644)
            os.replace(file.name, str(path))
        except FileNotFoundError:
            # Removed by another process that has written the same result.
            if self.read(key) is None:
                raise
        self._remove_left_over(path.parent)

    @staticmethod
    def _remove_left_over(folder):
        """Removes what killed processes have left of this result."""
        for file in folder.glob("*.tmp"):
            try:
                file.unlink()
            except FileNotFoundError:
                pass
