"""An attack, and the one thread that drives it."""

import errno
import math
import selectors
import time

from attacks.flight import Flight
from attacks.jobs import request

ATTACKER = "127.0.0.1"


class Attack:
    """`n` connections at once, each with a request that `body(i)` makes; those that end are replaced."""

    def __init__(self, name, says, body, n, **options):
        self.name, self.says, self.body, self.n = name, says, body, n
        self.path = options.get("path", "/v1/render")
        self.requests = options.get("requests")  # whole requests instead of bodies, where they go to several places
        self.starts_per_s = options.get("starts_per_s", 400)  # so that refusals do not turn into a busy loop
        self.cached = options.get("cached", False)  # what it leaves in memory are results that may be asked for again
        self.clients = options.get("clients", 1)  # addresses that the requests come from, in turn
        self.detached = options.get("detached", False)  # asks not to be waited for
        self.patience_s = options.get("patience_s", math.inf)  # clients leave after this
        self.total = options.get("total", math.inf)  # requests in all; those answered 503 come again
        self.held = options.get("held", 0)  # bytes of the body held back
        self.drip_s = options.get("drip_s")  # one of them is sent each so many seconds
        self.joined = options.get("joined", False)  # all send the same until it is answered
        self.duration_s = options.get("duration_s", 30.0)
        self.slow_disk = options.get("slow_disk", False)

    def shot(self, i):
        if self.requests:
            return self.requests(i)
        return request("POST", self.path, self.body(i), "Prefer: respond-async" if self.detached else "Prefer: wait=300")


class Attacker:
    """Drives one attack from one thread."""

    def __init__(self, attack, port, observe):
        self.attack, self.port, self.observe = attack, port, observe
        self.selector, self.flights, self.answers = selectors.DefaultSelector(), {}, {}
        self.next, self.again, self.done, self.shared = 0, [], 0, None

    def run(self):
        """Attacks until the time or the requests are used up, or `observe` says to stop."""
        start = time.monotonic()
        begun, swept = 0, 0.0
        while (now := time.monotonic() - start) < self.attack.duration_s and self.done < self.attack.total:
            while len(self.flights) < self.attack.n and begun < 50 + now * self.attack.starts_per_s and self.open():
                begun += 1
            for key, events in self.selector.select(0.02):
                self.step(key.data, events)
            if now - swept > 0.05:
                swept = now
                self.sweep()
                if self.observe():
                    break
        for flight in list(self.flights):
            self.close(flight, "left at the end")
        return self.answers

    def data(self):
        attack = self.attack
        if self.again:
            return self.again.pop()
        if self.next >= attack.total:
            return None
        if attack.joined and self.shared:
            return self.shared
        self.shared = attack.shot(self.next)
        self.next += 1
        return self.shared

    def open(self):
        if (data := self.data()) is None:
            return False
        flight = Flight(self.port, self.address(), data)
        self.flights[flight] = flight.age()
        self.selector.register(flight.socket, selectors.EVENT_READ | selectors.EVENT_WRITE, flight)
        return True

    def address(self):
        if self.attack.clients == 1:
            return ATTACKER
        return f"127.0.1.{1 + self.next % self.attack.clients}"

    def step(self, flight, events):
        try:
            if events & selectors.EVENT_WRITE and not flight.send(len(flight.data) - self.attack.held):
                self.selector.modify(flight.socket, selectors.EVENT_READ, flight)
            if events & selectors.EVENT_READ and not flight.receive():
                self.close(flight, flight.status())
        except OSError as error:
            self.close(flight, errno.errorcode.get(error.errno, "cut"))

    def sweep(self):
        """Lets go of connections whose clients have lost patience, and drips on those that hold back."""
        attack = self.attack
        for flight in list(self.flights):
            if flight.age() > attack.patience_s:
                self.close(flight, "left")
            elif attack.drip_s and flight.age() > self.flights[flight] + attack.drip_s:
                self.flights[flight] = flight.age()
                try:
                    flight.sent += flight.socket.send(flight.data[flight.sent : flight.sent + 1])
                except OSError:
                    self.close(flight, "cut")

    def close(self, flight, how):
        self.selector.unregister(flight.socket)
        flight.socket.close()
        del self.flights[flight]
        self.answers[how] = self.answers.get(how, 0) + 1
        if how == "503" and self.attack.total < math.inf:
            self.again.append(flight.data)
        else:
            self.done += 1
        if how in ("200", "202") and flight.data is self.shared:
            self.shared = None
