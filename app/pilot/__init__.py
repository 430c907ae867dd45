"""The pilot: it explores, avoids obstacles, follows routes, obeys the hand and gets free when stuck."""

from app.pilot.params import PilotParams
from app.pilot.pilot import Mode, Pilot
from app.pilot.route_following import Progress

__all__ = ["Mode", "Pilot", "PilotParams", "Progress"]
