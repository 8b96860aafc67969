"""Studies by Ray Data, on one machine with two actors."""

from pathlib import Path

import pytest
from test_studies import FEW, SETTINGS, bytes_of, recording, recordings, undisturbed  # noqa: F401

from reality_sim import studies

ray = pytest.importorskip("ray")
import ray.data  # noqa: E402


@pytest.fixture(scope="module")
def engine():
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield
    ray.shutdown()


def run(recordings: list[Path], tables: Path) -> list[dict]:
    uris = ray.data.from_items([{"uri": str(one)} for one in recordings], override_num_blocks=len(recordings))
    told = uris.map_batches(
        studies.StudyWorker,
        fn_constructor_kwargs={"settings": SETTINGS, "tables": str(tables), "threads": 1},
        batch_size=1,
        batch_format="pyarrow",
        num_cpus=1,
        concurrency=2,
    )
    return told.take_all()


def test_ray_makes_the_same_table(engine: None, recordings: list[Path], undisturbed: bytes, tmp_path: Path) -> None:  # noqa: F811
    told = run([*recordings, tmp_path / "missing"], tmp_path / "tables")
    assert sorted(one["written"] for one in told) == [0, 3, 3, 3, 3]
    assert [one["uri"] for one in told if one["error"]] == [str(tmp_path / "missing")]
    assert bytes_of(tmp_path / "tables") == undisturbed
