"""What the documentation shows works as it stands there."""

import os
import re
from pathlib import Path

import pytest

os.environ.setdefault("MUJOCO_GL", "osmesa")
ROOT = Path(__file__).parents[3]


def test_the_code_of_the_documentation_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "assets").symlink_to(ROOT / "assets")
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / "python.md").read_text(), re.DOTALL | re.MULTILINE)
    assert len(blocks) >= 4
    names: dict = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)  # noqa: S102
    assert names["picture"].shape == (480, 640, 3)


def test_stubs_name_what_there_is() -> None:
    """Every class and function of the native part is in its stub, with all of its members, and the other way round."""
    import ast

    from reality_sim import _native

    stub = ast.parse((Path(_native.__file__).parent / "_native.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
    constants = {"VERSION", "NO_OBJECT"}
    native = {name for name in dir(_native) if not name.startswith("__")}
    assert native == set(classes) | functions | constants
    for name, node in classes.items():
        members = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        members |= {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
        present = {member for member in vars(getattr(_native, name)) if not member.startswith("__")}
        assert {member for member in members if not member.startswith("__")} == present, name
