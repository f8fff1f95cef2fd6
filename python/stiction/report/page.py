"""The page: facts, figures and data of results as one HTML file."""

from __future__ import annotations

import base64
import hashlib
import inspect
import io
import math
import os
import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from html import escape
from importlib import resources
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from .. import files, quantities, stored
from ..errors import FileError
from ..opened import open_run
from ..plot import page as drawn_page
from ..plot import panels
from ..plot.style import COLORS, context
from ..plot.sweep import QUANTITIES
from ..results import Finding, Result, Sweep
from ..version import __version__
from .data import tables
from .facts import Facts, Table, Verdict, facts

__all__ = ["page", "write"]

_SIGNS = {"good": "✓", "caution": "!", "bad": "✗", "none": "–"}
# Rows that a table of data shows at most, and rows of its CSV.
_SHOWN, _KEPT = 200, 50_000
_VARIABLES = ("blue", "vermilion", "green", "pink", "orange", "sky")


def write(results: Sequence[Result | str | os.PathLike[str]], output: str | os.PathLike[str], *, force: bool = False) -> Path:
    """Writes the page of one result or of several side by side.

    Parameters
    ----------
    results : sequence of Result, str or os.PathLike
        Results, or their files.
    output : str or os.PathLike
        The page, ``.html``.
    force : bool
        Whether a file that is there is overwritten.

    Returns
    -------
    pathlib.Path
        The page.

    Raises
    ------
    FileError
        A file is no result, or the page is there already, or is one of the results.
    """
    inputs = [result.path if isinstance(result, Result) else result for result in results]
    files.check(output, force=force, inputs=inputs)
    with ExitStack() as opened:
        text = page(
            [of if isinstance(of, Result) else opened.enter_context(open_run(of)) for of in results]
        )
    with files.writing(output, force=force, inputs=inputs) as part:
        part.write_text(text, encoding="utf-8")
    return Path(output)


def page(results: Sequence[Result]) -> str:
    """The page of one result or of several side by side, as HTML. Equal files give equal pages.

    Parameters
    ----------
    results : sequence of Result
    """
    if not results:
        raise FileError("a report needs a result")
    said = [_read(result, facts) for result in results]
    pairs = list(zip(results, said, strict=True))
    names = _names(results)
    title = results[0].title or names[0]
    if len(results) > 1:
        title = f"{len(results)} results side by side"

    def section(heading: str, content: Callable[[Result, Facts], str]) -> str:
        parts = [_read(result, content, fact) for result, fact in pairs]
        if not any(parts):
            return ""
        several = len(parts) > 1
        bodies = [
            f"<div>{f'<h3>{escape(name)}</h3>' if several else ''}{part or '<p class=quiet>none</p>'}</div>"
            for name, part in zip(names, parts, strict=True)
        ]
        shape = f'class="files several" style="--count: {len(parts)}"' if several else "class=files"
        return f"<section><h2>{escape(heading)}</h2><div {shape}>{''.join(bodies)}</div></section>"

    figures = iter(range(1, 1_000_000))
    body = [
        f"<header><h1>{escape(title)}</h1>{_under(results, said)}</header>",
        _side_by_side(names, said) if len(results) > 1 else "",
        section("The number to quote", _number),
        section("Verdicts", lambda _, fact: _verdicts(fact.verdicts) if fact.verdicts else ""),
        section("Warnings", lambda result, _: _list(result.warnings)),
        section("Figures", lambda result, _: _figures(result, figures)),
        section("Tables", lambda _, fact: "".join(_table(table) for table in fact.tables)),
        section("What was computed", lambda _, fact: _rows(fact.computed)),
        section("The scene", lambda result, _: f"<pre>{escape(result.scene_text)}</pre>" if result.scene_text else ""),
        section("How to make it again", lambda result, fact: _again(result, fact) if fact.commands else ""),
        section("Provenance", lambda result, _: _rows(_provenance(result))),
    ]
    style = resources.files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    policy = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        f'<meta name="generator" content="stiction {escape(__version__)}">\n'
        f"<title>{escape(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        + "\n".join(part for part in body if part)
        + "\n</body>\n</html>\n"
    )


