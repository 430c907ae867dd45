"""The viewer's colours: one colour for one concept, on every plate, in the dark and in the light theme; and which paint shows
as a wanted colour.

viser lights meshes, and then applies a film curve to everything but images. The curve is three.js' ACESFilmicToneMapping
(S. Hill's fit of the Academy's RRT and ODT), inverted here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from web.themes import Theme

Array = NDArray[np.float64]
Rgb = tuple[int, int, int]
WHITE: Rgb = (255, 255, 255)
KEY_AT, RIM_AT = (-8.0, -14.0, 20.0), (12.0, 10.0, 6.0)
RIM_LIGHT, RIM_TINT = 1.2, (170, 200, 255)
UP = (0.0, 0.0, 1.0)
USUAL, LARGE = 1.25, 1.5  # letters for a laptop, where a plate is 400 pixels wide, and for the last row
EXPOSURE = 1 / 0.6
GLOSS = 0.0066  # the share of the light that any mesh reflects, whatever its paint (measured)
BRIGHTEST = 0.94  # of what a screen can show; white itself would need infinite light
_INTO = np.array([(0.59719, 0.35458, 0.04823), (0.07600, 0.90834, 0.01566), (0.02840, 0.13383, 0.83777)])
_OUT_OF = np.array([(1.60475, -0.53108, -0.07367), (-0.10208, 1.10813, -0.00605), (-0.00327, -0.07276, 1.07602)])
# viridis at 20 evenly spaced places (van der Walt and Smith 2015, CC0)
_VIRIDIS = [
    "440154", "481467", "482576", "453781", "404688", "39558C", "33638D", "2D718E", "287D8E", "238A8D",
    "1F968B", "20A386", "29AF7F", "3CBC75", "56C667", "74D055", "94D840", "B8DE29", "DCE318", "FDE725",
]  # fmt: skip


def rgb(colour: str) -> Rgb:
    """`"#RRGGBB"` as three bytes."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def mix(a: Rgb, b: Rgb, share: float) -> Rgb:
    """`share` of the way from `a` to `b`."""
    return tuple(round(p + (q - p) * share) for p, q in zip(a, b, strict=True))  # type: ignore[return-value]


def to_linear(colour: ArrayLike) -> Array:
    """sRGB bytes (..., 3) to light, 0-1."""
    share = np.asarray(colour, np.float64) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def to_srgb(light: Array) -> NDArray[np.uint8]:
    """Light (..., 3) to sRGB bytes."""
    share = np.clip(light, 0, 1)
    bent = np.where(share <= 0.0031308, share * 12.92, 1.055 * share ** (1 / 2.4) - 0.055)
    return np.rint(bent * 255).astype(np.uint8)


def film(light: Array) -> Array:
    """What the renderer shows for light (..., 3) that reaches it."""
    v = np.asarray(light) * EXPOSURE @ _INTO.T
    bent = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081)
    return np.clip(bent @ _OUT_OF.T, 0, 1)


def before_film(shown: Array) -> Array:
    """The light (..., 3) that shows as `shown`; colours out of reach are moved to the nearest one in reach."""
    y = np.clip(np.minimum(shown, BRIGHTEST) @ np.linalg.inv(_OUT_OF).T, 0, 0.99)
    a, b, c = 1 - 0.983729 * y, 0.0245786 - 0.4329510 * y, -0.000090537 - 0.238081 * y
    v = (-b + np.sqrt(b * b - 4 * a * c)) / (2 * a)
    return np.clip(v @ np.linalg.inv(_INTO).T / EXPOSURE, 0, None)


def paint(colour: ArrayLike) -> NDArray[np.uint8]:
    """sRGB paint that shows as `colour` (..., 3) on a line: lines are not lit."""
    return to_srgb(before_film(to_linear(colour)))


def vertex_paint(colour: ArrayLike) -> NDArray[np.uint8]:
    """The same for lines with a colour at each end, whose bytes are taken as linear light."""
    return np.rint(np.clip(before_film(to_linear(colour)), 0, 1) * 255).astype(np.uint8)


