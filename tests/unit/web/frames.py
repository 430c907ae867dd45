"""Messages as the page reads them: text, and a panel's with arrays."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import orjson


def read_frame(raw: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """The head, and each array in its shape."""
    at = 4 + int.from_bytes(raw[:4], "little")
    head, arrays = orjson.loads(raw[4:at]), {}
    for told in head.pop("arrays"):
        assert at % 4 == 0, "a typed array begins at a multiple of its size"
        body = raw[at : at + told["bytes"]]
        if told["kind"] == "jpeg":
            array = cv2.imdecode(np.frombuffer(body, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]
        else:
            array = np.frombuffer(body, f"<{told['kind']}").reshape(told["shape"])
        arrays[told["name"]] = array
        at += -(-told["bytes"] // 4) * 4
    assert at == len(raw)
    return head, arrays


def read_message(message: str | bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    return read_frame(message) if isinstance(message, bytes) else (orjson.loads(message), {})


def until(socket: Any, kind: str, **fields: Any) -> dict[str, Any]:
    """The next message of this kind with these fields."""
    while True:
        message = orjson.loads(socket.receive().get("text") or '{"type": "a part with arrays"}')
        if message["type"] == kind and all(message[name] == value for name, value in fields.items()):
            return message
