"""Tune: every parameter with its symbol, unit, range and meaning; a change is a command, a refusal takes it back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import viser

from web.messages import Command, Parameter, Refused, SetParameter
from web.stage import markup
from web.stage.hand import Answer

Value = float | int | bool | str
EVERY_S = 0.2  # a dragged slider sends no more often


@dataclass
class _Knob:
    handle: Any
    parameter: Parameter


class TunePanel:
    def __init__(
        self,
        gui: viser.GuiApi,
        tab: viser.GuiTabHandle,
        send: Callable[[Command, Callable[[Answer], None]], None],
        complain: Callable[[int, str, str], None],
    ) -> None:
        self._gui, self._tab, self._send, self._complain = gui, tab, send, complain
        with tab:
            gui.add_html(markup.page(markup.note("Point at a name for its meaning. ↻ takes effect at reset.")))
        self._knobs: dict[str, _Knob] = {}
        self._folders: list[viser.GuiFolderHandle] = []
        self._turned: dict[str, tuple[int, Value]] = {}  # by people since the last send: browser, value
        self._next_s = 0.0

    def follow(self, parameters: tuple[Parameter, ...]) -> None:
        """Builds the knobs when the names are new; else sets those whose value changed elsewhere."""
        if [p.name for p in parameters] != list(self._knobs):
            self._build(parameters)
        for parameter in parameters:
            knob = self._knobs[parameter.name]
            if knob.parameter.value != parameter.value and parameter.name not in self._turned:
                _set(knob.handle, parameter.value)
            knob.parameter = parameter

    def send_pending(self, now_s: float) -> None:
        """Submits what people turned, the newest value of each knob."""
        if now_s < self._next_s or not self._turned:
            return
        self._next_s = now_s + EVERY_S
        for name, (client_id, value) in [(n, self._turned.pop(n)) for n in list(self._turned)]:
            self._submit(name, client_id, value)

    def _submit(self, name: str, client_id: int, value: Value) -> None:
        knob = self._knobs.get(name)
        if knob is None:
            return

        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                _set(knob.handle, knob.parameter.value)
                self._complain(client_id, name, answer.reason)

        self._send(SetParameter(type="set_parameter", name=name, value=value), answered)

    def _build(self, parameters: tuple[Parameter, ...]) -> None:
        for folder in self._folders:
            folder.remove()
        self._folders, self._knobs = [], {}
        groups: dict[str, list[Parameter]] = {}
        for parameter in parameters:
            groups.setdefault(parameter.name.rpartition(".")[0], []).append(parameter)
        knobs: dict[str, _Knob] = {}
        for group, members in groups.items():
            with (
                self._tab,
                self._gui.add_folder(group.replace("_", " ") or "all", expand_by_default=not self._folders) as folder,
            ):
                self._folders.append(folder)
                for parameter in members:
                    knobs[parameter.name] = self._add(parameter)
        self._knobs = {p.name: knobs[p.name] for p in parameters}

    def _add(self, parameter: Parameter) -> _Knob:
        handle = _widget(self._gui, parameter)

        @handle.on_update
        def _(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:  # a person, not `follow`
                self._turned[parameter.name] = (event.client_id, event.target.value)

        return _Knob(handle, parameter)


def label(parameter: Parameter) -> str:
    name = parameter.name.rpartition(".")[2].replace("_", " ")
    symbol = f" {parameter.symbol}" if parameter.symbol else ""
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return f"{name}{symbol}{unit}{'' if parameter.live else ' ↻'}"


def hint(parameter: Parameter) -> str:
    """Meaning, range, default and source, and whether a change waits for the next reset."""
    low, high = parameter.low, parameter.high
    parts = [parameter.meaning[:1].upper() + parameter.meaning[1:] + "."]
    if low is not None or high is not None:
        parts.append(
            f"Range: {'' if low is None else f'{low:g}'} to {'' if high is None else f'{high:g}'} {parameter.unit}."
        )
    if parameter.choices:
        parts.append(f"One of: {', '.join(parameter.choices)}.")
    parts.append(f"Default: {parameter.default}. Source: {parameter.source}.")
    if not parameter.live:
        parts.append("Takes effect at reset.")
    return " ".join(parts)


def _widget(gui: viser.GuiApi, parameter: Parameter) -> Any:
    value, name, words = parameter.value, label(parameter), hint(parameter)
    if isinstance(value, bool):
        return gui.add_checkbox(name, value, hint=words)
    if parameter.choices:
        return gui.add_dropdown(name, parameter.choices, initial_value=str(value), hint=words)
    if isinstance(value, str):
        return gui.add_text(name, value, hint=words)
    low, high = parameter.low, parameter.high
    kind = int if isinstance(value, int) else float
    limits = {"min": None if low is None else kind(low), "max": None if high is None else kind(high)}
    return gui.add_number(name, value, step=_step(parameter), hint=words, **limits)  # type: ignore[arg-type]


def _step(parameter: Parameter) -> float | int:
    """A hundredth of the range, rounded down to 1, 2 or 5; whole numbers go by one."""
    if isinstance(parameter.value, int):
        return 1
    span = abs(float(parameter.default)) / 2 or 1.0
    if parameter.low is not None and parameter.high is not None:
        span = min(
            parameter.high - parameter.low, 10 * (abs(float(parameter.default)) or parameter.high - parameter.low)
        )
    decade = 10.0 ** int(f"{max(span, 1e-12) / 100:e}".split("e")[1])
    digit = max(d for d in (1, 2, 5) if d * decade <= span / 100 + 1e-15)
    return digit * decade


def _set(handle: Any, value: Value) -> None:
    """The widget's value; setting what it shows already sends nothing."""
    handle.value = value
