"""The theme that each page has chosen. A page that chooses the other one leaves the viewer it is shown."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Generator
from typing import Literal

Theme = Literal["dark", "light"]
THEMES: tuple[Theme, ...] = ("dark", "light")
MOST_PAGES = 1024


class Themes:
    """Used in the server's loop. A page has a new id each time it is loaded, and says its theme when it connects."""

    def __init__(self) -> None:
        self._chosen: dict[str, Theme] = {}
        self._turned: dict[str, asyncio.Event] = {}

    def of(self, page: str) -> Theme:
        return self._chosen.get(page, "dark")

    def choose(self, page: str, theme: Theme) -> None:
        other = self.of(page) != theme
        self._chosen.pop(page, None)
        self._chosen[page] = theme
        if len(self._chosen) > MOST_PAGES:
            del self._chosen[next(iter(self._chosen))]  # the page that has been quiet for longest
        if other and page in self._turned:
            self._turned[page].set()

    @contextlib.contextmanager
    def shown(self, page: str) -> Generator[tuple[Theme, asyncio.Event], None, None]:
        """The theme that a page is to be shown, and an event that is set when it chooses the other."""
        turned = self._turned[page] = asyncio.Event()
        try:
            yield self.of(page), turned
        finally:
            if self._turned.get(page) is turned:
                del self._turned[page]