def _read(result: Result, content: Callable[..., Any], *more: Any) -> Any:
    """The content that is made of a result; if that fails, its file is at fault."""
    with stored.reading(result.path):
        return content(result, *more)


def _names(results: Sequence[Result]) -> list[str]:
    """Names of the files, with their folders where names are equal."""
    names = [result.path.name for result in results]
    return names if len(set(names)) == len(names) else [str(result.path) for result in results]


def _under(results: Sequence[Result], said: Sequence[Facts]) -> str:
    if len(results) > 1:
        title = "; ".join(result.title or result.path.name for result in results)
    else:
        title = f"{said[0].kind} · {results[0].path.name}"
    return f"<p class=quiet>{escape(title)}</p>"


def _partial(result: Result) -> str:
    if not result.is_partial:
        return ""
    attrs = result.attrs
    of = f" of {attrs['replicas_of_whole_run']}" if "replicas_of_whole_run" in attrs else ""
    count = f"{attrs['replicas']}{of} replicas" if "replicas" in attrs else "some replicas are missing"
    return f"<p class=partial>PARTIAL: {escape(count)}</p>"


def _number(result: Result, fact: Facts) -> str:
    if isinstance(result, Finding):
        return f"<pre>{escape(result.words)}</pre>"
    first, *rest = fact.numbers
    main = f"<div>{escape(first.label)}</div><div class=value>{escape(first.text)}</div><div class=quiet>{escape(first.note)}</div>"
    rows = "".join(
        f"<tr><th scope=row>{escape(number.label)}</th><td>{escape(number.text)}<br><small>{escape(number.note)}</small></td></tr>"
        for number in rest
    )
    return f"{_partial(result)}<div class=number>{main}</div><table class=pairs><tbody>{rows}</tbody></table>"


def _verdicts(verdicts: Sequence[Verdict]) -> str:
    return "<ul class=verdicts>" + "".join(
        f'<li data-verdict="{escape(of.subject)}"><span class="sign {of.grade}" aria-hidden=true>{_SIGNS[of.grade]}</span>'
        f"<span>{escape(of.subject)}: <b class={of.grade}>{escape(of.word)}</b><br><small>{escape(of.text)}</small></span></li>"
        for of in verdicts
    ) + "</ul>"  # fmt: skip


def _list(lines: Sequence[str]) -> str:
    return f"<ul>{''.join(f'<li>{escape(line)}</li>' for line in lines)}</ul>" if lines else ""


