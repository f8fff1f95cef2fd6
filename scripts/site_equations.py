"""Equations of the site as drawings, made when it is built: the same in every browser, without a script, a
network or fonts.

A hook of MkDocs (mkdocs.yml). The extension arithmatex has marked the equations.
"""

import functools
import html
import re

import ziamath

EQUATION = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.S)
# Pixels of a drawing to an em of the text around it.
SIZE = 20


ziamath.config.svg2 = False


@functools.cache
def drawn(tex: str, inline: bool) -> str:
    """An equation as SVG on the line of the text, which a reader that does not see hears as TeX."""
    svg = ziamath.Latex(tex, size=1.15 * SIZE, inline=inline, color="currentColor").svg()
    box = re.search(r'viewBox="\S+ (\S+) (\S+) (\S+)"', svg)
    top, width, height = [float(number) / SIZE for number in box.groups()]
    style = f"width:{width:.3f}em;height:{height:.3f}em;vertical-align:{-(height + top):.3f}em"
    begin = f'<svg role="img" aria-label="{html.escape(tex)}" style="{style}"'
    return re.sub(r'<svg(?= )', lambda _: begin, re.sub(r' (width|height)="[^"]*"', "", svg, count=2),
                  count=1)


def on_page_content(content: str, **_: object) -> str:
    """The page with its equations drawn."""

    def typeset(match: re.Match[str]) -> str:
        kind, tex = match[1], " ".join(html.unescape(match[2]).split())
        return f'<{kind} class="equation">{drawn(tex, kind == "span")}</{kind}>'

    return EQUATION.sub(typeset, content)
