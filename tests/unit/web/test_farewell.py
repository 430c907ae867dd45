"""A connection that the browser is closing while the program ends."""

from __future__ import annotations

import asyncio
from typing import Any, cast

import uvicorn
from uvicorn.server import ServerState

from web.http.handshake import WebSocketProtocol

REQUEST = (
    b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)
FAREWELL = bytes([0x88, 0x82]) + bytes(4) + (1001).to_bytes(2, "big")  # masked with nothing: "going away"


class SlowLine(asyncio.Transport):
    """Takes what is written, and has not sent it yet when it is closed."""

    def __init__(self) -> None:
        super().__init__()
        self.written, self.closed = b"", 0

    def get_extra_info(self, _name: str, default: Any = None) -> Any:
        return default

    def write(self, data: Any) -> None:
        self.written += bytes(data)

    def is_closing(self) -> bool:
        return self.closed > 0

    def close(self) -> None:
        self.closed += 1


async def _accepting(_scope: Any, receive: Any, send: Any) -> None:
    await receive()
    await send({"type": "websocket.accept"})
    while (await receive())["type"] != "websocket.disconnect":
        pass


async def _ended_while_the_browser_says_farewell() -> SlowLine:
    config, state, line = uvicorn.Config(cast(Any, _accepting), log_config=None), ServerState(), SlowLine()
    config.load()
    protocol = WebSocketProtocol(config, state, {})
    protocol.connection_made(line)
    protocol.data_received(REQUEST)
    while not protocol.handshake_complete:
        await asyncio.sleep(0)
    protocol.data_received(FAREWELL)
    protocol.shutdown()
    await asyncio.gather(*state.tasks)
    return line


def test_the_end_of_the_program_takes_a_farewell_that_was_there_first() -> None:
    line = asyncio.run(_ended_while_the_browser_says_farewell())
    assert line.written.startswith(b"HTTP/1.1 101")
    assert line.closed
