"""Settings of studies, and their hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import _native
from .recordings import hash_of

__all__ = ["Settings", "all_settings"]

#: Settings that name a file: what is in the file counts, not where it lies.
_FILES = ("database", "model", "poses")


@dataclass(frozen=True)
class Settings:
    """Settings of one study."""

    #: What is done: ``tag``, ``gap``, ``evaluate`` or ``dataset``.
    job: str
    #: All settings, with their default values, as JSON.
    json: str
    #: Hash of the settings, and of the files that they name.
    hash: str
    #: Why they are none.
    error: str | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Settings:
        """Completes settings by the default values. Those that cannot be used have an error; nothing is raised."""
        if not isinstance(given, Mapping):
            text = json.dumps(given, default=str)
            return cls("", text, _hash(text), f"settings: {text} is no dict: give one with a job")
        # JSON has no other keys than texts.
        given = {str(key): value for key, value in given.items()}
        text = json.dumps(given, sort_keys=True, default=str)
        job = str(given.get("job", ""))
        try:
            complete = json.loads(_native.study_settings(text))
            content = {key: _content(key, value) for key, value in complete.items()}
        except (ValueError, OSError) as error:
            return cls(job, text, _hash(text), str(error))
        return cls(job, json.dumps(complete, sort_keys=True), _hash(json.dumps(content, sort_keys=True)))


def all_settings(settings: Mapping[str, Any] | Iterable[Mapping[str, Any]]) -> list[Settings]:
    """Completes the settings of one or of many studies."""
    is_one = isinstance(settings, (Mapping, str)) or not isinstance(settings, Iterable)
    many = [settings] if is_one else list(settings)
    return [Settings.of(one) for one in many]


def _content(key: str, value: Any) -> Any:
    return hash_of(Path(value)) if key in _FILES and value is not None else value


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
