"""Tables: one Parquet file for each key, which is there as a whole or not at all."""

from __future__ import annotations

import contextlib
import os
import uuid
from collections.abc import Iterable
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import fs

from .places import opened
from .rows import KEY, SCHEMA, batch_of, key_of

__all__ = ["missing_keys", "read_tables", "write_row"]

_ENDING = ".parquet"
#: Start of the names of files that are being written. A worker that was killed leaves one behind.
_UNFINISHED = ".unfinished-"


def write_row(row: dict[str, Any], tables: str | os.PathLike[str]) -> None:
    """Writes a row into its file in a folder. It is written under another name, and renamed: no reader ever sees a part of it.

    Raises:
      OSError: where the folder cannot be written.
    """
    table = pa.Table.from_batches([batch_of([row])])
    system, folder = _folder_of(tables)
    final = f"{folder}/{key_of(row)}{_ENDING}"
    unfinished = f"{folder}/{_UNFINISHED}{uuid.uuid4().hex}"
    try:
        with system.open_output_stream(unfinished) as stream:
            pq.write_table(table, stream, compression="snappy")
        system.move(unfinished, final)
    except BaseException:
        with contextlib.suppress(OSError):
            system.delete_file(unfinished)
        raise


def missing_keys(keys: Iterable[str], tables: str | os.PathLike[str]) -> list[str]:
    """Returns those of the wanted keys that have no file yet. An empty file, which a machine without power may leave, is none."""
    system, folder = _folder_of(tables)
    wanted = list(keys)
    found = system.get_file_info([f"{folder}/{key}{_ENDING}" for key in wanted])
    return [key for key, info in zip(wanted, found) if info.type != fs.FileType.File or info.size == 0]


def read_tables(tables: str | os.PathLike[str]) -> pa.Table:
    """Reads all rows of a folder, sorted by their keys: the same table however, wherever and in which order they were made.

    Raises:
      OSError: where a file cannot be read.
    """
    system, folder = _folder_of(tables)
    infos = system.get_file_info(fs.FileSelector(folder, allow_not_found=True))
    names = sorted(info.path for info in infos if info.base_name.endswith(_ENDING) and not info.base_name.startswith("."))
    rows = [pq.read_table(name, filesystem=system, schema=SCHEMA) for name in names]
    table = pa.concat_tables(rows) if rows else SCHEMA.empty_table()
    return table.sort_by([(column, "ascending") for column in KEY]).combine_chunks()


def _folder_of(tables: str | os.PathLike[str]) -> tuple[fs.FileSystem, str]:
    """Opens the folder of tables, which is there afterwards."""
    system, folder = opened(tables)
    system.create_dir(folder, recursive=True)
    return system, folder
