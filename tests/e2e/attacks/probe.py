"""Strangers: health checks and small jobs, from addresses of their own.

They run in a process of their own, so that the attacker's work does not delay their clock.
"""

import errno
import os
import selectors
import time

from attacks.flight import Flight
from attacks.jobs import request, small

STRANGER, DOCTOR = "127.0.0.8", "127.0.0.9"
PATIENCE_S = 10.0  # what takes longer counts as so long


def probe(port, results):
    """Asks for /livez every 100 ms and for a small job every 500 ms; sends (kind, start, seconds, status)."""
    os.setpgid(0, 0)
    selector, flights = selectors.DefaultSelector(), {}
    asked = {"livez": 0, "stranger": 0}
    started = time.monotonic()

    def close(flight, status):
        selector.unregister(flight.socket)
        flight.socket.close()
        results.send((flights.pop(flight), flight.start, flight.age(), status))

    def ask(kind):
        i = asked[kind]
        asked[kind] += 1
        data = request("POST", "/v1/render", small(i)) if kind == "stranger" else request("GET", "/livez")
        flight = Flight(port, STRANGER if kind == "stranger" else DOCTOR, data)
        flights[flight] = kind
        selector.register(flight.socket, selectors.EVENT_READ | selectors.EVENT_WRITE, flight)

    while True:
        now = time.monotonic() - started
        if now >= asked["livez"] * 0.1:
            ask("livez")
        if now >= asked["stranger"] * 0.5:
            ask("stranger")
        for key, events in selector.select(0.01):
            flight = key.data
            try:
                if events & selectors.EVENT_WRITE and not flight.send(len(flight.data)):
                    selector.modify(flight.socket, selectors.EVENT_READ, flight)
                if events & selectors.EVENT_READ and not flight.receive():
                    close(flight, flight.status())
            except OSError as error:
                close(flight, errno.errorcode.get(error.errno, "cut"))
        for flight in [flight for flight in flights if flight.age() > PATIENCE_S]:
            close(flight, "silent")
