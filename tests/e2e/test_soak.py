"""The soak benchmark: some seconds of it for real, and that its judge notices what is wrong."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

import pytest

from benchmarks.soak_report import Row, judge

ROW = Row(
    minute=0.0, time_s=0.0, tick=0, factor=16.0, tick_ms=2.0, worst_ms=5.0, cpu_ms=3.0, memory_mb=300.0, browser_mb=1000.0,
    threads=17, files=15, views=0, experiences=0, links=0, map_error_m=0.1, odometry_error_m=None,
    doing="following the wall", fault=None,
)  # fmt: skip
CALM = [replace(ROW, minute=k, tick=k * 9600, memory_mb=300 + k / 6, experiences=5 * k) for k in range(121)]


@pytest.mark.long
def test_seconds_of_it_and_the_page_loaded_anew(tmp_path):
    report = tmp_path / "soak.json"
    command = [sys.executable, "-m", "benchmarks.soak", "--minutes", "0.2", "--every", "1", "--act-every", "0.02"]
    done = subprocess.run([*command, "--json", str(report)], capture_output=True, text=True, check=False)
    told = json.loads(report.read_text())
    assert (done.returncode, told["wrong"]) == (0, []), done.stdout + done.stderr
    rows = told["rows"]
    assert len(rows) >= 2
    assert rows[0]["tick"] < rows[-1]["tick"]
    assert rows[0]["memory_mb"] > 100 < rows[0]["browser_mb"]
    assert any(row["tick_ms"] for row in rows)


def test_memory_is_told_against_the_growth_of_the_map() -> None:
    findings = judge(CALM, [])
    assert not findings.wrong
    assert "300 MB at first, 305 MB after a quarter, 310 MB at half time, 320 MB at last" in findings.lines[1]
    assert "+10.0 MB an hour, with +300 experiences" in findings.lines[2]


def test_what_is_wrong_is_said(subtests: pytest.Subtests) -> None:
    for words, spoil in {
        "threads more": lambda row: {"threads": 17 + row.minute // 4},
        "files more": lambda row: {"files": 15 + row.minute // 4},
        "stood still for 30.0 min": lambda row: {"tick": min(row.tick, 90 * 9600)},
        "at minute 61.0: ValueError: no": lambda row: {"fault": "ValueError: no" if row.minute > 60 else None},
        "never told a tick's time": lambda _row: {"tick_ms": None},
    }.items():
        with subtests.test(words):
            assert words in " ".join(judge([replace(row, **spoil(row)) for row in CALM], []).wrong)
    assert judge(CALM, ["1 x the page crashed"]).wrong == ("1 x the page crashed",)
