"""The routes of the exports: what is offered, a file or a .zip of several, and one at a time."""

from __future__ import annotations

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
from web.http.export import Offer, Wish


class FewExports:
    """Offers three formats; `meanwhile` is called while a file is being written."""

    def __init__(self) -> None:
        self.meanwhile: Callable[[], None] = lambda: None
        self.folders: list[Path] = []
        self.wishes: list[Wish] = []
        self.done = 0.25

    def offers(self) -> list[Offer]:
        refusals = {"one": None, "two": None, "never": "not today"}
        return [Offer(format=to, words=to.title(), refusal=why) for to, why in refusals.items()]

    async def write(self, to: str, submit: Submit, out: Path, wish: Wish) -> list[Path]:  # noqa: ARG002
        import asyncio

        self.folders.append(out.parent)
        self.wishes.append(wish)
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
    name = one.text
    assert name.startswith("run-")
    assert name.endswith(".one")
    assert one.headers["Content-Disposition"] == f'attachment; filename="{name}"'
    with zipfile.ZipFile(io.BytesIO(client.get("/api/export?to=two").content)) as several:
        assert [several.read(part).decode() for part in several.namelist()] == several.namelist()
        assert len(several.namelist()) == 2
    assert not any(folder.exists() for folder in exports.folders)


@pytest.mark.parametrize(
    ("to", "words"), [("never", "not today"), ("x", "no such format"), ("one/../x", "no such format")]
)
def test_what_cannot_be_had_is_refused(client: TestClient, to: str, words: str) -> None:
    answer = client.get("/api/export", params={"to": to})
    assert answer.status_code == 422
    assert words in answer.json()["detail"][0]["reason"]


@pytest.mark.parametrize("error", [ValueError("the run is too short"), OSError(28, "No space left on device")])
def test_what_fails_is_said_and_leaves_nothing(client: TestClient, exports: FewExports, error: Exception) -> None:
    def fail() -> None:
        raise error

    exports.meanwhile = fail
    answer = client.get("/api/export?to=one")
    assert answer.status_code == 422
    assert str(error) in answer.json()["detail"][0]["reason"]
    assert not exports.folders[0].exists()


def test_one_at_a_time(client: TestClient, exports: FewExports) -> None:
    begun, go_on = threading.Event(), threading.Event()

    def wait() -> None:
        begun.set()
        assert go_on.wait(20)

    exports.meanwhile = wait
    with ThreadPoolExecutor() as others:
        first = others.submit(client.get, "/api/export?to=one")
        assert begun.wait(20)
        assert client.get("/api/export?to=two").status_code == 429
        go_on.set()
        assert first.result().status_code == 200


def test_without_formats_there_is_nothing() -> None:
    with house(empty=True) as server:
        assert server.client.get("/api/exports").json() == []
        assert server.client.get("/api/export?to=one").status_code == 422


def test_another_site_gets_no_export(client: TestClient) -> None:
    assert client.get("/api/export?to=one", headers={"Sec-Fetch-Site": "cross-site"}).status_code == 403


def test_a_stretch_is_in_the_name_and_must_be_one(client: TestClient, exports: FewExports) -> None:
    query = {"to": "one", "from_s": 2.5, "until_s": 30, "pictures": "none"}
    assert client.get("/api/export", params=query).text.endswith("-2.5s-to-30s.one")
    assert exports.wishes == [Wish(from_s=2.5, until_s=30.0, pictures="none")]
    for wrong, words in ({"until_s": 2.5}, "must be after from_s, 2.5"), ({"from_s": -1}, "greater than or equal to 0"):
        answer = client.get("/api/export", params=query | wrong)
        assert answer.status_code == 422
        assert words in answer.text
    assert len(exports.wishes) == 1


def test_how_much_is_written_can_be_asked_meanwhile(client: TestClient, exports: FewExports) -> None:
    told: list[object] = []
    exports.meanwhile = lambda: told.append(client.get("/api/exports/done").json())
    assert client.get("/api/exports/done").json() is None
    client.get("/api/export?to=one")
    assert told == [0.25]
