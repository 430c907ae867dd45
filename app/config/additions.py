"""Our additions as a Markdown page for the documentation."""

from __future__ import annotations

import json

from ratslam_core.params.additions import ADDITIONS, Value


def additions_markdown() -> str:
    """What is ours, and how each of it is switched off; this is docs/additions.md."""
    rows = "\n".join(f"| {a.name} | {a.adds} | {a.why} | {_names(a.off)} |" for a in ADDITIONS)
    return f"""# What is ours

Made by `ratslam config --additions`. The papers' engine runs by itself: `--preset paper-2004`, `paper-2005`, `paper-2006`, or
*preset* in the *Office* tab. What is ours is on by default (`ours`); each addition has a switch and a plain twin. With all of
them off whole runs are, tick by tick, those of a literal twin written from the equations (`test_papers.py`). What each is worth
is measured by `ratslam experiment additions`: [results](results.md#what-each-of-our-additions-is-worth), read in
[findings](findings.md#what-each-addition-is-worth). On the page, *Compare* puts a brain without one beside a brain
with it ([two brains](time.md#two-brains-on-the-same-senses)).

| addition | what it adds | why | off with |
|---|---|---|---|
{rows}
"""


def _names(off: dict[str, Value]) -> str:
    return ", ".join(f"`{name} = {json.dumps(value)}`" for name, value in off.items())
