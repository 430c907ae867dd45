"""Formulas typeset: LaTeX to MathML, each symbol that is a parameter marked by its name."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree

from latex2mathml.converter import convert

from app.lessons.schema import Formula
from web.http.lessons import FormulaText, SymbolText

MATHML = "http://www.w3.org/1998/Math/MathML"


def formula_text(formula: Formula, values: Mapping[str, str]) -> FormulaText:
    """values: of the parameters, by dotted name. ValueError: it is no LaTeX."""
    tree = _tree(formula.latex, block=True)
    for symbol in formula.symbols:
        if symbol.parameter is not None:
            _mark(tree, _content(symbol.symbol), symbol.parameter)
    symbols = [
        SymbolText(
            mathml=_text(_tree(symbol.symbol)), means=symbol.means, parameter=symbol.parameter,
            value=None if symbol.parameter is None else values[symbol.parameter],
        )
        for symbol in formula.symbols
    ]  # fmt: skip
    return FormulaText(
        mathml=_text(tree), latex=formula.latex, says=formula.says, source=formula.source, symbols=symbols
    )


def _tree(latex: str, block: bool = False) -> ElementTree.Element:
    ElementTree.register_namespace("", MATHML)
    try:
        tree = ElementTree.fromstring(convert(latex, display="block" if block else "inline"))
    except Exception as error:  # whatever the converter raises
        raise ValueError(f"{latex!r} cannot be typeset: {type(error).__name__} {error}") from None
    unknown = next((text for each in tree.iter() if (text := each.text or "").startswith("\\")), None)
    if unknown is not None:
        raise ValueError(f"{latex!r} cannot be typeset: {unknown} is unknown")
    return tree


def _content(latex: str) -> list[str]:
    """The symbol's own elements as texts, without those around it."""
    inner = list(_tree(latex))
    while len(inner) == 1 and inner[0].tag.endswith("mrow"):
        inner = list(inner[0])
    return [_text(each) for each in inner]


def _mark(tree: ElementTree.Element, wanted: list[str], parameter: str) -> None:
    """Mark every element that looks like the symbol; of a symbol of several elements, the first."""
    for element in tree.iter():
        children = list(element)
        for k in range(len(children) - len(wanted) + 1):
            if [_text(each) for each in children[k : k + len(wanted)]] == wanted:
                children[k].set("data-parameter", parameter)


def _text(element: ElementTree.Element) -> str:
    tail, element.tail = element.tail, None
    text = ElementTree.tostring(element, encoding="unicode")
    element.tail = tail
    return text
