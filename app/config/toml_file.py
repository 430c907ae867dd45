"""Parameters written to and read from TOML."""

from __future__ import annotations

import tomllib
from dataclasses import Field, fields
from pathlib import Path
from typing import Any, cast

import tomlkit

from app.config.tree import Config, Value
from disk.limits import LEVELS, TOML_BYTES
from sim2d.world.json_lines import deeper_than


def to_toml(config: Config) -> str:
    """All parameters as TOML, with symbol, meaning, unit, range and source as comments."""
    document = tomlkit.document()
    document.add(tomlkit.comment("RatSLAM: every parameter. Read it back with --config FILE."))
    section, table = "", tomlkit.table()
    for name, item, value in config.items():
        group, key = name.split(".")
        if group != section:
            section, table = group, tomlkit.table()
            document.add(section, table)
        table.add(tomlkit.comment(_about(item)))
        table.add(key, value)
    return tomlkit.dumps(document)


def _about(item: Field[Any]) -> str:
    """Symbol, meaning, unit, range and source of a parameter on one line."""
    about = item.metadata
    unit = f" [{about['unit']}]" if about["unit"] else ""
    symbol = f"{about['symbol']}: " if about["symbol"] else ""
    limits = "" if about["low"] is None else f"; {about['low']:g} to {about['high']:g}"
    limits += f"; one of: {', '.join(about['choices'])}" if about["choices"] else ""
    restart = "" if about["live"] else "; takes effect at the next reset"
    return f"{symbol}{about['meaning']}{unit}{limits}; {about['source']}{restart}"


def from_toml(text: str, base: Config | None = None) -> Config:
    """A config from TOML; what is left out is as in `base`, or default. ValueError lists the valid keys."""
    tree = toml_tree(text)
    config, values = base or Config(), dict[str, Value]()
    sections = [item.name for item in fields(config)]
    for section, table in tree.items():
        if section not in sections or not isinstance(table, dict):
            raise ValueError(f"unknown section {section!r}; expected one of: {', '.join(sections)}")
        keys = [item.name for item in fields(getattr(config, section))]
        for key, value in cast(dict[str, Any], table).items():
            if key not in keys:
                raise ValueError(f"unknown parameter '{section}.{key}'; expected one of: {', '.join(keys)}")
            values[f"{section}.{key}"] = value
    return config.with_values(values)


def parse_value(text: str) -> Value:
    """A value from the command line: a TOML literal, or a plain word as text."""
    try:
        value = _toml(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    if not isinstance(value, (float, int, bool, str)):
        raise ValueError(f"{text!r} is not a number, true, false or a word")
    return value


def read_text(path: Path) -> str:
    """The text of a file in TOML. ValueError says why it cannot be read."""
    try:
        with path.open("rb") as file:
            return file.read(4 * TOML_BYTES).decode()  # of what is longer, enough to tell
    except OSError as error:
        raise ValueError(error.strerror or str(error)) from None
    except UnicodeDecodeError as error:
        raise ValueError(f"not valid TOML: {error}") from None


def toml_tree(text: str) -> dict[str, Any]:
    """The tables of a file. ValueError says why they cannot be read: every file in TOML is read here."""
    try:
        return _toml(text)
    except ValueError as error:
        raise ValueError(f"not valid TOML: {error}") from None


def _toml(text: str) -> dict[str, Any]:
    """The parsed text. ValueError also if it is nested so deeply that reading it would exhaust the stack."""
    if len(text) > TOML_BYTES:
        raise ValueError(f"it has more than {TOML_BYTES // 1000} kB")
    try:
        tree = tomllib.loads(text)
        if not deeper_than(LEVELS, tree):
            return tree
    except RecursionError:
        pass
    raise ValueError(f"nested too deeply; at most {LEVELS} tables or lists can lie within one another")
