"""The unit of distributed work: one recording with some settings."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from typing import Any

import pyarrow as pa

from .. import _native
from .recordings import fetched, hash_of
from .rows import batch_of, key_of
from .settings import Settings, all_settings

__all__ = ["key_columns", "message_of", "rows_of", "study"]

#: Version of the library, and hash of the sources that it was built from: two of one version may find other things.
_VERSION = f"{_native.VERSION}+{_native.SOURCES}"

#: Times of robots that know no date begin with the robot: such a day is none.
_FIRST_DAY = datetime(2000, 1, 1, tzinfo=timezone.utc).timestamp()
_END = datetime(2100, 1, 1, tzinfo=timezone.utc).timestamp()


def study(
    recording_uri: str | os.PathLike[str], settings: Mapping[str, Any] | Iterable[Mapping[str, Any]]
) -> pa.RecordBatch:
    """Tags a recording, compares it with its camera's model, evaluates pictures of it, or makes some: with one or many settings.

    Each of the settings is a dict: ``job`` is ``tag``, ``gap``, ``evaluate`` or ``dataset``, and the other keys have the names of the program's options; what
    is left out has their default values. For each there is one row. A row depends on nothing but the recording, the settings and the version of
    the library, whose hashes are its key: neither on the machine nor on the number of its threads. Errors are rows, too, with a message in the
    column ``error``; nothing is raised. Those of a machine, as of a full disk, say nothing of the recording: their column ``recording`` is empty.

    >>> batch = reality_sim.study("walk", [{"job": "tag"}, {"job": "tag", "observation": "gauss"}])
    >>> batch.column("mean_m")
    """
    complete = all_settings(settings)
    try:
        with fetched(recording_uri) as folder:
            return batch_of(rows_of(folder, hash_of(folder), complete))
    except Exception as error:  # noqa: BLE001 — an address may fail in as many ways as there are file systems
        return batch_of([_row("", one, {"error": message_of(error)}) for one in complete])


def rows_of(folder: os.PathLike[str], recording: str, settings: list[Settings]) -> list[dict[str, Any]]:
    """Studies a folder of this machine, whose hash is given. Rows of what the machine failed have an empty hash."""
    usable = [one for one in settings if one.error is None]
    found = iter(_native.study(folder, [_with_folder(one, recording) for one in usable]))
    rows = []
    for one in settings:
        told, picture = next(found) if one.error is None else (json.dumps({"error": one.error}), None)
        told = json.loads(told)
        rows.append(_row("" if told.get("is_of_machine") else recording, one, told) | {"picture": picture})
    return rows


def message_of(error: Exception) -> str:
    """Returns what an exception says; the name of its class where it says nothing."""
    return str(error) or type(error).__name__


def _with_folder(settings: Settings, recording: str) -> str:
    """Returns settings in JSON. A data set gets a folder of its own, named by the row's key: whoever makes it completes the same one."""
    complete = json.loads(settings.json)
    if settings.job == "dataset":
        complete["out"] = os.path.join(complete["out"], key_of(key_columns(recording, settings)))
    return json.dumps(complete)


def key_columns(recording: str, settings: Settings) -> dict[str, str]:
    """Returns the columns by which the row of a recording, whose hash is given, is found."""
    return {"recording": recording, "settings": settings.hash, "version": _VERSION}


def _row(recording: str, settings: Settings, found: dict[str, Any]) -> dict[str, Any]:
    row = {
        **key_columns(recording, settings),
        "job": settings.job,
        "settings_json": settings.json,
        "error": found.get("error"),
    }
    if "error" in found:
        return row
    about = found["about"]
    return row | {
        "name": about["name"],
        "robot": about["robot"],
        "day": about["recorded_on"] or _day_of(about["begin_s"]),
        "report": json.dumps(found["report"], sort_keys=True),
        **found["figures"],
    }


def _day_of(begin_s: float) -> str | None:
    if not _FIRST_DAY <= begin_s < _END:
        return None
    return datetime.fromtimestamp(begin_s, timezone.utc).date().isoformat()
