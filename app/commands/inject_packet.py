"""Put a packet of activity into the pose cells by hand and watch it compete."""

from __future__ import annotations

from app.commands.outcome import Outcome, attempt
from app.engine.engine import Engine
from web.messages import InjectPacket


def inject_packet(engine: Engine, command: InjectPacket) -> Outcome:
    run, c = engine.run, command

    def inject() -> None:
        run.event_log.note("packet", run.session.put_packet(c.x, c.y, c.heading_rad, c.share))
        run.snapshots.walk = None  # it shows the pose cells as they were before the packet

    return attempt("x, y", (c.x, c.y), inject)
