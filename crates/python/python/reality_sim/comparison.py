"""Comparison of recordings with models of their cameras."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from . import _native

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["GapReport", "GapSettings", "gap"]


class GapSettings(TypedDict, total=False):
    """Settings of a comparison, by the names of the program's options; what is left out has the program's default."""

    #: File with effects that the simulation has already, a model.toml.
    model: str
    #: First frame, and the one after the last.
    frames: tuple[int, int]
    #: Seed; modulo 4, it chooses which quarter of the frames is held out.
    seed: int
    #: File with poses that were estimated from the pictures.
    poses: str
    #: Whether the filter finds the poses even if the recording has reference poses.
    tag: bool
    #: Names of effects that are left out of the library.
    without: list[str]


@dataclass(frozen=True)
class GapReport:
    """What the model of a recording's camera lacks."""

    #: The contents of the program's report.json: ``verdict``, ``summary``, ``effects``, ``gap``, ...
    report: dict[str, Any] = field(repr=False)
    #: The extended model, for ``model.toml``.
    model: str = field(repr=False)
    #: The report as a page.
    html: str = field(repr=False)

    @property
    def summary(self) -> str:
        """The verdict in words."""
        return self.report["summary"]

    @property
    def effects(self) -> list[str]:
        """Names of the effects that were found, the most certain first."""
        return [effect["id"] for effect in self.report["effects"]]

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Writes report.json, report.html and model.toml into a folder, which is there afterwards."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.toml").write_text(self.model)
        (folder / "report.html").write_text(self.html)
        (folder / "report.json").write_text(json.dumps(self.report, indent=2))


def gap(recording: str | os.PathLike[str], **settings: Unpack[GapSettings]) -> GapReport:
    """Finds where a recording and the model of its camera disagree, names the effect, adds it, and measures what that brings.

    >>> report = reality_sim.gap("pitch")
    >>> report.summary, report.effects
    >>> report.write("report")

    Raises:
      reality_sim.Error: where the recording cannot be read, or does not suffice.
      ValueError: for settings that there are not.
    """
    return GapReport(*_parsed(_native.gap(recording, json.dumps(settings))))


def _parsed(told: tuple[str, str, str]) -> tuple[dict[str, Any], str, str]:
    report, model, html = told
    return json.loads(report), model, html
