"""Data sets: pictures at random poses with labels."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from . import _native

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["Dataset", "DatasetSettings", "dataset"]


class DatasetSettings(TypedDict, total=False):
    """Settings of a data set, by the names of the program's options; what is left out has the program's default."""

    #: Number of pictures: 100 if it is left out.
    count: int
    #: Seed of poses and things; a picture depends on the seed and its number alone.
    seed: int
    #: Method by which the pictures are made.
    method: Literal["auto", "plane", "blend"]
    #: Largest distance of the nearest recorded picture, root mean square pixels.
    within: float
    #: Number of balls in a picture, as ``"MIN..MAX"``, or one number as text.
    balls: str
    #: Number of robots in a picture, as ``"MIN..MAX"``, or one number as text.
    robots: str
    #: Format of the pictures.
    format: Literal["jpg", "png"]
    #: Whether the distance of every pixel, millimetres, is written, as 16-bit pictures.
    depth: bool
    #: Whether it is written which thing every pixel shows, as 16-bit pictures.
    instances: bool
    #: Whether it is written how far every pixel can be trusted, as 8-bit pictures.
    trust: bool


@dataclass(frozen=True)
class Dataset:
    """Data set that is whole."""

    folder: Path
    #: Number of pictures.
    pictures: int
    #: Number of pictures that this call made.
    written: int
    #: Number of pictures that an earlier call had made.
    skipped: int
    #: Number of annotations of all pictures.
    annotations: int

    def coco(self) -> dict[str, Any]:
        """Returns the contents of annotations.json: COCO's keys, and those that it does not know."""
        return json.loads((self.folder / "annotations.json").read_text())


def dataset(database: _native.Database, out: str | os.PathLike[str], **settings: Unpack[DatasetSettings]) -> Dataset:
    """Makes pictures at random poses with balls, robots and labels into a folder; one that was begun with the same settings is completed.

    >>> made = reality_sim.dataset(database, "pictures", count=1000, seed=7, depth=True)
    >>> made.coco()["images"][0]["file_name"]

    Raises:
      reality_sim.Error: where the folder holds something else, or no pictures can be made.
      ValueError: for settings that there are not.
    """
    return Dataset(Path(out), *_native.dataset(database, out, json.dumps(settings)))
