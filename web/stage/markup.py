"""Small pieces of HTML for the side panel: text that inherits the page's colours, pictures with sharp pixels, bars."""

from __future__ import annotations

import base64
import html

import cv2
import numpy as np

from web.stage.images import Pixels
from web.stage.palette import Rgb

Rows = list[tuple[str, str]]


def css(colour: Rgb, opacity: float = 1.0) -> str:
    return "rgba({},{},{},{:.3g})".format(*colour, opacity)


def page(*parts: str) -> str:
    """One column of parts at the panel's margins."""
    return f'<div style="font-size:13px;line-height:1.45;padding:2px 12px 2px 6px">{"".join(parts)}</div>'


def heading(words: str) -> str:
    return f'<div style="font-weight:600;margin:10px 0 2px">{html.escape(words)}</div>'


def note(words: str) -> str:
    return f'<div style="opacity:.7">{html.escape(words)}</div>'


def caption(words: str) -> str:
    return f'<div style="opacity:.75;font-size:12px;margin:8px 0 2px;white-space:nowrap">{html.escape(words)}</div>'


def table(title: str, rows: Rows, empty: str = "") -> str:
    """Two columns of plain words; `empty` says why there are none."""
    if not rows:
        return heading(title) + note(empty)
    lines = "".join(
        f'<tr><td style="opacity:.75;padding-right:10px;white-space:nowrap">{html.escape(name)}</td>'
        f'<td style="text-align:right;font-variant-numeric:tabular-nums">{html.escape(value)}</td></tr>'
        for name, value in rows
    )
    return f'{heading(title)}<table style="width:100%;border-collapse:collapse">{lines}</table>'


def row(*cells: str) -> str:
    """Cells of equal width, side by side."""
    inner = "".join(f'<div style="flex:1 1 0;min-width:0">{cell}</div>' for cell in cells)
    return f'<div style="display:flex;gap:10px">{inner}</div>'


def choice(kind: str, number: int, inner: str, style: str = "") -> str:
    """What a click inspects: `kind` is a field of `Inspect`; the page around listens (web/static/stage.js)."""
    return f'<span role="button" tabindex="0" data-{kind}="{number}" style="cursor:pointer;{style}">{inner}</span>'


def choices(title: str, kind: str, entries: list[tuple[int, str]], more: int = 0, empty: str = "none") -> str:
    """A row of numbers that can be clicked, each with a word; how many are left out, or why there are none."""
    if not entries:
        return heading(title) + note(empty)
    style = (
        "display:inline-block;border:1px solid;border-radius:9px;padding:0 7px;margin:3px 5px 0 0;white-space:nowrap"
    )
    chips = [
        choice(kind, number, f'<b>#{number}</b><span style="opacity:.75"> {html.escape(words)}</span>', style)
        for number, words in entries
    ]
    left = f'<span style="opacity:.7">and {more} more</span>' if more else ""
    return heading(title) + f"<div>{''.join(chips)}{left}</div>"


def picture(pixels: Pixels, words: str, aspect: float) -> str:
    """Grey, RGB or RGBA pixels as wide as there is room, enlarged without smoothing; `words` for who cannot see it."""
    if pixels.ndim == 3:
        pixels = pixels[..., [2, 1, 0, 3][: pixels.shape[2]]]
    _, png = cv2.imencode(".png", np.ascontiguousarray(pixels), [cv2.IMWRITE_PNG_COMPRESSION, 6])
    data = base64.b64encode(png.tobytes()).decode()
    style = f"display:block;width:100%;aspect-ratio:{aspect:.4g};image-rendering:pixelated;border-radius:3px"
    return f'<img alt="{html.escape(words)}" decoding="sync" src="data:image/png;base64,{data}" style="{style}">'


def blank(words: str, aspect: float) -> str:
    """A frame in place of a picture, saying why there is none."""
    style = f"aspect-ratio:{aspect:.4g};display:flex;align-items:center;justify-content:center;text-align:center"
    return f'<div style="{style};border:1px dashed;border-radius:3px;opacity:.6;padding:4px">{html.escape(words)}</div>'


def bar(share: float, colour: Rgb, ground: Rgb, mark: float | None = None, height_px: int = 8) -> str:
    """A bar filled to `share` of its width, with a mark across it at another share."""
    share = min(max(share, 0.0), 1.0)
    fill = f'<div style="height:100%;width:{100 * share:.1f}%;background:{css(colour)};border-radius:4px"></div>'
    line = ""
    if mark is not None:
        place = f"position:absolute;left:calc({100 * mark:.1f}% - 1px);top:-4px;bottom:-4px;width:2px"
        line = f'<div style="{place};background:currentColor"></div>'
    style = f"position:relative;height:{height_px}px;background:{css(ground, 0.22)};border-radius:4px;margin:6px 0"
    return f'<div style="{style}">{fill}{line}</div>'


def histogram(values: np.ndarray, colour: Rgb, words: str, aspect: float, ticks: tuple[str, ...]) -> str:
    """Bars from a common floor, the tallest to the top, with words below at even distances."""
    count = len(values)
    tall = values / max(float(values.max(initial=0.0)), 1e-9) * 100
    bars = "".join(
        f'<rect x="{k + 0.08:.2f}" y="{100 - v:.1f}" width=".84" height="{v:.1f}"/>'
        for k, v in enumerate(tall)
        if v > 0.5
    )
    svg = (
        f'<svg role="img" aria-label="{html.escape(words)}" viewBox="0 0 {count} 100" preserveAspectRatio="none" '
        f'fill="{css(colour)}" style="display:block;width:100%;aspect-ratio:{aspect:.4g};border-bottom:1px solid">'
        f"{bars}</svg>"
    )
    below = "".join(f"<span>{html.escape(tick)}</span>" for tick in ticks)
    return f'{svg}<div style="display:flex;justify-content:space-between;font-size:11px;opacity:.75">{below}</div>'