def _rows(rows: Sequence[tuple[str, str]]) -> str:
    cells = "".join(f"<tr><th scope=row>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows)
    return f"<table class=pairs><tbody>{cells}</tbody></table>"


def _as_words(words: str) -> str:
    """A caption without the signs of formulas: h* for $h^*$."""
    return re.sub(r"\$([^$]*)\$", lambda found: found[1].replace("^", ""), words)


def _grid(header: Sequence[str], rows: Sequence[Sequence[str]], caption: str = "", kind: str = "") -> str:
    head = "".join(f"<th scope=col>{escape(name)}</th>" for name in header)
    cells = "".join(f"<tr>{''.join(map(_table_cell, row))}</tr>" for row in rows)
    above = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f"<table{f' class={kind}' if kind else ''}>{above}<thead><tr>{head}</tr></thead><tbody>{cells}</tbody></table>"


def _table_cell(text: str) -> str:
    return f"<td{' class=text' if len(text) > 40 else ''}>{escape(text)}</td>"


def _table(table: Table) -> str:
    return f'<div class=wide tabindex=0>{_grid(table.header, table.rows, table.caption)}</div>'


def _side_by_side(names: Sequence[str], said: Sequence[Facts]) -> str:
    """The numbers and verdicts that several results have, a column for each, and differences to the first."""
    labels = list(dict.fromkeys(number.label for fact in said for number in fact.numbers))
    by = [{number.label: number for number in fact.numbers} for fact in said]
    rows = []
    for label in labels:
        if sum(label in numbers for numbers in by) < 2:
            continue
        rows.append([label, *(numbers[label].text if label in numbers else "–" for numbers in by)])
        first = by[0].get(label)
        comparable = [numbers for numbers in by[1:] if label in numbers and math.isfinite(numbers[label].value)]
        if comparable and first is not None and first.error > 0.0 and first.value != 0.0:
            rows.append(["… against the first", "", *(_against(first, numbers.get(label)) for numbers in by[1:])])
    for subject in dict.fromkeys(verdict.subject for fact in said for verdict in fact.verdicts):
        words = [next((f"{_SIGNS[of.grade]} {of.word}" for of in fact.verdicts if of.subject == subject), "–") for fact in said]
        rows.append([subject, *words])
    grid = _grid(["", *names], rows)
    return f"<section><h2>Side by side</h2><div class=wide tabindex=0>{grid}</div></section>"


def _against(first: Any, other: Any) -> str:
    """A number against the first, in per cent or times, with the standard error of two independent runs."""
    if other is None or not math.isfinite(other.value):
        return "–"
    ratio = other.value / first.value
    if not 0.5 < ratio < 2.0:
        return f"× {quantities.number(ratio, 3)}"
    error = 100 * math.hypot(other.error / first.value, ratio * first.error / first.value)
    change = f"{'+' if ratio > 1.0 else ''}{quantities.number(100 * (ratio - 1), 3)}"
    return f"{change} ± {quantities.number(error, 2)} %" if math.isfinite(error) else f"{change} %"


def _figures(result: Result, numbers: Any) -> str:
    if isinstance(result, Finding):
        try:
            drawing = drawn_page(result, "180mm")
        except FileError:
            return ""
        return f"<figure>{_svg(drawing, f'f{next(numbers)}-', result.format.kind)}</figure>"
    return f"<div class=figures>{''.join(_figure(result, name, next(numbers)) for name in panels(result))}</div>"


def _figure(result: Result, name: str, number: int) -> str:
    drawing = drawn_page(result, "110mm", what=name)
    words = name.replace("pull_off", "pull-off").replace("_", " ")
    caption = inspect.getdoc(getattr(panels(result)[name], "func", panels(result)[name])) or ""
    if isinstance(result, Sweep) and name in QUANTITIES:
        caption = QUANTITIES[name].words
    stem = result.path.stem
    links = [_data(table, f"{stem}_{name}{f'_{i}' if i else ''}.csv") for i, table in enumerate(tables(result, name))]
    return (
        f'<figure id="figure-{number}">{_svg(drawing, f"f{number}-", words)}'
        f"<figcaption>{escape(_as_words(caption.partition(chr(10))[0]))}</figcaption>"
        f"<details class=data-of-figure><summary>Data of {escape(words)}</summary>{''.join(links)}</details></figure>"
    )


def _svg(drawing: Figure, prefix: str, words: str) -> str:
    with context():
        stream = io.StringIO()
        drawing.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    return _inline(stream.getvalue(), prefix, words)


def _inline(svg: str, prefix: str, words: str) -> str:
    """A drawing for a page: without head, with names of its own, and with colours that follow the scheme of the page."""
    text = re.sub(r"<metadata>.*?</metadata>", "", svg[svg.index("<svg") :], flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{prefix}', text)
    text = re.sub(r'(url\(#|href="#)', rf"\g<1>{prefix}", text)
    text = re.sub(r'^<svg\b[^>]*?viewBox="([^"]*)"[^>]*>', rf'<svg viewBox="\1" role="img" aria-label="{escape(words)}" '
                  'xmlns:xlink="http://www.w3.org/1999/xlink">', text)  # fmt: skip
    for color, variable in zip(COLORS, _VARIABLES, strict=False):
        text = re.sub(color, f"var(--{variable})", text, flags=re.IGNORECASE)
    return text.replace("#000000", "currentColor").replace("#ffffff", "var(--paper)")


def _data(table: pd.DataFrame, name: str) -> str:
    """A table of data: its first rows, and a link to a CSV file with all of them."""
    csv = _no_formulas(table[:_KEPT]).to_csv(index=False, lineterminator="\n")
    link = f"data:text/csv;charset=utf-8;base64,{base64.b64encode(csv.encode()).decode()}"
    left_out = ""
    if len(table) > _SHOWN:
        kept = "" if len(table) <= _KEPT else f", and its first {_KEPT} in the CSV file"
        left_out = f"<p class=quiet>The first {_SHOWN} of {len(table)} rows are shown{kept}.</p>"
    rows = [[_cell(value) for value in row] for row in table[:_SHOWN].itertuples(index=False)]
    grid = _grid([str(column) for column in table.columns], rows, kind="data")
    return f'<p><a download="{escape(name)}" href="{link}">{escape(name)}</a></p>{left_out}<div class=scroll tabindex=0>{grid}</div>'


def _no_formulas(table: pd.DataFrame) -> pd.DataFrame:
    """A table that spreadsheets take for texts and numbers, also where a text begins like a formula."""
    texts = [name for name in table.columns if not pd.api.types.is_numeric_dtype(table[name])]
    return table.assign(**{name: table[name].map(_no_formula) for name in texts}).rename(columns=_no_formula)


def _no_formula(cell: Any) -> Any:
    if not (isinstance(cell, str) and cell.lstrip().startswith(("=", "+", "-", "@"))):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "–" if math.isnan(value) else f"{value:.6g}".replace("-", "−")
    return str(value)


def _again(result: Result, fact: Facts) -> str:
    needs = ""
    if fact.needs:
        needs = f"<p>It needs {escape(', '.join(dict.fromkeys(fact.needs)))}, in the current folder.</p>"
    if result.is_partial:
        needs += "<p>This result is partial; the command makes the whole.</p>"
    version = str(result.attrs.get("program_version", ""))
    intro = f"<p>With stiction {escape(version)}, on any number of threads, this gives the same numbers to the last bit:</p>"
    command, _, scene = fact.commands.partition(" <<")
    if scene:
        command = f"<pre>{escape(command)}</pre><p>The scene above is its standard input.</p>"
        return f"{intro}{needs}{command}<details><summary>Command with scene, to paste</summary><pre>{escape(fact.commands)}</pre></details>"
    return f"{intro}{needs}<pre>{escape(fact.commands)}</pre>"


def _provenance(result: Result) -> list[tuple[str, str]]:
    attrs = result.attrs
    with open(result.path, "rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    version = ".".join(str(int(part)) for part in attrs["format_version"])
    rows = [
        ("file", result.path.name),
        ("size", f"{result.path.stat().st_size} bytes"),
        ("SHA-256", digest),
        ("made", str(attrs.get("created", ""))),
        ("format", f"{attrs['format']} {version}"),
    ]
    for title, key in (("program", "program_version"), ("revision", "source_revision"), ("hash of the source", "source_hash")):
        if (known := str(attrs.get(key, "unknown"))) != "unknown":
            rows.append((title, f"stiction {known}" if title == "program" else known))
    if "diagnostics" in result:
        group = result["diagnostics"]
        seconds = float(group["seconds"].values.sum())
        threads = int(group["threads"].values.max())
        rows.append(("computed in", f"{quantities.number(seconds, 3)} s on {quantities.counted(threads, 'thread')}" + (f", {instructions}" if (instructions := group.attrs.get("instruction_set", "")) else "")))
    return rows
