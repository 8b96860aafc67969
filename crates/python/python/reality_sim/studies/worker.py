"""What runs in each process of an engine."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import pyarrow as pa

from .. import _native
from .recordings import fetched, hash_of
from .rows import key_of
from .settings import Settings, all_settings
from .study import key_columns, message_of, rows_of
from .tables import missing_keys, write_row

__all__ = ["StudyWorker"]

#: Tags that share the decoding of a recording's pictures. Each more holds a filter and its result in memory, and saves less of the decoding:
#: of 16, a sixteenth of one decoding is left to each.
_TAGS_AT_ONCE = 16


class StudyWorker:
    """Studies recordings with the same settings, and writes the rows that are missing in the tables.

    It is a class for ``ray.data.Dataset.map_batches``: called with a batch that has a column ``uri``, it returns what became of each recording.
    It keeps nothing between two recordings. Where it is killed, the rows that it has written stay, and another one goes on with the rest.

    Args:
      settings: one dict, or many, as :func:`reality_sim.study` takes them.
      tables: folder of the tables, a path or an address of pyarrow.
      threads: the process's share of the cores. A process has one number of threads, which its first worker sets.
    """

    def __init__(
        self,
        settings: Mapping[str, Any] | Iterable[Mapping[str, Any]],
        tables: str | os.PathLike[str],
        threads: int | None = None,
    ) -> None:
        self._settings = all_settings(settings)
        self._tables = tables
        if threads is not None and not _native.use_threads(threads):
            raise RuntimeError(f"this process works with another number of threads than {threads} already")

    def study_one(self, uri: str | os.PathLike[str]) -> dict[str, Any]:
        """Studies a recording, and returns how many rows were written, how many there were, and why there are none.

        A recording that cannot be fetched has no rows: it may be there the next time. Rows are written after each portion of the settings, and
        stay where this process is killed in the next, or the machine fails it.
        """
        told = {"uri": os.fspath(uri), "recording": None, "written": 0, "present": 0, "error": None}
        try:
            with fetched(uri) as folder:
                recording = hash_of(folder)
                told["recording"] = recording
                key = {one: key_of(key_columns(recording, one)) for one in self._settings}
                missing = set(missing_keys(key.values(), self._tables))
                told["present"] = len(self._settings) - len(missing)
                for portion in _portions([one for one in self._settings if key[one] in missing]):
                    try:
                        for row in rows_of(folder, recording, portion):
                            if row["recording"]:
                                write_row(row, self._tables)
                                told["written"] += 1
                            else:
                                told["error"] = row["error"]
                    except OSError as error:
                        told["error"] = message_of(error)
        except Exception as error:  # noqa: BLE001 — an address may fail in as many ways as there are file systems
            told["error"] = message_of(error)
        return told

    def __call__(self, batch: pa.Table) -> pa.Table:
        """Studies the recordings of a batch."""
        told = [self.study_one(uri) for uri in batch.column("uri").to_pylist()]
        return pa.Table.from_pylist(told, schema=_TOLD)


def _portions(settings: list[Settings]) -> Iterator[list[Settings]]:
    """Splits settings: tags, which share the decoding of pictures, into some at a time, and all others one by one."""
    tags = [one for one in settings if one.job == "tag"]
    for first in range(0, len(tags), _TAGS_AT_ONCE):
        yield tags[first : first + _TAGS_AT_ONCE]
    yield from ([one] for one in settings if one.job != "tag")


_TOLD = pa.schema(
    [
        pa.field("uri", pa.string()),
        pa.field("recording", pa.string()),
        pa.field("written", pa.int64()),
        pa.field("present", pa.int64()),
        pa.field("error", pa.string()),
    ]
)
