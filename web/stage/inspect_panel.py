"""Inspect: one experience, view or column of pose cells, chosen on the stage, by number or by what is active now."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import viser

from web.messages import (
    CellReport,
    Command,
    ExperienceReport,
    InjectPacket,
    Inspect,
    Refused,
    Report,
    Snapshot,
    ViewReport,
)
from web.stage import markup
from web.stage.hand import Answer
from web.stage.inspect_pages import report_page

HERE, VIEW, NONE = "experience", "view", "nothing"
NOTHING = (
    "Nothing is chosen. Hold shift and click on the map: the experience there is shown, with all that the robot knows of "
    "it. Click into the pose cells: what is active there, and which views lead there."
)


class InspectPanel:
    """One choice for all who look: it is the engine's, and comes back with the snapshots."""

    def __init__(
        self,
        gui: viser.GuiApi,
        send: Callable[[Command, Callable[[Answer], None]], None],
        complain: Callable[[int, str, str], None],
    ) -> None:
        self._send, self._complain = send, complain
        self._snapshot: Snapshot | None = None
        self._switch = gui.add_checkbox(
            "click inspects",
            False,
            hint="A click on the map, instead of sending the robot there. With shift it always does.",
        )
        self._now = gui.add_button_group(
            "active now", (HERE, VIEW, NONE), hint="Look at what is active at this moment."
        )
        self._experience = gui.add_number(
            "experience #", 0, min=0, step=1, hint="Look at the experience of this number."
        )
        self._view = gui.add_number("view #", 0, min=0, step=1, hint="Look at the view of this number.")
        self._page = gui.add_html("")
        with gui.add_folder("Inject a packet here", expand_by_default=True, visible=False) as self._packet:
            gui.add_html(markup.page(markup.note("No sense says it: watch how it competes with the others.")))
            self._heading = gui.add_slider("heading θ′ [°]", 0, 350, 10, 0)
            self._share = gui.add_slider(
                "share [%]", 5, 90, 5, 45, hint="Of all activity, right after it is put there."
            )
            gui.add_button("Inject").on_click(self._inject)
        self._cell: CellReport | None = None
        self._now.on_click(self._pressed)
        self._experience.on_update(lambda event: self._typed(event, "experience"))
        self._view.on_update(lambda event: self._typed(event, "view"))

    @property
    def click_inspects(self) -> bool:
        return bool(self._switch.value)

    def choose(self, client_id: int, **wish: int | None) -> None:
        """What to look at, by the fields of `Inspect`."""

        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                self._complain(client_id, "Nothing to inspect", answer.reason)

        self._send(Inspect(type="inspect", **wish), answered)  # type: ignore[arg-type]

    def remember(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot

    def draw(self, report: Report | None) -> None:
        self._page.content = markup.page(markup.note(NOTHING)) if report is None else report_page(report)
        self._cell = report if isinstance(report, CellReport) else None
        self._packet.visible = self._cell is not None
        for kind, field in ((ExperienceReport, self._experience), (ViewReport, self._view)):
            if isinstance(report, kind) and field.value != report.id:
                field.value = report.id

    def _inject(self, event: viser.GuiEvent[Any]) -> None:
        client_id, cell = event.client_id, self._cell
        if client_id is None or cell is None:
            return

        def answered(answer: Answer) -> None:
            if isinstance(answer, Refused):
                self._complain(client_id, "No packet injected", answer.reason)

        heading, share = math.radians(self._heading.value), self._share.value / 100
        wish = InjectPacket(type="inject_packet", x=cell.x, y=cell.y, heading_rad=heading, share=share)
        self._send(wish, answered)

    def _typed(self, event: viser.GuiEvent[Any], field: str) -> None:
        if event.client_id is not None:  # a person
            self.choose(event.client_id, **{field: int(event.target.value)})

    def _pressed(self, event: viser.GuiEvent[Any]) -> None:
        snapshot = self._snapshot
        if event.client_id is None or snapshot is None:
            return
        if event.target.value == HERE:
            self.choose(event.client_id, experience=snapshot.active_experience)
        elif event.target.value == NONE:
            self.choose(event.client_id)
        elif max(snapshot.senses.active_view, snapshot.senses.best_view) < 0:
            self._complain(event.client_id, "Nothing to inspect", "there is no view yet: nothing has been seen")
        else:
            active, best = snapshot.senses.active_view, snapshot.senses.best_view
            self.choose(event.client_id, view=active if active >= 0 else best)
