"""The routes of the exports: what is offered, a file or a .zip of several, and one at a time."""

from __future__ import annotations

import asyncio
import io
import threading
import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.unit.web.doubles import house
from web.http.asking import Submit
from web.http.export import ExportRequest, Offer


class FewExports:
    """Offers three formats; `meanwhile` is called while a file is being written."""

    def __init__(self) -> None:
        self.meanwhile: Callable[[], None] = lambda: None
        self.folders: list[Path] = []
        self.requests: list[ExportRequest] = []
        self.done = 0.25

    def offers(self) -> list[Offer]:
        refusals = {"one": None, "two": None, "never": "not today"}
        return [Offer(format=to, words=to.title(), refusal=why) for to, why in refusals.items()]

    async def write(self, to: str, submit: Submit, out: Path, wanted: ExportRequest) -> list[Path]:  # noqa: ARG002
        self.folders.append(out.parent)
        self.requests.append(wanted)
        await asyncio.to_thread(self.meanwhile)
        files = [out] if to == "one" else [out.with_stem(f"{out.stem}-{part}") for part in "ab"]
        for file in files:
            file.write_text(file.name)
        return files


@pytest.fixture
def exports() -> FewExports:
    return FewExports()


@pytest.fixture
def parts(exports: FewExports) -> dict[str, Any]:
    return {"exports": exports}


def test_a_file_or_several_in_one(client: TestClient, exports: FewExports) -> None:
    assert [offer["format"] for offer in client.get("/api/exports").json()] == ["one", "two", "never"]
    one = client.get("/api/export?to=one")
    assert (one.text[:4], one.text[-4:]) == ("run-", ".one")
    assert one.headers["Content-Disposition"] == f'attachment; filename="{one.text}"'
    with zipfile.ZipFile(io.BytesIO(client.get("/api/export?to=two").content)) as several:
        assert [several.read(part).decode() for part in several.namelist()] == several.namelist()
        assert len(several.namelist()) == 2
    assert not any(folder.exists() for folder in exports.folders)


def test_what_cannot_be_had_or_fails_is_said_and_leaves_nothing(client: TestClient, exports: FewExports) -> None:
    def refusal(to: str, **more: Any) -> str:
        answer = client.get("/api/export", params={"to": to, **more})
        assert answer.status_code == 422
        return answer.json()["detail"][0]["reason"]

    assert "not today" in refusal("never")
    assert all("no such format" in refusal(to) for to in ("x", "one/../x"))
    assert "greater than or equal to 0" in refusal("one", from_s=-1)
    assert "must be after from_s, 2.5" in refusal("one", from_s=2.5, until_s=2.5)
    assert exports.requests == []
    for error in (ValueError("the run is too short"), OSError(28, "No space left on device")):

        def fail(error: Exception = error) -> None:
            raise error

        exports.meanwhile = fail
        assert str(error) in refusal("one")
        assert not exports.folders[-1].exists()
    with house(empty=True) as without:
        assert without.client.get("/api/exports").json() == []
        assert without.client.get("/api/export?to=one").status_code == 422


def test_a_stretch_is_in_the_name(client: TestClient, exports: FewExports) -> None:
    query = {"to": "one", "from_s": 2.5, "until_s": 30, "pictures": "none"}
    assert client.get("/api/export", params=query).text.endswith("-2.5s-to-30s.one")
    assert exports.requests == [ExportRequest(from_s=2.5, until_s=30.0, pictures="none")]


def test_one_at_a_time_and_how_much_of_it_is_written_can_be_asked(client: TestClient, exports: FewExports) -> None:
    begun, go_on = threading.Event(), threading.Event()

    def wait() -> None:
        begun.set()
        assert go_on.wait(20)

    exports.meanwhile = wait
    assert client.get("/api/exports/done").json() is None
    with ThreadPoolExecutor() as others:
        first = others.submit(client.get, "/api/export?to=one")
        assert begun.wait(20)
        assert client.get("/api/export?to=two").status_code == 429
        assert client.get("/api/exports/done").json() == 0.25
        go_on.set()
        assert first.result().status_code == 200
