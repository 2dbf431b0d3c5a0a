"""One row: an attack on a fresh server, and what others felt of it."""

import math
import multiprocessing
import pathlib
import signal
import subprocess
import tempfile
import time

from attacks.attacker import Attacker
from attacks.probe import probe
from attacks.server import MAX_MEMORY_BYTES, MIB, SLOW_DISK, Server

MAX_RESIDENT_BYTES = MAX_MEMORY_BYTES + 512 * MIB
GUARD_BYTES = 10 << 30  # an attack stops here, so that the machine survives a server without limits
MAX_LIVEZ_S = 0.1
MAX_STRANGER_S = 1.0
RECOVERY_S = 30.0
GIVEN_BACK = 0.9  # share of the growth that has to come back
SMALL_GROWTH_BYTES = 64 * MIB  # thread stacks, caches of results and the allocator's own may keep so much
SHUTDOWN_S = 21.0  # the server's shutdown limit is 20 s; one more for the process to end
CALM_S = 3.0  # measured before each attack


class Row:
    def __init__(self, attack):
        self.attack, self.probes, self.answers, self.over = attack, [], {}, False
        self.before = self.peak = self.after = 0
        self.began, self.recovered_s, self.ended_s = math.inf, None, None

    def times(self, kind):
        return sorted(seconds for probe, start, seconds, _ in self.probes if probe == kind and start + seconds >= self.began)

    def largest(self, kind):
        return max(self.times(kind), default=0.0)

    def given_back(self):
        growth = self.peak - self.before
        return 1.0 if growth < SMALL_GROWTH_BYTES else (self.peak - self.after) / growth

    def refused(self):
        """Strangers and health checks that were not answered as they should be."""
        return sum(status != "200" for _, start, seconds, status in self.probes if start + seconds >= self.began)

    def is_normal(self, now):
        fresh = [(kind, seconds, status) for kind, start, seconds, status in self.probes if start + seconds > now - 1.5]
        bounds = {"livez": MAX_LIVEZ_S, "stranger": MAX_STRANGER_S}
        quick = all(seconds < bounds[kind] and status == "200" for kind, seconds, status in fresh)
        given_back = self.attack.cached or self.given_back() >= GIVEN_BACK
        return quick and {kind for kind, _, _ in fresh} == set(bounds) and given_back

    def faults(self):
        """What the row fails by."""
        slow_disk = self.attack.slow_disk
        return [
            name
            for name, failed in [
                ("memory", self.over or self.peak > MAX_RESIDENT_BYTES),
                ("livez", self.largest("livez") >= MAX_LIVEZ_S),
                ("stranger", self.largest("stranger") >= MAX_STRANGER_S),
                ("refusals", self.refused()),
                ("malformed", any("malformed" in how for how in self.answers)),
                ("recovery", not slow_disk and self.recovered_s is None),
                ("shutdown", slow_disk and (self.ended_s is None or self.ended_s > SHUTDOWN_S)),
            ]
            if failed
        ]


def measure(attack, binary):
    row = Row(attack)
    with tempfile.TemporaryDirectory(prefix="planish-attack-", ignore_cleanup_errors=True) as folder:
        server = Server(binary, folder, slow_disk(folder) if attack.slow_disk else None)
        results, sender = multiprocessing.Pipe(duplex=False)
        prober = multiprocessing.Process(target=probe, args=(server.port, sender), daemon=True)
        prober.start()
        try:
            strike(row, server, results)
        finally:
            prober.kill()
            server.end()
    return row


def slow_disk(folder):
    source, library = pathlib.Path(folder, "slow.c"), pathlib.Path(folder, "slow.so")
    source.write_text(SLOW_DISK)
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    return str(library)


def strike(row, server, results):
    def observe():
        while results.poll():
            row.probes.append(results.recv())
        if server.process.poll() is not None:
            row.over = True
            return True
        row.after = server.memory("VmRSS")
        row.peak = max(row.peak, server.memory("VmHWM"))
        row.over = row.over or row.after > GUARD_BYTES
        return row.over

    def watch(seconds, enough):
        start = time.monotonic()
        while (passed := time.monotonic() - start) < seconds and not observe():
            if enough(passed):
                return passed
            time.sleep(0.05)
        return None

    watch(CALM_S, lambda _: False)
    row.before, row.began = row.after, time.monotonic()
    row.answers = Attacker(row.attack, server.port, observe).run()
    if row.over:
        return
    if row.attack.slow_disk:
        server.process.send_signal(signal.SIGTERM)
        stopped = time.monotonic()
        while server.process.poll() is None and time.monotonic() - stopped < 90:
            time.sleep(0.05)
        row.ended_s = time.monotonic() - stopped
        return
    row.recovered_s = watch(RECOVERY_S, lambda passed: passed > 2 and row.is_normal(time.monotonic()))
