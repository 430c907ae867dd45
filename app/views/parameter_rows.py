"""All parameters with their descriptions, and the preset whose values they have."""

from __future__ import annotations

from typing import cast

from app.config import Config, Value
from app.config.presets import preset_of
from app.played_session import NOT_RECORDED
from web.messages import Parameter


class ParameterRows:
    """Builds the rows anew only when the config has changed."""

    def __init__(self) -> None:
        self._config: Config | None = None
        self._rows: tuple[Parameter, ...] = ()
        self._preset = ""

    def of(self, config: Config, recorded: bool = False) -> tuple[tuple[Parameter, ...], str]:
        """All parameters, and the name of the preset whose values they have, or "".

        recorded: without those of the simulator and the pilot, which a recording does not have.
        """
        if self._config is not config:
            self._config, self._preset = config, preset_of(config)
            self._rows = tuple(
                Parameter(name=name, value=value, default=cast(Value, item.default), **item.metadata)
                for name, item, value in config.items()
                if not (recorded and name.split(".")[0] in NOT_RECORDED)
            )
        return self._rows, self._preset
