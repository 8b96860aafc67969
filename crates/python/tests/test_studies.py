"""Studies of many recordings: rows, tables, and what happens when something breaks."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import WALK

import reality_sim

pa = pytest.importorskip("pyarrow")

from pyarrow import fs, parquet  # noqa: E402

from reality_sim import studies  # noqa: E402

#: Settings with which a recording of ten pictures takes a tenth of a second.
FEW = {"job": "tag", "particles": 60, "iterations": 2}
SETTINGS = [FEW, FEW | {"seed": 1}, FEW | {"observation": "distance"}]


def recording(folder: Path, first: int, count: int = 10) -> Path:
    """Makes a recording of some pictures of the walk."""
    folder.mkdir(parents=True)
    for name in ("sequence.toml", "camera.toml", "field.toml", "groundtruth.tum"):
        shutil.copy(WALK / name, folder)
    header, *rows = (WALK / "frames.csv").read_text().splitlines()
    rows = rows[first : first + count]
    (folder / "frames.csv").write_text("\n".join([header, *rows]) + "\n")
    for row in rows:
        picture = row.split(",")[1]
        (folder / picture).parent.mkdir(exist_ok=True)
        shutil.copy(WALK / picture, folder / picture)
    # The start is that of the whole walk.
    text = (folder / "sequence.toml").read_text()
    (folder / "sequence.toml").write_text(text[: text.index("[start]")] + 'robot = "nao"\nrecorded_on = 2026-05-31\n')
    return folder


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("recordings")
    return [recording(folder / f"part{first}", first) for first in range(0, 40, 10)]


@pytest.fixture(scope="module")
def settings_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("settings") / "settings.json"
    file.write_text(json.dumps(SETTINGS))
    return file


@pytest.fixture(scope="module")
def undisturbed(recordings: list[Path], tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Returns the bytes of the table that a plain loop makes."""
    tables = tmp_path_factory.mktemp("undisturbed")
    worker = studies.StudyWorker(SETTINGS, tables)
    told = [worker.study_one(one) for one in recordings]
    assert [one["written"] for one in told] == [len(SETTINGS)] * len(recordings)
    return bytes_of(tables)


def bytes_of(tables: Path) -> bytes:
    sink = pa.BufferOutputStream()
    parquet.write_table(studies.read_tables(tables), sink)
    return sink.getvalue().to_pybytes()


def command(recordings: list[Path], settings_file: Path, out: Path, *options: str) -> list[str]:
    many = [str(one) for one in recordings]
    return [sys.executable, "-m", "reality_sim.studies", *many, "--settings", str(settings_file), "--out", str(out), *options]


def test_a_row_tells_what_was_found_and_what_it_was_found_with() -> None:
    batch = reality_sim.study(WALK, {"job": "tag"})
    assert isinstance(batch, pa.RecordBatch) and batch.schema == studies.SCHEMA
    (row,) = batch.to_pylist()
    tags = reality_sim.tag(WALK)
    assert row["error"] is None and row["job"] == "tag" and row["version"].startswith(f"{reality_sim.__version__}+")
    assert row["name"] == "walk" and row["robot"] is None and row["day"] is None
    assert row["frames"] == 60 and row["mean_m"] == tags.error.mean_m and row["gap_before"] is None
    assert json.loads(row["settings_json"])["particles"] == 800
    assert row["picture"].startswith(b"\xff\xd8") and len(row["picture"]) < 30_000
    report = json.loads(row["report"])
    assert sum(place["pictures"] for place in report["places"]) == 60
    assert report["verdict"] == tags.verdict


def test_one_recording_is_studied_with_many_settings_in_their_order() -> None:
    pitch = WALK.parent / "pitch"
    settings = [{"job": "gap"}, FEW, {"job": "evaluate", "every": 20}, {"job": "gap", "without": ["mount_pitch"]}]
    gap, tag, evaluate, without = reality_sim.study(pitch, settings).to_pylist()
    assert [row["job"] for row in (gap, tag, evaluate, without)] == ["gap", "tag", "evaluate", "gap"]
    assert not any(row["error"] for row in (gap, tag, evaluate, without))
    effects = [effect["id"] for effect in json.loads(gap["report"])["effects"]]
    assert effects == ["mount_pitch"] and gap["gap_after"] < gap["gap_before"]
    assert "mount_pitch" not in json.loads(without["report"])["effects"]
    assert evaluate["probes"] + evaluate["images"] == tag["frames"]
    assert evaluate["plane_psnr_field_db"] > 15 and evaluate["plane_answered"] > 0.5


