"""Situations for the page: what its menu shows of a moment, and what it is sent to open."""

from __future__ import annotations

from app.situations.led_here import LedHere
from app.situations.python_lines import python_lines
from app.situations.reading import read_situation
from app.situations.situation import Situation
from app.situations.writing import file_of, link_of
from web.http.situations import Made
from web.messages.situation import Look


class PageSituations:
    """As web/http/situations.py asks for it."""

    def made(self, led_here: object, look: Look) -> Made:
        """OSError: the brain that the run began with cannot be read any more."""
        assert isinstance(led_here, LedHere)
        situation = led_here.situation(look)
        link, why = link_of(situation)
        name = f"{name_of(led_here)}.situation.json"
        return Made(
            link=link,
            why=why,
            name=name,
            file=file_of(situation),
            python=python_lines(situation, name),
            tick=led_here.tick,
            time_s=led_here.time_s,
            state_hash=led_here.state_hash,
            orders=len(situation.orders),
        )

    def read(self, text: str) -> Situation:
        """ValueError says what is wrong with it."""
        situation = read_situation(text)
        situation.first_brain()
        return situation


def name_of(led_here: LedHere) -> str:
    """For files: the run and the moment."""
    world = "".join(c if c.isalnum() else "-" for c in led_here.world)
    minutes, seconds = divmod(led_here.time_s, 60)
    return f"{world}-seed{led_here.seed}-{int(minutes)}m{seconds:04.1f}s"
