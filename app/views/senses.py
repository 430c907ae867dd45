"""What the robot senses, which view it recognises, and views and packets as people are shown them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.session import Session
from app.views.arrays import frozen
from ratslam_core import Packet, RatSlam
from web import messages as m

_NO_PICTURE: NDArray[np.uint8] = frozen(np.zeros((0, 0, 3), np.uint8))


def camera_image(session: Session) -> NDArray[np.uint8]:
    """(h, w, 3) what the camera sees; without pixels while it is off."""
    return session.frame.image if session.config.robot.camera else _NO_PICTURE


def senses_of(session: Session) -> m.Senses:
    recognition, local_view = session.estimate.recognition, session.brain.local_view
    best, front_end = recognition.best_view, local_view.front_end
    stored = local_view.stored(best) if best >= 0 else None
    return m.Senses(
        camera=camera_image(session),
        front_end=local_view.params.front_end,
        seen=frozen(front_end.picture(local_view.features).copy()),
        seen_words=front_end.words(local_view.features),
        best=None if stored is None else frozen(front_end.picture(stored).copy()),
        best_words="" if stored is None else front_end.words(stored),
        best_view=best,
        difference=recognition.difference,
        threshold=local_view.threshold,
        active_view=recognition.view,
        recruited=recognition.recruited,
        false_positive=recognition.false_positive,
        false_positives=local_view.false_positives,
        ranges_m=session.frame.ranges_m,
    )


def stored_picture(brain: RatSlam, view: int) -> NDArray[np.uint8]:
    """A stored view as an image for people."""
    return frozen(brain.local_view.front_end.picture(brain.local_view.stored(view)).copy())


def present_picture(brain: RatSlam) -> NDArray[np.uint8]:
    return frozen(brain.local_view.front_end.picture(brain.local_view.features).copy())


def packet_of(packet: Packet) -> m.Packet:
    """A packet of the engine as one that is shown."""
    return m.Packet(packet.x, packet.y, packet.heading_rad, packet.mass, packet.id)
