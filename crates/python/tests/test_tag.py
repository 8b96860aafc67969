"""Poses of recordings."""

from pathlib import Path

import numpy as np
import pytest
from conftest import WALK

import reality_sim


@pytest.fixture(scope="module")
def truth() -> np.ndarray:
    """Returns time, x and y of the recording's true poses."""
    return np.loadtxt(WALK / "groundtruth.tum", usecols=(0, 1, 2))


def test_poses_are_the_true_ones(truth: np.ndarray) -> None:
    tags = reality_sim.tag(WALK)
    places = np.stack([np.interp(tags.timestamps_s, truth[:, 0], truth[:, axis]) for axis in (1, 2)], axis=1)
    errors = np.linalg.norm(tags.poses[:, :2] - places, axis=1)
    assert len(errors) == 60 and errors.max() < 0.1
    assert tags.error.mean_m == pytest.approx(errors.mean(), abs=1e-3) and tags.error.lost_frames == 0
    assert tags.is_sure.all() and tags.completeness == 1 and tags.lines_within_5px > 0.9
    fitted = np.isfinite(tags.covariances).all(axis=(1, 2))
    assert fitted.any()
    assert (np.linalg.eigvalsh(tags.covariances[fitted]) > 0).all()


def test_settings_are_those_of_the_program() -> None:
    few = reality_sim.tag(WALK, observation="distance", particles=100, seed=3)
    again = reality_sim.tag(WALK, observation="distance", particles=100, seed=3)
    other = reality_sim.tag(WALK, observation="distance", particles=100, seed=4)
    assert np.array_equal(few.poses, again.poses) and not np.array_equal(few.poses, other.poses)
    with pytest.raises(ValueError, match="particels"):
        reality_sim.tag(WALK, particels=100)
    with pytest.raises(ValueError, match="gaus"):
        reality_sim.tag(WALK, observation="gaus")


def test_what_is_no_recording_is_named(tmp_path: Path) -> None:
    with pytest.raises(reality_sim.Error, match="sequence.toml"):
        reality_sim.tag(tmp_path)
