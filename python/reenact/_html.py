"""What a notebook shows. Everything that a bundle says is text here, and its figures are pictures: nothing of a stranger's runs."""

from __future__ import annotations

import base64
from html import escape
from typing import TYPE_CHECKING, Any, Mapping, Sequence

if TYPE_CHECKING:
    from reenact._bundle import Bundle

#: As the bundle's own page has them.
_MARKS = {"supported": "✓", "contradicted": "✗", "inconclusive": "○", "cannot-be-tested": "–"}


def figure(name: str, svg: str) -> str:
    """Returns a figure as a picture."""
    data = base64.b64encode(svg.encode()).decode()
    picture = f'<img alt="{escape(name)}" style="max-width:100%;background:#fff" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{picture}<figcaption>{escape(name)}</figcaption></figure>"


def table(head: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Returns a table of texts."""

    def line(cell: str, texts: Sequence[Any]) -> str:
        cells = (f'<{cell} style="text-align:left">{escape(str(text))}</{cell}>' for text in texts)
        return f"<tr>{''.join(cells)}</tr>"

    return f"<table><thead>{line('th', head)}</thead><tbody>{''.join(line('td', row) for row in rows)}</tbody></table>"


def bundle(shown: Bundle, claims: Sequence[Mapping[str, str]], figures: Mapping[str, str]) -> str:
    """Returns finding, claims and figures of a bundle."""
    parts = [f"<h3>{escape(shown.title)}</h3>"]
    if not shown.holds:
        parts.append(f"<p><strong>{escape(shown.checked)}</strong></p>")
    parts.append(f"<p>{escape(shown.finding)}</p>")
    if claims:
        rows = [
            (row["claim"], row["text"], f"{_MARKS.get(row['verdict'], '')} {row['verdict'].replace('-', ' ')}", row["reason"])
            for row in claims
        ]
        parts.append(table(("claim", "", "here", ""), rows))
    parts.extend(figure(name, svg) for name, svg in figures.items())
    parts.append(f"<p><small>{escape(shown.checked)}; results <code>{escape(shown.results_digest)}</code></small></p>")
    return f"<div>{''.join(parts)}</div>"
