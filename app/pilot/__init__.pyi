from .params import PilotParams
from .pilot import Mode, Pilot
from .route_following import Progress

__all__ = ["Mode", "Pilot", "PilotParams", "Progress"]
