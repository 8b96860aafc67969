"""What the model of a recording's camera lacks."""

import json
from pathlib import Path

import pytest
from conftest import WALK

import reality_sim

PITCH = WALK.parent / "pitch"


def test_the_missing_effect_is_named_and_closes_the_gap(tmp_path: Path) -> None:
    found = reality_sim.gap(PITCH)
    assert found.effects == ["mount_pitch"] and found.report["verdict"] == "named"
    gap = found.report["gap"]
    assert gap["after"] < gap["before"]
    found.write(tmp_path / "report")
    assert json.loads((tmp_path / "report" / "report.json").read_text()) == found.report
    # The model that was found is what is missing: with it, nothing is.
    again = reality_sim.gap(PITCH, model=str(tmp_path / "report" / "model.toml"))
    assert again.effects == [] and again.report["in_model"][0]["id"] == "mount_pitch"
    assert found.summary in found.html.replace("&#160;", " ")


def test_what_cannot_be_compared_is_told() -> None:
    with pytest.raises(reality_sim.Error, match="5 frames"):
        reality_sim.gap(PITCH, frames=(0, 5))
    with pytest.raises(reality_sim.Error, match="gremlins"):
        reality_sim.gap(PITCH, without=["gremlins"])
    with pytest.raises(ValueError, match="sead"):
        reality_sim.gap(PITCH, sead=1)
