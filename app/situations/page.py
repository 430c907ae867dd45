"""Situations for the page: what its menu shows of a moment, as a link, a file, or lines of Python for a notebook, and what
it is sent to open."""

from __future__ import annotations

import json
import pprint
from typing import Any

from app.situations.document import changed_values, file_of, is_ours, link_of, read_situation
from app.situations.situation import LedHere, Situation
from disk.words import plain
from web.http.situations import Made
from web.messages.situation import Look

FIRST = "import ratslam_live  # before the others: `app` is ours then, whatever lies beside the notebook"
WIDE = 120  # characters of a line
_AS_OBJECTS = {"edit_world", "put_box"}  # orders whose values are the texts of objects


def python_lines(situation: Situation, file_name: str) -> str:
    """Lines to be run where the package is installed. They end with the session `session`, and say whether it is the same.

    Names in them come from others: as text they stand as Python's own literals, in comments on one line.

    A brain, a world or boxes of its own would fill pages: such a run is read from its file. file_name: of that.
    """
    made = situation.header
    head = [f"# {plain(made.world_name)}, seed {made.seed}, up to tick {situation.tick}"]
    if (
        situation.brain is not None
        or not is_ours(situation)
        or _AS_OBJECTS & {order.name for order in situation.orders}
    ):
        body = _from_file(file_name)
    else:
        body = _from_the_beginning(situation)
    end = [
        "",
        f'assert session.state_hash() == {_literal(situation.state_hash)}, "not the same: this is another version"',
        *_second(situation),
        f"# Made by version {plain(made.version)}, Python {plain(made.python)}, numpy {plain(made.numpy)}, "
        f"{plain(made.platform)}.",
    ]
    return "\n".join([*head, *body, *end]) + "\n"


def _second(situation: Situation) -> list[str]:
    if situation.second_hash is None:
        return []
    return [
        f'assert session.companion.digest() == {_literal(situation.second_hash)}, "the second brain is not the same"'
    ]


def _from_file(file_name: str) -> list[str]:
    return [
        "# Save it to a file first: its world, boxes or brain are in there.",
        "from pathlib import Path",
        "",
        FIRST,
        "from app.situations import read_situation",
        "",
        f"session = read_situation(Path({_literal(file_name)}).read_text()).play()",
    ]


def _from_the_beginning(situation: Situation) -> list[str]:
    header, values = situation.header, changed_values(situation)
    # All or nothing: a value that follows from another one (`with_values`) is given with it.
    config = f"Config().with_values({_shown(values)})" if values else "Config()"
    lines = [
        FIRST,
        "from app.config import Config",
        "from app.session import Session",
        "from sim2d import load_world",
        "",
        f"session = Session(load_world({_literal(header.world_name)}), {header.seed}, {config})",
    ]
    if situation.orders:
        rows = [f"    ({order.tick}, {order.name!r}, {_shown(order.values)})," for order in situation.orders]
        lines += ["orders = [  # after this tick", *rows, "]"]
        lines += ["for tick, order, values in orders:", *_ticks("tick", "    ")]
        lines += ["    getattr(session, order)(**values)"]
    return [*lines, *_ticks(str(situation.tick), "")]


def _literal(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)  # in double quotes; each escape that is left is one of Python, too


def _ticks(until: str, indent: str) -> list[str]:
    return [f"{indent}while session.tick_count < {until}:", f"{indent}    session.tick()"]


def _shown(values: dict[str, Any]) -> str:
    return pprint.pformat(values, width=10**6 if len(values) < 8 else WIDE, sort_dicts=False)


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
