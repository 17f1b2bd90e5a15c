"""The frame of a report's page: one HTML file that loads nothing from elsewhere."""
from __future__ import annotations

from html import escape

from ._style import STYLE


def document(title: str, sections: list[str], footer: str) -> str:
    """The whole page; `sections` and `footer` are HTML."""
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)} – frm report</title>
<style>{STYLE}</style>
</head>
<body>
<main>
{chr(10).join(sections)}
<footer>{footer} This page loads nothing from elsewhere.</footer>
</main>
</body>
</html>
"""


def figure(uri: str, alt: str, caption: str) -> str:
    return (f'<figure><div class="wide"><img src="{uri}" alt="{escape(alt)}"></div>'
            f"<figcaption>{caption}</figcaption></figure>")


def table(rows) -> str:
    cells = "".join(f'<tr><th scope="row">{escape(label)}</th><td>{escape(value)}</td></tr>'
                    for label, value in rows)
    return f"<table>{cells}</table>"


def facts(pairs) -> str:
    """The numbers that a reader looks for first; names and values are HTML."""
    listed = "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in pairs)
    return f'<dl class="facts">{listed}</dl>'


def many(columns, rows) -> str:
    """A table with a row for each thing and a column for each value."""
    head = "".join(f"<th scope='col'>{escape(name)}</th>" for name in columns)
    body = "".join("<tr>" + "".join(f"<td>{escape(value)}</td>" for value in row) + "</tr>" for row in rows)
    return (f'<div class="wide"><table class="many"><thead><tr>{head}</tr></thead>'
            f"<tbody>{body}</tbody></table></div>")
