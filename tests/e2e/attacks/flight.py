"""One connection that sends a request and reads the answer to its end, without ever blocking."""

import socket
import time

LOOKED_AT = 8192  # bytes of an answer: the head, and the text of a refusal
CHUNK = 256 * 1024  # sent at once, so that a long body does not hold up the others


class Flight:
    """One connection that sends a request and reads its answer to the end."""

    def __init__(self, port, source, data):
        self.start, self.data, self.sent, self.answer = time.monotonic(), memoryview(data), 0, bytearray()
        self.socket = socket.socket()
        self.socket.setblocking(False)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.bind((source, 0))
        self.socket.connect_ex(("127.0.0.1", port))

    def age(self):
        return time.monotonic() - self.start

    def send(self, upto):
        """Sends what the connection takes; whether there is more to send before `upto`."""
        try:
            self.sent += self.socket.send(self.data[self.sent : min(upto, self.sent + CHUNK)])
        except BlockingIOError:
            pass
        return self.sent < upto

    def receive(self):
        """Reads what there is; whether more may come."""
        try:
            part = self.socket.recv(1 << 20)
        except BlockingIOError:
            return True
        if len(self.answer) < LOOKED_AT:
            self.answer += part[:LOOKED_AT]
        return bool(part)

    def status(self):
        """The status, and whether a refusal lacks what makes it one that a client can act on."""
        status = self.answer[9:12].decode("latin-1") or "cut"
        if not status.startswith(("4", "5")):
            return status
        head, _, body = self.answer.decode("latin-1").partition("\r\n\r\n")
        names = {line.partition(":")[0].lower(): line.partition(":")[2].strip() for line in head.split("\r\n")[1:]}
        complete = names.get("content-type", "").startswith("application/problem+json") and '"detail"' in body
        patient = status not in ("429", "503") or names.get("retry-after", "").isdigit()
        return status if complete and patient else f"{status} malformed"
