"""What the documentation shows works as it stands there."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

os.environ.setdefault("MUJOCO_GL", "osmesa")
ROOT = Path(__file__).parents[3]


def blocks(document: str) -> list[tuple[str, str]]:
    """Reads the code of a document: of each block its language and its text."""
    return re.findall(r"^```(\w+)\n(.*?)^```", (ROOT / "docs" / document).read_text(), re.DOTALL | re.MULTILINE)


def shorten(recording: Path, folder: Path, count: int) -> None:
    """Makes a recording of the first pictures of another."""
    folder.mkdir(parents=True)
    for part in recording.iterdir():
        (folder / part.name).symlink_to(part)
    header, *rows = (recording / "frames.csv").read_text().splitlines()
    (folder / "frames.csv").unlink()
    (folder / "frames.csv").write_text("\n".join([header, *rows[:count]]) + "\n")


def test_the_code_of_the_documentation_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    monkeypatch.chdir(tmp_path)
    python = [text for language, text in blocks("python.md") if language == "python"]
    assert len(python) >= 4
    names: dict = {}
    for text in python:
        exec(compile(text, "docs/python.md", "exec"), names)  # noqa: S102
    assert names["picture"].shape == (480, 640, 3)


@pytest.mark.skipif("REALITY_SIM" not in os.environ, reason="REALITY_SIM, the path of the program, is not set")
def test_all_runners_of_the_documentation_make_the_same_table(tmp_path: Path) -> None:
    """Each block runs as a program of its own, in the order in which they stand there, on 20 pictures of each recording."""
    pytest.importorskip("ray")
    from reality_sim import studies

    for name in ("walk", "pitch"):
        shorten(ROOT / "assets" / name, tmp_path / "assets" / name, 20)
    programs = tmp_path / "programs"
    programs.mkdir()
    (programs / "reality-sim").symlink_to(os.environ["REALITY_SIM"])
    path = f"{programs}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    ways = {"python": [sys.executable, "-c"], "sh": ["sh", "-ec"]}
    for language, text in blocks("scale.md"):
        if "pip install" not in text:
            done = subprocess.run([*ways[language], text], cwd=tmp_path, env={**os.environ, "PATH": path}, capture_output=True, text=True)
            assert done.returncode == 0, f"{text}\n{done.stdout}\n{done.stderr}"
    tables = [studies.read_tables(str(tmp_path / name)) for name in ("by_ray", "by_processes", "by_shell")]
    assert tables[0].num_rows == 4
    assert tables[0].column("error").null_count == 4
    assert all(table.equals(tables[0]) for table in tables)
    assert "<html" in (tmp_path / "summary.html").read_text()


def test_stubs_name_what_there_is() -> None:
    """Every class and function of the native part is in its stub, with all of its members, and the other way round."""
    import ast

    from reality_sim import _native

    stub = ast.parse((Path(_native.__file__).parent / "_native.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
    constants = {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
    native = {name for name in dir(_native) if not name.startswith("__")}
    assert native == set(classes) | functions | constants
    for name, node in classes.items():
        members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        members |= {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
        present = {member for member in vars(getattr(_native, name)) if not member.startswith("__")}
        assert {member for member in members if not member.startswith("__")} == present, name
