"""A situation as the text of a file or as a link."""

from __future__ import annotations

import base64
import json
import zlib
from typing import Any

from app.runs.lines import parts_of
from app.runs.world_edits import edit_of
from app.situations.document import FORMAT, MOST_PARTS, Document, check_of, check_of_defaults, defaults
from app.situations.situation import Situation
from disk.limits import LINK_BYTES, SITUATION_BYTES
from sim2d import load_world, world_names, world_to_json

LONGEST_LINK = 8000  # characters; longer addresses are cut by mail programs and chats
KEY = "run"


def file_of(situation: Situation) -> str:
    """The text of its file, an order a line: whatever the program that reads it has as worlds and defaults, this is the
    same. ValueError: it would be longer than what can be read again."""
    document = _document(situation, short=False).model_dump(mode="json", exclude=_left_out(situation))
    orders = ",\n  ".join(map(json.dumps, _orders(situation)))
    lines = [f'"{key}": {json.dumps(value)}' for key, value in document.items()]
    text = "{" + ",\n ".join([*lines, f'"orders": [\n  {orders}]' if orders else '"orders": []']) + "}\n"
    if len(text) > SITUATION_BYTES or parts_of(text.encode(), MOST_PARTS) > MOST_PARTS:
        raise ValueError(
            f"the run is too long for a situation: {len(situation.orders):,} orders, {len(text) >> 20} MiB"
        )
    return text


def link_of(situation: Situation) -> tuple[str | None, str]:
    """The end of an address, `run=...`, and nothing; or None and a sentence that says why it fits into no link."""
    if situation.brain is not None:
        size = f"{len(situation.brain) / 1e6:.1f} MB"
        return None, f"The run began with a brain of its own, {size}, which fits into no link; the file has it."
    document = _document(situation, short=True).model_dump_json(exclude=_left_out(situation)).removesuffix("}")
    text = f'{document},"orders":{json.dumps(_orders(situation), separators=(",", ":"))}}}'.encode()
    if len(text) > LINK_BYTES:
        return None, f"The run has {len(situation.orders):,} orders, too many for a link; the file has them."
    packed = zlib.compress(text, 9)
    link = f"{KEY}={base64.urlsafe_b64encode(packed).decode().rstrip('=')}"
    if len(link) <= LONGEST_LINK:
        return link, ""
    parts = [f"{len(situation.orders):,} orders"] if situation.orders else []
    parts += [] if is_ours(situation) else [f"the world {situation.header.world_name}, which is none of the program's"]
    return None, (
        f"The link would have {len(link):,} characters ({' and '.join(parts)}), and more than {LONGEST_LINK:,} do not "
        "get through everywhere; the file has it."
    )


def is_ours(situation: Situation) -> bool:
    """Whether its world is one that comes with the program, as it comes."""
    return situation.header.world == text_of_ours(situation.header.world_name)


def text_of_ours(name: str) -> str | None:
    """The text of the world of this name that comes with the program. A link names nothing else: no file of this machine."""
    return world_to_json(load_world(name)) if name in dict(world_names()) else None


def changed_values(situation: Situation) -> dict[str, Any]:
    """The parameters that are not at their defaults, and one that would otherwise follow another (`Config.with_values`)."""
    values, usual = situation.header.values, defaults()
    changed = {name: value for name, value in values.items() if usual.get(name) != value}
    if "robot.camera_fov_rad" in changed:
        changed["local_view.field_of_view"] = values["local_view.field_of_view"]
    return changed


def _left_out(situation: Situation) -> set[str]:
    """Programs that know of no second hash read what has none."""
    return {"second_hash"} if situation.second_hash is None else set()


def _document(situation: Situation, *, short: bool) -> Document:
    header = situation.header
    left_out = short and is_ours(situation)
    return Document(
        format=FORMAT,
        version=header.version,
        python=header.python,
        numpy=header.numpy,
        platform=header.platform,
        made_at=header.made_at,
        world_name=header.world_name,
        world=None if left_out else header.world,
        check=check_of(header.world),
        seed=header.seed,
        values=changed_values(situation) if short else header.values,
        defaults=check_of_defaults() if short else None,
        tick=situation.tick,
        state_hash=situation.state_hash,
        second_hash=situation.second_hash,
        look=situation.look,
        trial=header.trial,
        brain=None if situation.brain is None else base64.b64encode(situation.brain).decode(),
    )


def _orders(situation: Situation) -> list[tuple[int, str, dict[str, Any]]]:
    text, rows = situation.header.world, list[tuple[int, str, dict[str, Any]]]()
    for order in situation.orders:
        values = dict(order.values)
        if "world" in values:
            after = values.pop("world")
            values["edit"], text = edit_of(text, after), after
        rows.append((order.tick, order.name, values))
    return rows
