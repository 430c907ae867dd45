"""A situation as the text of a file (JSON), as a link, which has the same, shorter and packed, and as lines of Python for a
notebook. Files and links come from others, so everything in them is checked.

A link leaves out what every program has: the text of a world of the program (`check` says which text that was), and
parameters at their defaults (`defaults` says which those were).
"""

from __future__ import annotations

import base64
import binascii
import json
import pprint
import zlib
from typing import Annotated, Any

import msgspec
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from app.config import Config, Value
from app.orders import SMALLEST_M, Order, check_order
from app.run_record.header import FORMAT as RUN
from app.run_record.header import Header
from app.run_record.order_rows import OrderRows, row_of
from app.run_record.run_log import parts_of
from app.run_record.situation import ReplaySpec, Situation
from disk.limits import LINE_PARTS, LINK_BYTES, ORDERS, PARTS_OF_AN_ORDER, SITUATION_BYTES, TICKS
from disk.words import one_line, plain
from sim2d import load_world, world_from_json, world_names, world_to_json
from web.http.situations import Made
from web.messages.situation import Look

FORMAT = "ratslam situation/1"
MOST_PARTS = PARTS_OF_AN_ORDER * ORDERS
_Row = tuple[int, str, dict[str, Any]]
_ORDER: msgspec.json.Decoder[_Row] = msgspec.json.Decoder(_Row)
_Short = Annotated[str, Field(max_length=200), AfterValidator(one_line)]
_Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]


