"""Views and packets of a brain as people are shown them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.views.arrays import frozen
from ratslam_core import Packet, RatSlam
from web import messages as m


def stored_picture(brain: RatSlam, view: int) -> NDArray[np.uint8]:
    """A stored view as an image for people."""
    return frozen(brain.local_view.front_end.picture(brain.local_view.stored(view)).copy())


def present_picture(brain: RatSlam) -> NDArray[np.uint8]:
    return frozen(brain.local_view.front_end.picture(brain.local_view.features).copy())


def packet_of(packet: Packet) -> m.Packet:
    """A packet of the engine as one that is shown."""
    return m.Packet(packet.x, packet.y, packet.heading_rad, packet.mass, packet.id)
