"""The demonstration's notebook runs as it stands there, and is kept with its pictures."""

import os
import re
from pathlib import Path

import pytest

os.environ.setdefault("MUJOCO_GL", "osmesa")
DOCS = Path(__file__).parents[3] / "docs"


def pictures(notebook) -> list[list[str]]:
    """Lists of each cell of code the kinds of its pictures."""
    outputs = [cell.outputs for cell in notebook.cells if cell.cell_type == "code"]
    return [[kind for output in cell for kind in output.get("data", {}) if kind.startswith("image/")] for cell in outputs]


def printed(notebook) -> list[str]:
    """Lists the words and numbers that the cells print."""
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    return "".join(output.text for output in outputs if output.output_type == "stream").split()


def same(word: str, other: str) -> bool:
    """Whether two words are the same; numbers need not be to the last digit, which depends on the processor."""
    numbers = [re.findall(r"\d+(?:\.\d+)?", part) for part in (word, other)]
    words = [re.sub(r"\d+(?:\.\d+)?", "0", part) for part in (word, other)]
    return words[0] == words[1] and [*map(float, numbers[0])] == pytest.approx([*map(float, numbers[1])], rel=0.05, abs=0.11)


def test_the_notebook_runs_and_shows_what_it_has() -> None:
    nbformat = pytest.importorskip("nbformat")
    nbclient = pytest.importorskip("nbclient")
    pytest.importorskip("mujoco")
    kept = nbformat.read(DOCS / "demonstration.ipynb", as_version=4)
    made = nbformat.from_dict(kept)
    for cell in made.cells:
        cell.pop("outputs", None)
        if cell.cell_type == "code":
            cell.outputs = []
    nbclient.NotebookClient(made, timeout=600, resources={"metadata": {"path": DOCS}}).execute()
    assert pictures(made) == pictures(kept) and sum(map(len, pictures(made))) == 4
    words = list(zip(printed(made), printed(kept), strict=True))
    assert len(words) > 40
    assert all(same(*pair) for pair in words), words
