"""All parameters in one frozen tree, written to and read from TOML, and presets."""

from app.config.additions import additions_markdown
from app.config.table import to_markdown
from app.config.toml_file import from_toml, parse_value, to_toml
from app.config.tree import Config, Value

__all__ = ["Config", "Value", "additions_markdown", "from_toml", "parse_value", "to_markdown", "to_toml"]
