from .tables import additions_markdown, to_markdown
from .toml_file import from_toml, parse_value, to_toml
from .tree import Config, Value

__all__ = ["Config", "Value", "additions_markdown", "from_toml", "parse_value", "to_markdown", "to_toml"]
