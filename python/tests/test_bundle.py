"""``reenact.Bundle``: frames, figures and what a notebook shows."""

from __future__ import annotations

import csv
import io
import json
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest

import reenact
from conftest import PUBLISHED


def rows_of(bundle: reenact.Bundle, path: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(bundle.read(path).decode())))


def test_trials_are_as_the_data_dictionary_says_in_both_libraries(published: reenact.Bundle) -> None:
    rows = rows_of(published, "results/trials.csv")
    pandas, polars = published.trials("pandas"), published.trials("polars")
    assert len(rows) == 20 and type(pandas).__module__.startswith("pandas") and type(polars).__module__.startswith("polars")
    fields = published.dictionary["results/trials.csv"]["schema"]["fields"]
    assert list(pandas.columns) == polars.columns == [field["name"] for field in fields]
    for field in fields:
        name, told = field["name"], [row[field["name"]] for row in rows]
        # Not one digit is lost, and no word is taken for a number or for nothing.
        of = {"string": str, "integer": int, "number": float}[field["type"]]
        want: list[Any] = [of(text) if text else None for text in told]
        assert polars[name].to_list() == want, name
        column = pandas[name]
        assert [None if missing else of(value) for value, missing in zip(column, column.isna())] == want, name
    assert set(pandas["prior"]) == {"none", "floor-plan"}


def test_curves_tables_and_claims(published: reenact.Bundle) -> None:
    series = published.series()
    assert len(series) == len(rows_of(published, "results/series.csv"))
    assert set(series["key"]) == set(published.trials()["key"])
    assert list(published.tables) == ["table-1", "table-2"] and len(published.tables) == 2
    assert list(published.tables["table-1"]["coverage-percent"].unique()) == [70, 80, 90, 95]
    with pytest.raises(KeyError, match="table-9: expected one of table-1, table-2"):
        published.tables["table-9"]
    # Nothing is claimed of the quickstart; whoever asks for verdicts finds their columns.
    assert len(published.claims) == 0 and "verdict" in published.claims.columns
    assert len(published.comparisons) == 0 and "p-for" in published.comparisons.columns


def test_curves_come_from_the_records_where_no_table_has_them(published: reenact.Bundle) -> None:
    told = published._archive.series()
    assert told is not None and told.encode() == published.read("results/series.csv")


def test_a_study_without_curves_says_so(place: Path, command: Any) -> None:
    wander = Path(PUBLISHED).parents[1] / "manifests" / "wander.yaml"
    run = reenact.run(wander, trials=1)
    with pytest.raises(reenact.NotUnderstood) as none:
        run.bundle.series()
    assert str(none.value) == "error: the study of `wander` records no curves"


def test_figures_and_what_a_notebook_shows(published: reenact.Bundle, place: Path) -> None:
    figure = published.figures["figure-4"]
    assert figure._repr_svg_().encode() == published.read("results/figures/figure-4.svg")
    figure.save("figure.svg")
    assert Path("figure.svg").read_bytes() == published.read("results/figures/figure-4.svg")
    html = published._repr_html_()
    assert html.startswith(f"<div><h3>{published.title}</h3><p>{published.finding}</p>")
    assert published.results_digest in html and html.count("data:image/svg+xml;base64,") == 1
    # The same sentence as on the bundle's own page; of a study without claims a report says beside it what changes against the baseline.
    sealed, _, beside = published.finding.partition("; against no prior, ")
    assert beside.startswith("distance travelled (m) changes by ") and beside.endswith(" %).")
    assert f'<p class="finding">{sealed}.</p>' in published.read("index.html").decode()


def test_what_it_is_and_what_is_in_it(published: reenact.Bundle) -> None:
    with zipfile.ZipFile(PUBLISHED) as archive:
        sizes = {info.filename.partition("/data/")[2]: info.file_size for info in archive.infolist()}
    assert published.files == {path: size for path, size in sorted(sizes.items()) if path}
    assert published.holds and published.checked.startswith("checked to level 1 (fixity): ")
    study = json.loads(published.read("study.resolved.json"))
    assert (published.name, published.engine, published.partial) == (study["name"], study["engine"], study["partial"])
    assert len(published.trial_names) == 20 and published.trial_names[0] == "none/0"
    with pytest.raises(reenact.NotUnderstood) as missing:
        published.read("results/none.csv")
    assert str(missing.value) == "error: the bundle has no file `results/none.csv`; `files` lists those that it has"


def test_what_to_install_is_said_where_a_library_is_missing(
    published: reenact.Bundle, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    assert type(published.trials()).__module__.startswith("polars"), "the other one is taken"
    with pytest.raises(reenact.NotUnderstood) as missing:
        published.trials("pandas")
    assert str(missing.value) == "pandas is not installed: pip install pandas"
    monkeypatch.setitem(sys.modules, "polars", None)
    with pytest.raises(reenact.NotUnderstood) as missing:
        published.trials()
    expected = "a data frame needs pandas or polars, and neither is installed: pip install pandas"
    assert str(missing.value) == expected
    monkeypatch.setitem(sys.modules, "numpy", None)
    with pytest.raises(reenact.NotUnderstood) as missing:
        published.replay("none/0")
    assert str(missing.value) == "a replay is arrays of numpy, which is not installed: pip install numpy"
