"""Answers websocket requests that cannot be read. By itself, uvicorn leaves their senders waiting for ever.

uvicorn reads a request with h11 and then has websockets read it again, which accepts fewer and shorter headers.
Browsers send the cookies of every server at this address, whatever its port, so a long header need not be anybody's
fault.
"""

from __future__ import annotations

import websockets.http11
from uvicorn._types import ASGISendEvent
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.exceptions import InvalidState, SecurityError

from web.http.commands import problem

MAX_HEADER_BYTES = 64 * 1024  # of a request, all headers together
websockets.http11.MAX_LINE_LENGTH = MAX_HEADER_BYTES  # read anew for each request; 8 KiB by default


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """uvicorn's protocol, with an answer to what websockets does not accept as a request.

    It also completes a refusal: uvicorn takes a request that was answered with a sentence for one that was forgotten. And the
    program may end while a browser is closing a connection.
    """

    def shutdown(self) -> None:
        try:
            super().shutdown()
        except InvalidState:  # the browser's farewell was there first
            self.transport.close()

    async def send(self, message: ASGISendEvent) -> None:
        await super().send(message)
        if message["type"] == "websocket.http.response.body" and not message.get("more_body", False):
            self.handshake_complete = True

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        fault = self.conn.handshake_exc
        if fault is None or self.handshake_initiated or self.transport.is_closing():
            return
        if isinstance(fault.__cause__, SecurityError):
            status = "431 Request Header Fields Too Large"
            reason = (
                f"a websocket's request may have {websockets.http11.MAX_NUM_HEADERS} headers "
                f"of {MAX_HEADER_BYTES} bytes; this one has more"
            )
        else:
            status, reason = "400 Bad Request", "a websocket is asked for with GET and without a body"
        body = problem(reason)
        head = (
            f"HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {len(body)}\r\nConnection: close"
        )
        self.transport.write(head.encode() + b"\r\n\r\n" + body)
        self.transport.close()