def _lit_paint(colour: ArrayLike, light: ArrayLike) -> NDArray[np.uint8]:
    """sRGB paint that shows as `colour` (..., 3) on a mesh that `light` falls on."""
    return to_srgb(before_film(to_linear(colour)) / np.asarray(light) - GLOSS)


def _linear_paint(colour: ArrayLike, light: ArrayLike) -> NDArray[np.uint8]:
    """The same for batched meshes, whose bytes are taken as linear light."""
    share = before_film(to_linear(colour)) / np.asarray(light) - GLOSS
    return np.rint(np.clip(share, 0, 1) * 255).astype(np.uint8)


@dataclass(frozen=True)
class Palette:
    """Every colour of one theme, and how large its letters are."""

    dark: bool
    sky_top: Rgb
    sky_bottom: Rgb
    slab: Rgb
    sheet: Rgb
    floor: Rgb
    grid: Rgb
    text: Rgb
    text_2: Rgb
    packet_path: Rgb
    rim: Rgb
    wall: Rgb
    partition: Rgb
    desk: Rgb
    robot: Rgb
    turret: Rgb
    tyre: Rgb
    goal: Rgb
    on_goal: Rgb  # text on the goal's colour
    wedge: Rgb
    wedge_opacity: float
    sonar: Rgb
    true_path: Rgb
    packets: tuple[Rgb, Rgb, Rgb, Rgb]
    voxels: tuple[Rgb, Rgb, Rgb, Rgb]
    on_packet: Rgb
    glass: Rgb
    glass_edge: Rgb
    glass_opacity: float
    route: Rgb
    casing: Rgb
    link: Rgb
    free: Rgb  # floor that the sonars found free
    occupied: Rgb  # where they met something
    unknown: Rgb  # experiences without a known time
    pole: Rgb
    viridis: tuple[float, float]
    ambient: float
    key: float
    shadow: float
    letters: float = USUAL

    def times(self, seconds: NDArray[np.float32], longest_s: float) -> NDArray[np.uint8]:
        """(n, 3) colours: bright at 0 s, deep at `longest_s`, `unknown` where no way is known."""
        known = np.isfinite(seconds)
        share = np.clip(np.where(known, seconds, 0.0) / max(longest_s, 1e-6), 0.0, 1.0)
        index = (share * (len(self.ramp) - 1)).astype(np.int64)
        return np.where(known[:, None], self.ramp[index], np.array(self.unknown, np.uint8))

    def light_on(self, normal: tuple[float, float, float] = UP) -> NDArray[np.float64]:
        """(3,) how bright this theme's lights make a white mesh that faces `normal`."""
        light = np.full(3, self.ambient)
        for strength, tint, place in ((self.key, WHITE, KEY_AT), (RIM_LIGHT, RIM_TINT, RIM_AT)):
            falling = max(0.0, float(np.dot(normal, place) / np.linalg.norm(place)))
            light += strength * falling * to_linear(tint)
        return light / np.pi

    def lit(self, colour: Rgb, normal: tuple[float, float, float] = UP) -> Rgb:
        """The paint that shows as `colour` on a mesh that faces `normal`."""
        red, green, blue = _lit_paint(colour, self.light_on(normal)).tolist()
        return red, green, blue

    def batched(self, colours: ArrayLike) -> NDArray[np.uint8]:
        """(n, 3) paints that show as `colours` on the upper sides of batched meshes."""
        return _linear_paint(colours, self.light_on())

    def drawn(self, colour: Rgb) -> Rgb:
        """The paint that shows as `colour` on a line."""
        red, green, blue = paint(colour).tolist()
        return red, green, blue

    @property
    def ramp(self) -> NDArray[np.uint8]:
        """(256, 3) trimmed viridis, from near to far."""
        return _RAMPS[self.dark]


def _ramp(low: float, high: float) -> NDArray[np.uint8]:
    table = np.array([rgb("#" + stop) for stop in _VIRIDIS], np.float64)
    places = np.linspace(high, low, 256)
    steps = np.linspace(0, 1, len(table))
    return np.stack([np.interp(places, steps, table[:, k]) for k in range(3)], 1).round().astype(np.uint8)


