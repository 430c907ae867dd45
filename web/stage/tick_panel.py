"""Tick: one tick stage by stage, and what the parts of a tick cost."""

from __future__ import annotations

import html
from collections.abc import Callable
from typing import Any

import viser

from web.messages import Command, Refused, Resume, Step, StepStage, TickWalk, Timing
from web.stage import markup
from web.stage.hand import Answer
from web.stage.palette import Palette, Rgb

BACK, NEXT, TICK, PLAY = "back", "next stage", "tick", "play"
NOTHING = "Press next stage: the session pauses, and you go through one tick and see what each stage did."
TRUE = "The tick is computed as always, whole and in this order; pose cells and map show how they were at each stage."
TICK_MS = 100.0


class TickPanel:
    def __init__(
        self,
        gui: viser.GuiApi,
        palette: Palette,
        send: Callable[[Command, Callable[[Answer], None]], None],
        complain: Callable[[int, str, str], None],
    ) -> None:
        self.palette = palette
        self._send, self._complain = send, complain
        self._buttons = gui.add_button_group("go", (BACK, NEXT, TICK, PLAY), hint="The keys: comma and full stop.")
        self._walk = gui.add_html("")
        self._timings = gui.add_html("")
        self._buttons.on_click(self._pressed)

    def draw_walk(self, walk: TickWalk | None) -> None:
        self._walk.content = markup.page(*walk_page(walk, self.palette))

    def draw_timings(self, timings: tuple[Timing, ...]) -> None:
        self._timings.content = markup.page(*timings_page(timings, self.palette))

    def _pressed(self, event: viser.GuiEvent[Any]) -> None:
        client_id = event.client_id
        if client_id is None:
            return
        orders: dict[str, Command] = {
            BACK: StepStage(type="step_stage", back=True),
            NEXT: StepStage(type="step_stage"),
            TICK: Step(type="step"),
            PLAY: Resume(type="resume"),
        }

        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                self._complain(client_id, "Not done", answer.reason)

        self._send(orders[event.target.value], answered)


def walk_page(walk: TickWalk | None, palette: Palette) -> list[str]:
    if walk is None:
        return [markup.heading("One tick, stage by stage"), markup.note(NOTHING)]
    parts = [markup.heading(f"Stage {walk.at + 1} of {len(walk.stages)}")]
    for k, stage in enumerate(walk.stages):
        parts.append(
            _stage(f"{k + 1}  {stage.title}", stage.words if k <= walk.at else "", k == walk.at, palette.robot)
        )
    return [*parts, markup.note(TRUE)]


def _stage(title: str, words: str, now: bool, colour: Rgb) -> str:
    """Those to come without words, that of now with a bar beside it."""
    edge = markup.css(colour) if now else "transparent"
    style = f"border-left:3px solid {edge};padding:1px 0 1px 8px;margin:3px 0"
    said = f'<div style="opacity:{0.95 if now else 0.7};font-size:12px">{html.escape(words)}</div>' if words else ""
    weight = "700" if now else "500" if words else "400"
    return (
        f'<div style="{style}"><div style="font-weight:{weight};opacity:{1 if words else 0.55}">'
        f"{html.escape(title)}</div>{said}</div>"
    )


def timings_page(timings: tuple[Timing, ...], palette: Palette) -> list[str]:
    """Milliseconds of each part over the last hundred ticks, as bars against the dearest."""
    total = sum(timing.mean_ms for timing in timings)
    dearest = max((timing.mean_ms for timing in timings), default=0.0)
    parts = [
        markup.heading(f"A tick takes {total:.2f} of its {TICK_MS:.0f} ms"),
        markup.note("Mean and worst of the last hundred ticks, measured beside the engine."),
    ]
    for timing in timings:
        words = (
            f"<span>{html.escape(timing.part)}</span><span>{timing.mean_ms:.2f}, worst {timing.worst_ms:.1f} ms</span>"
        )
        style = (
            "display:flex;justify-content:space-between;font-size:12px;font-variant-numeric:tabular-nums;margin-top:4px"
        )
        parts.append(f'<div style="{style}">{words}</div>')
        parts.append(markup.bar(timing.mean_ms / max(dearest, 1e-9), palette.packets[1], palette.text_2, height_px=5))
    return parts
