"""`ratslam config`: every parameter with its meaning."""

from __future__ import annotations

import argparse

from app.cli.options import Verbs, add_config_options, config_of
from app.config import Config, to_markdown, to_toml


def add_config(commands: Verbs) -> None:
    config = commands.add_parser("config", help="print every parameter as TOML with symbol, unit and source")
    config.add_argument("--table", action="store_true", help="print them as Markdown tables instead")
    add_config_options(config)
    config.set_defaults(do=_config)


def _config(args: argparse.Namespace) -> int:
    write = to_markdown if args.table else to_toml
    print(write(config_of(args, Config())), end="")
    return 0