class Document(BaseModel):
    """Of its file all but the orders, which are read and written one by one."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)
    format: _Short
    version: _Short
    python: _Short
    numpy: _Short
    platform: _Short
    made_at: float
    world_name: _Short
    world: str | None  # the text of its file; None: the program's own world of this name
    check: int  # of that text
    seed: Annotated[int, Field(ge=0, le=2**32 - 1)]
    values: dict[str, Value]
    defaults: int | None  # checksum of the defaults that are left out; None: nothing is left out
    tick: Annotated[int, Field(ge=0, le=TICKS)]
    state_hash: _Hash
    second_hash: _Hash | None = None  # of the second brain; left out where there is none, as in all earlier situations
    look: Look
    trial: _Short
    brain: str | None  # base64


def check_of(text: str) -> int:
    return zlib.crc32(text.encode())


def defaults() -> dict[str, Value]:
    """Of all parameters, by dotted name."""
    return {name: value for name, _, value in Config().items()}


def check_of_defaults() -> int:
    return check_of(json.dumps(defaults(), sort_keys=True))


def document_in(text: str | bytes) -> tuple[Document, list[msgspec.Raw]]:
    """The document and its orders, each still as text: of a long run, all of them as values would fill the memory. ValueError
    says, in a sentence, what is wrong."""
    raw = text.encode("utf-8", "surrogatepass") if isinstance(text, str) else text
    if len(raw) > SITUATION_BYTES or parts_of(raw, MOST_PARTS) > MOST_PARTS:
        raise ValueError(f"it is longer than any run: it may have {SITUATION_BYTES >> 20} MiB and {ORDERS:,} orders")
    try:
        tree = msgspec.json.decode(raw, type=dict[str, msgspec.Raw])
        orders = msgspec.json.decode(tree.pop("orders", b"[]"), type=list[msgspec.Raw])
        rest = b",".join(json.dumps(key).encode() + b":" + bytes(value) for key, value in tree.items())
    except (msgspec.MsgspecError, RecursionError) as error:
        raise ValueError(f"it is no situation of this program: it is damaged: {error}") from None
    if parts_of(rest, LINE_PARTS) > LINE_PARTS:
        raise ValueError(
            f"it is no situation of this program: it holds more than {LINE_PARTS:,} values beside its orders"
        )
    return _checked(b"{" + rest + b"}"), orders


def order_in(raw: msgspec.Raw) -> _Row:
    """Tick, name and values; of an edited world the values hold what differs from the one before. ValueError: it is none."""
    if parts_of(bytes(raw), LINE_PARTS) > LINE_PARTS:
        raise ValueError(f"it holds more than {LINE_PARTS:,} values")
    try:
        return _ORDER.decode(raw)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise ValueError(f"it is damaged: {error}") from None


def _checked(raw: bytes) -> Document:
    try:
        return Document.model_validate_json(raw)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        wrong = first["msg"][0].lower() + first["msg"][1:]
        raise ValueError(f"it is no situation of this program: {f'{where}: ' if where else ''}{wrong}") from None


def read_situation(text: str) -> Situation:
    """text: of a file, or a link: a whole address, or its end from `run=` on. ValueError says what is wrong with it."""
    text = text.strip()
    document, orders = document_in(text if text.startswith("{") else _unpacked(text))
    if document.format != FORMAT:
        raise ValueError(f"its format is {document.format!r}; this program reads {FORMAT!r}")
    notes: list[str] = []
    if document.defaults not in (None, check_of_defaults()):
        notes.append("Some of the defaults, which its link leaves out, were others then.")
    world = _world_of(document)
    header = Header(
        RUN, document.version, document.python, document.numpy, document.platform, document.made_at,
        document.world_name, world, document.seed, defaults() | document.values, document.brain is not None,
        document.trial,
    )  # fmt: skip
    _ = header.config  # ValueError: there is no such parameter, or not such a value
    return Situation(
        header, _orders_of(document, orders, world), document.tick, document.state_hash, document.look, _brain_of(document),
        tuple(notes), document.second_hash,
    )  # fmt: skip


def _unpacked(text: str) -> bytes:
    _, found, packed = text.rpartition(f"{KEY}=")
    packed = packed.partition("&")[0]
    if not found:
        raise ValueError(f"it is neither the file of a situation nor a link with #{KEY}=")
    try:
        raw = base64.b64decode(packed + "=" * (-len(packed) % 4), altchars=b"-_", validate=True)
        opening = zlib.decompressobj()
        document = opening.decompress(raw, LINK_BYTES)
    except (binascii.Error, ValueError, zlib.error):
        raise ValueError("the link is damaged: what follows run= cannot be unpacked; copy it whole") from None
    if not opening.eof:
        too_long = "is longer than any run" if len(document) >= LINK_BYTES else "is cut off; copy it whole"
        raise ValueError(f"the link {too_long}")
    return document


def _world_of(document: Document) -> str:
    """The text of the world."""
    text = document.world if document.world is not None else text_of_ours(document.world_name)
    if text is None:
        raise ValueError(f"this program has no world {document.world_name!r}; ask for the file, which has it")
    if check_of(text) != document.check:
        whose = "the world in it" if document.world is not None else f"this program's world {document.world_name!r}"
        raise ValueError(f"{whose} is another than the one that the run began in; ask for the file")
    world_from_json(text, f"the world {document.world_name}", SMALLEST_M)
    return text


def _orders_of(document: Document, rows: list[msgspec.Raw], world: str) -> tuple[Order, ...]:
    read, last = OrderRows(world), 0
    for number, raw in enumerate(rows, start=1):
        try:
            tick, name, values = order_in(raw)
        except ValueError as error:
            raise ValueError(f"order {number}: {error}") from None
        if not last <= tick <= document.tick:
            raise ValueError(f"order {number} is of tick {tick}; it must be from {last} to {document.tick}")
        try:
            read.add(Order(tick, name, values), values.pop("edit", None))
            check_order(Order(tick, name, values))
        except ValueError as error:
            raise ValueError(f"order {number}, of tick {tick}: {error}") from None
        last = tick
    return tuple(read.orders)


def _brain_of(document: Document) -> bytes | None:
    try:
        return None if document.brain is None else base64.b64decode(document.brain, validate=True)
    except (binascii.Error, ValueError):
        raise ValueError("the brain in it is damaged: it is no base64") from None


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


def _orders(situation: Situation) -> list[_Row]:
    world, rows = situation.header.world, list[_Row]()
    for order in situation.orders:
        values, edit, world = row_of(order, world)
        rows.append((order.tick, order.name, values if edit is None else {**values, "edit": edit}))
    return rows


# ------------------------------------------------------------ lines of Python

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
        "from app.run_record.link import read_situation",
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

    def made(self, spec: object, look: Look) -> Made:
        """OSError: the brain that the run began with cannot be read any more."""
        assert isinstance(spec, ReplaySpec)
        situation = spec.situation(look)
        link, why = link_of(situation)
        name = f"{name_of(spec)}.situation.json"
        return Made(
            link=link,
            why=why,
            name=name,
            file=file_of(situation),
            python=python_lines(situation, name),
            tick=spec.tick,
            time_s=spec.time_s,
            state_hash=spec.state_hash,
            orders=len(situation.orders),
        )

    def read(self, text: str) -> Situation:
        """ValueError says what is wrong with it."""
        situation = read_situation(text)
        situation.first_brain()
        return situation


def name_of(spec: ReplaySpec) -> str:
    """For files: the run and the moment."""
    world = "".join(c if c.isalnum() else "-" for c in spec.world)
    minutes, seconds = divmod(spec.time_s, 60)
    return f"{world}-seed{spec.seed}-{int(minutes)}m{seconds:04.1f}s"
