"""How each page wants to be shown: the theme it has chosen, whether it presents, and whether its reader wants little motion. A
page that wants another look leaves the viewer it is shown."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Generator
from typing import Literal, NamedTuple

Theme = Literal["dark", "light"]
THEMES: tuple[Theme, ...] = ("dark", "light")
MOST_PAGES = 1024


class Look(NamedTuple):
    theme: Theme = "dark"
    large: bool = False  # letters that can be read from the last row
    still: bool = False  # nothing moves by itself but what the run moves


class Themes:
    """Used in the server's loop. A page has a new id each time it is loaded, and says its theme when it connects."""

    def __init__(self) -> None:
        self._chosen: dict[str, Look] = {}
        self._turned: dict[str, asyncio.Event] = {}

    def of(self, page: str) -> Look:
        return self._chosen.get(page, Look())

    def choose(self, page: str, theme: Theme, still: bool = False) -> None:
        self._want(page, self.of(page)._replace(theme=theme, still=still))

    def enlarge(self, page: str, large: bool) -> None:
        self._want(page, self.of(page)._replace(large=large))

    def _want(self, page: str, look: Look) -> None:
        other = self.of(page) != look
        self._chosen.pop(page, None)
        self._chosen[page] = look
        if len(self._chosen) > MOST_PAGES:
            del self._chosen[next(iter(self._chosen))]  # the page that has been quiet for longest
        if other and page in self._turned:
            self._turned[page].set()

    @contextlib.contextmanager
    def shown(self, page: str) -> Generator[tuple[Look, asyncio.Event], None, None]:
        """How a page is to be shown, and an event that is set when it wants another look."""
        turned = self._turned[page] = asyncio.Event()
        try:
            yield self.of(page), turned
        finally:
            if self._turned.get(page) is turned:
                del self._turned[page]
