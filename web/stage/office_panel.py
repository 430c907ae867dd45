"""Office: what lives there and whether it does, one switch each; the robot's presets. A refusal takes a switch back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import viser

from web.messages import Command, LivingLayer, Parameter, Refused, SetDoor, SetLamp, SetParameter, UsePreset
from web.stage import markup
from web.stage.hand import Answer
from web.stage.tune_panel import hint, label

OWN = "own settings"
MOST = 40  # switches of one kind; beyond that a click on the door itself will do


@dataclass
class _Switch:
    handle: Any
    value: bool | int  # as the session last said
    command: Callable[[Any], Command]


class OfficePanel:
    def __init__(
        self,
        gui: viser.GuiApi,
        tab: viser.GuiTabHandle,
        send: Callable[[Command, Callable[[Answer], None]], None],
        complain: Callable[[int, str, str], None],
    ) -> None:
        self._gui, self._tab, self._send, self._complain = gui, tab, send, complain
        self._preset: Any = None
        self._known_preset = ""
        with tab:
            self._page = gui.add_html("")
        self._switches: dict[tuple[str, str], _Switch] = {}
        self._folders: list[viser.GuiFolderHandle] = []
        self._made: tuple[object, ...] = ()
        self._turned: dict[tuple[str, str], tuple[int, Any]] = {}  # by people, not sent yet: browser, value

    def follow(
        self, layer: LivingLayer | None, rows: tuple[Parameter, ...], presets: tuple[str, ...], preset: str
    ) -> None:
        """Builds the switches when the names are new; else sets those that have changed elsewhere."""
        parameters = {p.name: p for p in rows if p.name.startswith("office.")}
        doors, lamps = ((), ()) if layer is None else (layer.door_names[:MOST], layer.lamp_names[:MOST])
        now: dict[tuple[str, str], Any] = {("parameter", name): p.value for name, p in parameters.items()}
        if layer is not None:
            now |= {("door", name): bool(on) for name, on in zip(layer.door_names, layer.door_wanted, strict=True)}
            now |= {("lamp", name): bool(on) for name, on in zip(layer.lamp_names, layer.lamp_on, strict=True)}
        made = (tuple(parameters), doors, lamps, presets)
        if made != self._made:
            self._made = made
            self._build(presets, preset, list(parameters.values()), doors, lamps, now)
        for key, switch in self._switches.items():
            if now[key] != switch.value:
                switch.value = now[key]
                if key not in self._turned:
                    switch.handle.value = now[key]
        if self._preset is not None and preset != self._known_preset:
            self._known_preset = preset
            self._show_preset()
        self._page.content = markup.page(markup.note(_words(layer)))

    def send_pending(self) -> None:
        """Submits what people turned."""
        for key, (client_id, value) in [(k, self._turned.pop(k)) for k in list(self._turned)]:
            if key[0] == "preset":
                if value != OWN:
                    self._submit(client_id, UsePreset(type="use_preset", name=value), self._show_preset)
                else:
                    self._show_preset()
            elif key in self._switches:
                self._submit(client_id, self._switches[key].command(value), partial(self._show_switch, key))

    def _show_preset(self) -> None:
        self._preset.value = self._known_preset or OWN

    def _show_switch(self, key: tuple[str, str]) -> None:
        if key in self._switches:  # the world may be another one by now
            self._switches[key].handle.value = self._switches[key].value

    def _submit(self, client_id: int, command: Command, take_back: Callable[[], object]) -> None:
        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                take_back()
                self._complain(client_id, "The office stays as it is", answer.reason)

        self._send(command, answered)

    # ------------------------------------------------------------ widgets

    def _build(
        self,
        presets: tuple[str, ...],
        preset: str,
        parameters: list[Parameter],
        doors: tuple[str, ...],
        lamps: tuple[str, ...],
        now: dict[tuple[str, str], Any],
    ) -> None:
        """Every switch is made with its value: one that is made, set and removed within a frame of a slow browser is an
        error in viser's client, which applies values last."""
        for folder in self._folders:
            folder.remove()
        self._folders, self._switches, self._preset, self._known_preset = [], {}, None, preset
        if presets:
            with self._folder("robot"):
                words = "Sets the robot's sensors and encoders; the Tune tab shows to what."
                self._preset = self._gui.add_dropdown(
                    "preset", (OWN, *presets), initial_value=preset or OWN, hint=words
                )
                self._watch(("preset", ""), self._preset)
        with self._folder("what lives"):
            for parameter in parameters:
                self._add_parameter(parameter)
        for kind, names, make in (("door", doors, _door_command), ("lamp", lamps, _lamp_command)):
            if names:
                with self._folder(f"{kind}s"):
                    for name in names:
                        words = "Open or shut; a click on the leaf does the same." if kind == "door" else "On or off."
                        self._add((kind, name), self._gui.add_checkbox(name, now[kind, name], hint=words), make(name))

    def _folder(self, words: str) -> viser.GuiFolderHandle:
        with self._tab:
            self._folders.append(self._gui.add_folder(words))
        return self._folders[-1]

    def _add_parameter(self, parameter: Parameter) -> None:
        name, value, words = label(parameter), parameter.value, hint(parameter)
        if isinstance(value, bool):
            handle = self._gui.add_checkbox(name, value, hint=words)
        else:
            low, high = (None if limit is None else int(limit) for limit in (parameter.low, parameter.high))
            handle = self._gui.add_number(name, int(value), min=low, max=high, step=1, hint=words)
        key = ("parameter", parameter.name)
        self._add(key, handle, lambda v: SetParameter(type="set_parameter", name=parameter.name, value=v))

    def _add(self, key: tuple[str, str], handle: Any, command: Callable[[Any], Command]) -> None:
        self._switches[key] = _Switch(handle, handle.value, command)
        self._watch(key, handle)

    def _watch(self, key: tuple[str, str], handle: Any) -> None:
        @handle.on_update
        def _(event: viser.GuiEvent[Any]) -> None:
            if event.client_id is not None:  # a person, not `follow`
                self._turned[key] = (event.client_id, event.target.value)


def _door_command(name: str) -> Callable[[Any], Command]:
    return lambda is_open: SetDoor(type="set_door", name=name, open=bool(is_open))


def _lamp_command(name: str) -> Callable[[Any], Command]:
    return lambda on: SetLamp(type="set_lamp", name=name, on=bool(on))


def _words(layer: LivingLayer | None) -> str:
    if layer is None:
        return "Nothing lives in this world: it has no doors, lamps, boxes or people."
    counts = ((len(layer.people), "person", "people"), (len(layer.boxes), "box", "boxes"))
    there = ", ".join(f"{count} {one if count == 1 else many}" for count, one, many in counts)
    shut = int((layer.door_opening < 1.0).sum())
    return (
        f"Here now: {there}; {shut} of {len(layer.doors)} doors not open; {int((layer.lamps[:, 3] > 0).sum())} of "
        f"{len(layer.lamps)} lamps lit; daylight {layer.daylight:.2f}."
    )