DARK = Palette(
    dark=True,
    sky_top=rgb("#0B0F15"),
    sky_bottom=rgb("#1A212C"),
    slab=rgb("#2B3544"),
    sheet=rgb("#182029"),
    floor=rgb("#252E3B"),
    grid=rgb("#313C4B"),
    text=rgb("#E8EDF4"),
    text_2=rgb("#97A5B8"),
    packet_path=rgb("#E8EDF4"),
    rim=rgb("#4A5970"),
    wall=rgb("#7C8BA1"),
    partition=rgb("#566579"),
    desk=rgb("#8A6A4A"),
    robot=rgb("#FF7A3D"),
    turret=rgb("#E8EDF4"),
    tyre=rgb("#10151C"),
    goal=rgb("#FF5DA8"),
    on_goal=rgb("#2A0A1B"),
    wedge=rgb("#FFB547"),
    wedge_opacity=0.24,
    sonar=rgb("#7FE0D0"),
    true_path=rgb("#9FB0C6"),
    packets=(rgb("#FFC04D"), rgb("#4CC9F0"), rgb("#B9A5FF"), rgb("#8FE388")),
    voxels=(rgb("#FFB83D"), rgb("#3CC4FF"), rgb("#A68CFF"), rgb("#6FD968")),
    on_packet=rgb("#10151C"),
    glass=rgb("#6FA8DC"),
    glass_edge=rgb("#8CC0EA"),
    glass_opacity=0.10,
    route=rgb("#FFFFFF"),
    casing=rgb("#0B0F15"),
    link=rgb("#5A6B82"),
    free=rgb("#41506A"),
    occupied=rgb("#090D13"),
    unknown=rgb("#76859A"),
    pole=rgb("#D7DEE8"),
    viridis=(0.14, 1.0),
    ambient=4.2,
    key=5.6,
    shadow=0.55,
)

LIGHT = Palette(
    dark=False,
    sky_top=rgb("#F7F8FA"),
    sky_bottom=rgb("#DDE3EA"),
    slab=rgb("#C9D2DC"),
    sheet=rgb("#FFFFFF"),
    floor=rgb("#E6EBF1"),
    grid=rgb("#D5DCE5"),
    text=rgb("#1B2430"),
    text_2=rgb("#5C6B7E"),
    packet_path=rgb("#6B798B"),
    rim=rgb("#8FA0B5"),
    wall=rgb("#8FA0B5"),
    partition=rgb("#9FB0C4"),
    desk=rgb("#C99A62"),
    robot=rgb("#E4501B"),
    turret=rgb("#F4F6F9"),
    tyre=rgb("#1B2430"),
    goal=rgb("#C2257A"),
    on_goal=rgb("#FFFFFF"),
    wedge=rgb("#F3A64A"),
    wedge_opacity=0.36,
    sonar=rgb("#0F8F80"),
    true_path=rgb("#7E8FA5"),
    packets=(rgb("#D98300"), rgb("#0E7FB8"), rgb("#6A4FC4"), rgb("#2F8F2A")),
    voxels=(rgb("#E07B00"), rgb("#0078B8"), rgb("#5B3FC0"), rgb("#1F7F1A")),
    on_packet=rgb("#FFFFFF"),
    glass=rgb("#5B8FC7"),
    glass_edge=rgb("#4F86C0"),
    glass_opacity=0.12,
    route=rgb("#111827"),
    casing=rgb("#FFFFFF"),
    link=rgb("#B4BFCC"),
    free=rgb("#FFFFFF"),
    occupied=rgb("#55647A"),
    unknown=rgb("#B0BBC8"),
    pole=rgb("#1B2430"),
    viridis=(0.0, 0.86),
    ambient=6.4,
    key=5.2,
    shadow=0.22,
)

BRAINS: dict[bool, tuple[Rgb, Rgb]] = {  # of the first and of the second, in the dark theme and in the light one
    True: ((94, 226, 160), (190, 160, 255)),
    False: ((0, 112, 74), (104, 66, 196)),
}

_RAMPS = {palette.dark: _ramp(*palette.viridis) for palette in (DARK, LIGHT)}


def palette_of(theme: Theme, large: bool = False) -> Palette:
    palette = {"dark": DARK, "light": LIGHT}[theme]
    return replace(palette, letters=LARGE) if large else palette