def test_pictures_with_labels_are_made_of_each_recording(recordings: list[Path], tmp_path: Path) -> None:
    settings = {"job": "dataset", "out": str(tmp_path), "best_effort": True, "dataset": {"count": 2, "seed": 3}}
    rows = [reality_sim.study(one, settings).to_pylist()[0] for one in recordings[:2]]
    for row, one in zip(rows, recordings):
        assert row["error"] is None and (row["pictures"], row["images"]) == (2, 10)
        folder = Path(json.loads(row["report"])["folder"])
        assert folder == tmp_path / studies.key_of(row) and row["recording"] == studies.hash_of(one)
        assert len(json.loads((folder / "annotations.json").read_text())["images"]) == 2
    # What is there counts, and is the same row.
    assert reality_sim.study(recordings[0], settings).to_pylist() == rows[:1]
    other = settings | {"dataset": {"count": 2, "seed": 4}}
    (another,) = reality_sim.study(recordings[0], other).to_pylist()
    assert another["error"] is None and len(list(tmp_path.iterdir())) == 3


def test_the_key_is_that_of_the_content(recordings: list[Path], tmp_path: Path) -> None:
    moved = shutil.copytree(recordings[0], tmp_path / "elsewhere")
    assert studies.hash_of(moved) == studies.hash_of(recordings[0]) != studies.hash_of(recordings[1])
    (moved / ".DS_Store").write_text("no part of it")
    assert studies.hash_of(moved) == studies.hash_of(recordings[0])
    picture = next((moved / "images").iterdir())
    picture.write_bytes(picture.read_bytes() + b"\0")
    assert studies.hash_of(moved) != studies.hash_of(recordings[0])

    def hash_of_settings(settings: dict) -> str:
        return studies.study(recordings[0], settings).column("settings")[0].as_py()

    # Default values may be told or not, in any order.
    assert hash_of_settings(FEW) == hash_of_settings({"seed": 0, "iterations": 2, "particles": 60, "job": "tag"})
    assert hash_of_settings(FEW) != hash_of_settings(FEW | {"seed": 1})
    # A file counts by what is in it.
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).write_text("")
    with_model = [hash_of_settings({"job": "gap", "model": str(tmp_path / name)}) for name in ("a.toml", "b.toml")]
    assert with_model[0] == with_model[1]
    (tmp_path / "b.toml").write_text("# other\n")
    assert hash_of_settings({"job": "gap", "model": str(tmp_path / "b.toml")}) != with_model[0]


def test_errors_are_rows(recordings: list[Path], tmp_path: Path) -> None:
    broken = shutil.copytree(recordings[0], tmp_path / "broken")
    pictures = sorted((broken / "images").iterdir())
    pictures[3].write_bytes(pictures[3].read_bytes()[:1000])
    no_field = shutil.copytree(recordings[0], tmp_path / "no_field")
    (no_field / "field.toml").unlink()
    for where, words in [
        (tmp_path / "missing", "there is no such folder"),
        ("nowhere://bucket/walk", "nowhere"),
        (tmp_path, "sequence.toml"),
        (no_field, "field.toml"),
        (broken, pictures[3].name),
    ]:
        rows = reality_sim.study(where, SETTINGS).to_pylist()
        assert len(rows) == len(SETTINGS)
        for row in rows:
            assert words in row["error"] and row["frames"] is None and row["settings"], where
    settings = [{"job": "tag", "particels": 3}, {}, {"job": "dance"}, {"job": "gap", "model": "none.toml"}, FEW]
    *wrong, right = reality_sim.study(recordings[0], settings).to_pylist()
    for row, words in zip(wrong, ["particels", "job", "dance", "none.toml"]):
        assert words in row["error"], row["error"]
    assert right["error"] is None and right["frames"] == 10


