"""A database of the recording that comes with the source."""

from pathlib import Path

import pytest

import reality_sim

WALK = Path(__file__).parents[3] / "assets" / "walk"


@pytest.fixture(scope="session")
def database_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("database") / "walk.db"
    assert reality_sim.build([WALK], file) > 0
    return file


@pytest.fixture(scope="session")
def database(database_file: Path) -> reality_sim.Database:
    return reality_sim.Database(database_file)
