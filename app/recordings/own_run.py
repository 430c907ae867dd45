"""A run of ours that was exported and is played as a recording: it brings its parameters and its seed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from app.recordings.recording import About, Moment, Recording, Wanted, every


class OwnRun:
    """With these, the same views, experiences and links come out as in the run."""

    def __init__(self, recording: Recording, said: dict[str, str]) -> None:
        """said: what the run says of itself, as `app/export/mcap_file.py` writes it."""
        from app.config.toml_file import from_toml  # which needs the engine, and most recordings do not

        self._recording = recording
        self._problems: tuple[str, ...] = ()
        self._config, self._seed = None, None
        try:
            self._config, self._seed = from_toml(said["config"]), int(said["seed"])
        except (KeyError, ValueError) as error:
            self._problems = (f"the parameters of this run cannot be used, and rules take their place: {error}",)

    @property
    def about(self) -> About:
        about = self._recording.about
        uses = about.uses if self._config is None else (*about.uses, "parameters and seed: those of the run")
        return replace(
            about, uses=uses, problems=(*about.problems, *self._problems), config=self._config, seed=self._seed
        )

    def moments(self, wanted: Wanted = every) -> Iterator[Moment]:
        return self._recording.moments(wanted)