def test_what_is_no_settings_is_a_row(recordings: list[Path]) -> None:
    for given in (["tag"], "tag", None, [5], [{1: 2}], {"job": "tag", 1: 2}):
        rows = reality_sim.study(recordings[0], given).to_pylist()
        assert len(rows) == 1 and rows[0]["error"] and rows[0]["settings"], given


def test_pictures_behind_a_link_count(recordings: list[Path], tmp_path: Path) -> None:
    copy = shutil.copytree(recordings[0], tmp_path / "copy")
    (copy / "images").rename(tmp_path / "elsewhere")
    (copy / "images").symlink_to(tmp_path / "elsewhere")
    (copy / "itself").symlink_to(copy)

    def key() -> str:
        return reality_sim.study(copy, FEW).to_pylist()[0]["recording"]

    assert key() == reality_sim.study(recordings[0], FEW).to_pylist()[0]["recording"]
    before = key()
    picture = next((tmp_path / "elsewhere").iterdir())
    picture.write_bytes(picture.read_bytes() + b"\0")
    assert key() != before


def test_a_machine_that_fails_one_job_keeps_the_rows_of_the_others(recordings: list[Path], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    failing = {"job": "dataset", "out": str(tmp_path / "file" / "pictures"), "dataset": {"count": 1}, "best_effort": True}
    told = studies.StudyWorker([failing, FEW], tmp_path / "tables").study_one(recordings[0])
    assert told["error"] and told["written"] == 1, told
    assert studies.read_tables(tmp_path / "tables").column("job").to_pylist() == ["tag"]
    # Without tables they are rows, of which one is no recording's.
    failed, tag = reality_sim.study(recordings[0], [failing, FEW]).to_pylist()
    assert failed["error"] and failed["recording"] == ""
    assert tag["error"] is None and tag["recording"] == studies.hash_of(recordings[0])


def test_a_database_that_cannot_be_written_is_the_machines_fault(recordings: list[Path], tmp_path: Path) -> None:
    # No file may be larger than what a database begins with, as on a full disk.
    script = f"""
import resource, signal
from reality_sim import studies

signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
worker = studies.StudyWorker([{{"job": "evaluate"}}, {{"job": "tag", "particles": 60, "iterations": 2}}], {str(tmp_path)!r})
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
told = worker.study_one({str(recordings[0])!r})
assert told["written"] == 1 and "recording.db" in told["error"], told
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert studies.read_tables(tmp_path).column("job").to_pylist() == ["tag"]


def test_a_message_is_the_same_wherever_the_recording_lies(recordings: list[Path], tmp_path: Path) -> None:
    rows = []
    for where in ("here", "elsewhere"):
        broken = shutil.copytree(recordings[0], tmp_path / where)
        picture = min((broken / "images").iterdir())
        picture.write_bytes(picture.read_bytes()[:1000])
        settings = [{"job": "tag"}, {"job": "gap"}, {"job": "evaluate"}, {"job": "dataset", "out": str(tmp_path / "pictures")}]
        rows.append(reality_sim.study(broken, settings).to_pylist())
    assert rows[0] == rows[1]
    assert all(row["error"] and "here" not in row["error"] for row in rows[0])


def test_ctrl_c_ends_a_long_study(tmp_path: Path) -> None:
    script = f"""
import _thread, threading, time, reality_sim

threading.Timer(1.0, _thread.interrupt_main).start()
try:
    reality_sim.tag({str(WALK)!r}, particles=200_000)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=300)
    assert done.stdout == "interrupted\n" and done.returncode == 0, done.stderr


def test_an_empty_file_is_no_row(recordings: list[Path], tmp_path: Path) -> None:
    worker = studies.StudyWorker(FEW, tmp_path)
    assert worker.study_one(recordings[0])["written"] == 1
    (file,) = tmp_path.glob("*.parquet")
    whole = file.read_bytes()
    file.write_bytes(b"")
    assert worker.study_one(recordings[0])["written"] == 1 and file.read_bytes() == whole


