"""Addresses: folders of this machine, or of any file system that pyarrow opens."""

from __future__ import annotations

import os

from pyarrow import fs

__all__ = ["opened"]


def opened(address: str | os.PathLike[str]) -> tuple[fs.FileSystem, str]:
    """Returns the file system of an address, and the path within it. Nothing need be there.

    Raises:
      ValueError: where no file system has such addresses.
      OSError: where it cannot be reached.
    """
    text = os.fspath(address)
    if "://" in text:
        return fs.FileSystem.from_uri(text)
    return fs.LocalFileSystem(), os.path.abspath(text)
