"""The one rule for what people write and other readers read: a name, a label or a text holds nothing that a terminal, an XML
file, a line of code or the reader's eye would take for something else. And how text that came in otherwise is shown.
"""

from __future__ import annotations

import re
import unicodedata

LONGEST_WORD = 1000
_ENDLESS = re.compile(rf"\S{{{LONGEST_WORD + 1},}}")
_JOINERS = "\u200c\u200d"  # without them Persian and many emoji are misspelt
# Control and format characters, the bidirectional ones among them; lone surrogates; what is private or unassigned, in
# part no XML; line and paragraph separators.
_UNFIT = frozenset(("Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"))


def one_line(text: str) -> str:
    """The text of a name or label, if it is one. ValueError names the first character that is not allowed in it."""
    return _fit(text, "", "a name or label holds no control or bidirectional characters and no line breaks")


def lines(text: str) -> str:
    """The same for a text that may have several lines."""
    return _fit(text, "\n\t", "a text holds no control or bidirectional characters but line breaks and tabs")


def shown(text: str) -> str:
    """For a terminal or a log: what no text may hold is written as an escape, as \\x1b, and words without an end are cut."""
    short = _ENDLESS.sub(lambda word: f"{word[0][:LONGEST_WORD]}...", text)
    return "".join(c if _is_fit(c, "\n\t") else ascii(c)[1:-1] for c in short)


def plain(text: str, most: int = 300) -> str:
    """On one line, short, and without anything that would change a terminal."""
    line = " ".join(str(text).split())
    fit = "".join(c if _is_fit(c) else "?" for c in line[: most + 1])
    return fit if len(fit) <= most else fit[:most] + "..."


def _fit(text: str, beside: str, rule: str) -> str:
    odd = "" if text.isprintable() else next((c for c in text if not _is_fit(c, beside)), "")
    if odd:
        from pydantic_core import PydanticCustomError  # a ValueError, which pydantic tells without words of its own

        name = unicodedata.name(odd, "")
        what = f"U+{ord(odd):04X}{f' ({name})' if name else ''}"
        raise PydanticCustomError("unfit", "{rule}; this one has {what}", {"rule": rule, "what": what})
    return text


def _is_fit(character: str, beside: str = "") -> bool:
    return unicodedata.category(character) not in _UNFIT or character in _JOINERS or character in beside
