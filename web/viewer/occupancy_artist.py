"""Draws what the sonars met in a thread of its own, since that may take longer than a frame."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from web.messages import OccupancyLayer, OccupancyPicture
from web.switches import Switches
from web.viewer.plates.map_plate import MapPlate


class OccupancyArtist:
    """`post` brings what is drawn back to the viewer's thread."""

    def __init__(self, plate: MapPlate, switches: Switches, post: Callable[[Callable[[], None]], None]) -> None:
        self._plate, self._switches, self._post = plate, switches, post
        self._artist = ThreadPoolExecutor(1, "artist")
        self.drawing = False

    def draw(self, layer: OccupancyLayer | None) -> None:
        """If the switch is off by the time the picture is done, it is dropped."""
        if layer is None:
            self._plate.set_occupancy(None)
            return
        self.drawing = True

        def drawn(future: Future[OccupancyPicture]) -> None:
            if not future.cancelled():
                self._post(lambda: self._lay(future))

        self._artist.submit(layer.draw_map).add_done_callback(drawn)

    def stop(self) -> None:
        self._artist.shutdown(cancel_futures=True)

    def _lay(self, future: Future[OccupancyPicture]) -> None:
        self.drawing = False
        if self._switches.is_on("occupancy"):
            self._plate.set_occupancy(future.result())
