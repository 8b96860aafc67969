"""Recordings by their address: brought to this machine, and told apart by their content."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from pyarrow import fs

from .places import opened

__all__ = ["fetched", "hash_of"]

_BLOCK = 1 << 20


@contextlib.contextmanager
def fetched(uri: str | os.PathLike[str]) -> Iterator[Path]:
    """Brings a recording to this machine, and removes it again at the end if it was not there.

    Raises:
      OSError: where there is no such folder, or it cannot be read.
      ValueError: where no file system has such addresses.
    """
    system, path = opened(uri)
    if isinstance(system, fs.LocalFileSystem):
        if not os.path.isdir(path):
            raise FileNotFoundError(f"{os.fspath(uri)}: there is no such folder")
        yield Path(path)
        return
    with tempfile.TemporaryDirectory(prefix="reality-sim-") as folder:
        fs.copy_files(path, folder, source_filesystem=system)
        yield Path(folder)


def hash_of(path: Path) -> str:
    """Returns the hash of a file, or of all files of a folder with their names: the same wherever they lie (SHA-256).

    Files and folders whose names begin with a dot are no part of a recording; those behind links are.
    """
    if path.is_file():
        return _hash_of_file(path)
    whole = hashlib.sha256()
    for name, file in sorted((file.relative_to(path).as_posix(), file) for file in _files_of(path)):
        whole.update(f"{name}\0{_hash_of_file(file)}\n".encode())
    return whole.hexdigest()


def _files_of(folder: Path, within: frozenset[str] = frozenset()) -> Iterator[Path]:
    """Finds the files of a folder. A link to a folder that it lies in is not followed."""
    real = os.path.realpath(folder)
    if real in within:
        return
    for entry in folder.iterdir():
        if entry.name.startswith("."):
            continue
        if entry.is_dir():
            yield from _files_of(entry, within | {real})
        elif entry.is_file():
            yield entry


def _hash_of_file(file: Path) -> str:
    of_file = hashlib.sha256()
    with file.open("rb") as stream:
        while block := stream.read(_BLOCK):
            of_file.update(block)
    return of_file.hexdigest()
