"""Recorded pictures for robot simulators: what does the camera see at this pose?

A database holds pictures that a robot recorded while it walked over a soccer field, each with the pose of its camera.
Where no picture was recorded, one is reconstructed from its neighbours:

>>> database = reality_sim.Database("walk.db")
>>> picture = database.render((-2.3, 0.2, 1.6))  # uint8, rows x columns x 3

Metres, radians and seconds everywhere. The world has its origin at the field's centre, x towards the opponent's goal, y left and z up.
A pose is ``(x_m, y_m, yaw_rad)``, or these and ``height_m, pitch_rad, roll_rad`` of the camera: pitch is positive downwards,
roll is positive clockwise as seen from behind the camera.
"""

from typing import TYPE_CHECKING, Any

from ._native import (
    NO_OBJECT,
    VERSION as __version__,
    Ball,
    Cube,
    Database,
    Error,
    Frame,
    FrameLabels,
    Humanoid,
    Layer,
    Lens,
    NoPicture,
    Renderer,
    SeenObject,
    TagErrors,
    Tags,
    build,
)
from .comparison import GapReport, GapSettings, gap
from .datasets import Dataset, DatasetSettings, dataset
from .tagging import TagSettings, tag

if TYPE_CHECKING:
    from .studies import study

__all__ = [
    "NO_OBJECT",
    "Ball",
    "Cube",
    "Database",
    "Dataset",
    "DatasetSettings",
    "Error",
    "Frame",
    "FrameLabels",
    "GapReport",
    "GapSettings",
    "Humanoid",
    "Layer",
    "Lens",
    "NoPicture",
    "Renderer",
    "SeenObject",
    "TagErrors",
    "TagSettings",
    "Tags",
    "__version__",
    "build",
    "dataset",
    "gap",
    "study",
    "tag",
]


def __getattr__(name: str) -> Any:
    # pyarrow is loaded where it is needed only: that takes longer than all of this.
    if name == "study":
        from .studies import study

        return study
    raise AttributeError(f"module {__name__} has no attribute {name}")
