"""The notebook of the documentation says what it gives.

``python tests/test_notebook.py`` writes its outputs anew; read the difference as its reader would.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

NOTEBOOK = Path(__file__).resolve().parents[2] / "docs" / "python.ipynb"
#: What an output is, without what differs from one execution to the next.
KEPT = ("output_type", "name", "text", "data")


def executed() -> Any:
    """Executes the notebook where it lies, and leaves of it what is the same every time."""
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbclient.NotebookClient(
        notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(NOTEBOOK.parent)}}
    ).execute()
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"file_extension": ".py", "mimetype": "text/x-python", "name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {}
        if cell.cell_type == "code":
            cell.execution_count = None
            for output in cell.outputs:
                for key in set(output) - set(KEPT):
                    del output[key]
                if output.output_type != "stream":
                    output.metadata = {}
                if output.output_type == "execute_result":
                    output.execution_count = None
    return notebook


def test_the_notebook_gives_what_it_shows() -> None:
    shown = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    found = executed()
    for number, (cell, again) in enumerate(zip(shown["cells"], found.cells)):
        if cell["cell_type"] != "code":
            continue
        told = [_joined(output) for output in cell["outputs"]]
        assert [_joined(output) for output in again.outputs] == told, f"cell {number}: {''.join(cell['source'])}"
    assert sum(bool(cell.get("outputs")) for cell in shown["cells"]) >= 5


def _joined(output: Any) -> Any:
    """Returns an output with its texts whole: the format has them as lines, too."""
    data = {kind: "".join(text) for kind, text in output.get("data", {}).items()}
    return output["output_type"], "".join(output.get("text", "")), data


if __name__ == "__main__":
    nbformat = pytest.importorskip("nbformat")
    NOTEBOOK.write_text(nbformat.writes(executed()) + "\n", encoding="utf-8")