def test_tables_that_cannot_be_written_are_told(recordings: list[Path], tmp_path: Path) -> None:
    worker = studies.StudyWorker(FEW, tmp_path / "tables")
    (tmp_path / "tables").write_text("no folder")
    told = worker.study_one(recordings[0])
    assert told["error"] and told["written"] == 0


def test_what_is_there_is_not_done_again(recordings: list[Path], undisturbed: bytes, tmp_path: Path) -> None:
    worker = studies.StudyWorker(SETTINGS, tmp_path)
    for one in recordings:
        worker.study_one(one)
    assert {worker.study_one(one)["written"] for one in recordings} == {0}
    files = sorted(tmp_path.glob("*.parquet"))
    assert len(files) == len(recordings) * len(SETTINGS)
    files[0].unlink()
    # What a killed worker leaves is no row.
    (tmp_path / ".unfinished-0").write_bytes(files[1].read_bytes()[:100])
    assert sum(worker.study_one(one)["written"] for one in recordings) == 1
    assert bytes_of(tmp_path) == undisturbed
    # A recording that is not there has no row: it may come.
    told = worker.study_one(tmp_path / "missing")
    assert told["written"] == 0 and "no such folder" in told["error"]
    assert bytes_of(tmp_path) == undisturbed


def test_other_file_systems_are_read_and_written(
    recordings: list[Path], undisturbed: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def opened(address: str) -> tuple[fs.FileSystem, str]:
        """Opens a file system that is not this machine's, as far as anybody can tell."""
        base, path = address.removeprefix("bucket://").split("/", 1)
        root = recordings[0].parent if base == "recordings" else tmp_path
        return fs.SubTreeFileSystem(str(root), fs.LocalFileSystem()), path

    for part in ("recordings", "tables"):
        monkeypatch.setattr(f"reality_sim.studies.{part}.opened", opened)
    worker = studies.StudyWorker(SETTINGS, "bucket://tables/of/walks")
    told = [worker.study_one(f"bucket://recordings/{one.name}") for one in recordings]
    assert {one["written"] for one in told} == {len(SETTINGS)}
    monkeypatch.undo()
    assert bytes_of(tmp_path / "of" / "walks") == undisturbed


@pytest.mark.parametrize("options", [("--threads", "1"), ("--processes", "2")], ids=["loop", "processes"])
def test_shell_and_processes_make_the_same_table(
    recordings: list[Path], settings_file: Path, undisturbed: bytes, tmp_path: Path, options: tuple[str, ...]
) -> None:
    done = subprocess.run(command(recordings, settings_file, tmp_path, *options), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("3 written, 0 there already") == len(recordings)
    assert bytes_of(tmp_path) == undisturbed


def test_a_program_that_is_killed_again_and_again_gets_there(
    recordings: list[Path], settings_file: Path, undisturbed: bytes, tmp_path: Path
) -> None:
    for kills in range(100):
        process = subprocess.Popen(
            command(recordings, settings_file, tmp_path, "--threads", "1"), stdout=subprocess.PIPE, start_new_session=True
        )
        before = len(list(tmp_path.glob("*.parquet")))
        # Three kills, each as soon as something new is there; then it may end.
        while process.poll() is None and (kills >= 3 or len(list(tmp_path.glob("*.parquet"))) == before):
            time.sleep(0.002)
        if process.poll() is not None:
            break
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    assert process.returncode == 0 and kills >= 1
    assert bytes_of(tmp_path) == undisturbed


def test_wrong_usage_is_told(recordings: list[Path], settings_file: Path, tmp_path: Path) -> None:
    missing = subprocess.run(
        command([*recordings[:1], tmp_path / "missing"], settings_file, tmp_path / "out"), capture_output=True, text=True
    )
    assert missing.returncode == 1 and "there is no such folder" in missing.stderr and "3 written" in missing.stdout
    (tmp_path / "bad.json").write_text("{")
    bad = subprocess.run(command(recordings, tmp_path / "bad.json", tmp_path / "out"), capture_output=True, text=True)
    assert bad.returncode == 1 and "bad.json" in bad.stderr and "Traceback" not in bad.stderr
