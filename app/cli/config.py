"""`ratslam config`: every parameter with its meaning."""

from __future__ import annotations

import argparse

from app.cli.options import Verbs, add_config_options, config_of


def add_config(commands: Verbs) -> None:
    config = commands.add_parser("config", help="print every parameter as TOML with symbol, unit and source")
    pages = config.add_mutually_exclusive_group()
    pages.add_argument("--table", action="store_true", help="print them as Markdown tables instead")
    pages.add_argument(
        "--additions", action="store_true", help="print what is ours beyond the papers, as a Markdown table"
    )
    add_config_options(config)
    config.set_defaults(do=_config)


def _config(args: argparse.Namespace) -> int:
    from app.config import Config, additions_markdown, to_markdown, to_toml

    config = config_of(args, Config())
    text = additions_markdown() if args.additions else to_markdown(config) if args.table else to_toml(config)
    print(text, end="")
    return 0
