"""Tables of a bundle as data frames, with the types that its data dictionary states."""

from __future__ import annotations

import importlib
import io
from typing import Any, Literal, Mapping, Optional, Sequence

from reenact._errors import NotUnderstood

#: A library of data frames: ``"pandas"`` or ``"polars"``.
Library = Literal["pandas", "polars"]
LIBRARIES: Sequence[Library] = ("pandas", "polars")

#: A column of a Table Schema, as far as it matters here: its name, its type, and whether it has a value in every row.
Field = tuple[str, str, bool]


def fields(resource: Mapping[str, Any]) -> list[Field]:
    """Returns the columns of a resource of ``datapackage.json``."""
    return [
        (field["name"], field["type"], bool(field.get("constraints", {}).get("required")))
        for field in resource["schema"]["fields"]
    ]


def read_csv(data: bytes, columns: Sequence[Field], library: Optional[Library]) -> Any:
    """Returns the frame of `library`, or of the first that is installed."""
    if library is not None and library not in LIBRARIES:
        raise NotUnderstood(f"expected frames of 'pandas' or 'polars', found {library!r}")
    for name in LIBRARIES if library is None else (library,):
        try:
            found = importlib.import_module(name)
        except ModuleNotFoundError as missing:
            if missing.name != name:
                raise
            continue
        return _pandas(found, data, columns) if name == "pandas" else _polars(found, data, columns)
    if library is None:
        raise NotUnderstood("a data frame needs pandas or polars, and neither is installed: pip install pandas")
    raise NotUnderstood(f"{library} is not installed: pip install {library}")


def _pandas(pandas: Any, data: bytes, columns: Sequence[Field]) -> Any:
    # A column of whole numbers with gaps has a type of its own; words stay words, also those that pandas takes for no value.
    # By type: where every row has a value, and where some have none.
    types = {
        "string": ("str", "str"),
        "integer": ("int64", "Int64"),
        "number": ("float64", "float64"),
        "boolean": ("bool", "boolean"),
    }
    dtype = {name: types[kind][0 if required else 1] for name, kind, required in columns}
    # Every digit counts, which goes without saying from pandas 3 on.
    exact = {"float_precision": "round_trip"} if int(pandas.__version__.split(".")[0]) < 3 else {}
    return pandas.read_csv(io.BytesIO(data), dtype=dtype, keep_default_na=False, na_values=[""], **exact)


def _polars(polars: Any, data: bytes, columns: Sequence[Field]) -> Any:
    types = {"string": polars.String, "integer": polars.Int64, "number": polars.Float64, "boolean": polars.Boolean}
    return polars.read_csv(io.BytesIO(data), schema_overrides={name: types[kind] for name, kind, _ in columns})
