"""Poses of recordings."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Literal, TypedDict

from . import _native

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["TagSettings", "tag"]


class TagSettings(TypedDict, total=False):
    """Settings of the particle filter, by the names of the program's options; what is left out has the program's default."""

    #: Observation model, which weighs the particles.
    observation: Literal["gauss", "distance", "contrast"]
    #: Number of particles; with ``adaptive``, the largest one.
    particles: int
    #: Iterations of weighing and resampling for each picture.
    iterations: int
    resampling: Literal["residual", "systematic", "stratified", "multinomial"]
    estimator: str
    #: Whether the number of particles adapts to their spread.
    adaptive: bool
    #: Whether the whole recording counts for every pose.
    smooth: bool
    #: The same seed gives the same poses.
    seed: int
    #: Standard deviation of the picture's Gaussian blur.
    blur_px: float
    #: The paper's alpha.
    alpha: float
    #: Whether what lies outside the field's border is masked.
    border_mask: bool
    odometry: bool
    #: Whether the field is searched when the pose is lost.
    recovery: bool
    #: Whether the start that the recording gives is used.
    known_start: bool
    #: Whether covariances contain the calibration's errors.
    calibration_errors: bool


def tag(recording: str | os.PathLike[str], **settings: Unpack[TagSettings]) -> _native.Tags:
    """Finds the camera pose of every picture of a recording by particle filter, on the processor. The interpreter is released meanwhile.

    >>> tags = reality_sim.tag("walk", particles=400, smooth=True)
    >>> tags.poses  # N x 6: x, y, yaw, height, pitch and roll

    Raises:
      reality_sim.Error: where the recording cannot be read.
      ValueError: for settings that there are not.
    """
    return _native.tag(recording, json.dumps(settings))
