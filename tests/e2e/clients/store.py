"""Tries services that share a bucket: hits of each other, a kill under load, damage, a store that goes away."""

import concurrent.futures
import contextlib
import hashlib
import http.client
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse

import boto3
import botocore.config

SECRET = "a-secret-that-nobody-may-read"
BUCKET = "farm"
JOBS = 60
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def check(holds, what):
    if not holds:
        sys.exit(f"FAILED: {what}")


def until(what, yes, seconds=60):
    end = time.monotonic() + seconds
    while not yes():
        check(time.monotonic() < end, f"waited in vain: {what}")
        time.sleep(0.1)


def job(number, levels=3):
    """A job that no other number has; each result has some hundred kilobytes."""
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1 + number / 8]]
    mesh = {"positions": points, "faces": [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]}
    output = {"format": "obj"}
    return {"input": {"mesh": mesh}, "plan": {"preset": "loop"}, "levels": levels, "outputs": [output]}


class Store:
    """The store of S3, which can hang, end and come back: moto, empty each time, or s3s-fs, with what it had."""

    def __init__(self, binary, folder):
        self.binary, self.log = binary, pathlib.Path(folder, "store.log").open("wb")
        self.root = pathlib.Path(folder, "bucket")
        self.root.mkdir()
        # which makes a bucket for whoever writes into it
        self.is_folder = pathlib.Path(binary).name == "s3s-fs"
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.url = f"http://127.0.0.1:{self.port}"
        config = botocore.config.Config(retries={"max_attempts": 1}, s3={"addressing_style": "path"})
        keys = {"aws_access_key_id": "farm", "aws_secret_access_key": SECRET, "region_name": "us-east-1"}
        self.client = boto3.client("s3", endpoint_url=self.url, config=config, **keys)
        self.start()

    def start(self):
        command = [self.binary, "-H", "127.0.0.1", "-p", str(self.port)]
        if self.is_folder:
            command = [self.binary, "--host", "127.0.0.1", "--port", str(self.port)]
            command += ["--access-key", "farm", "--secret-key", SECRET, str(self.root)]
        self.process = subprocess.Popen(command, stdout=self.log, stderr=self.log)
        until("the store is there", self.answers)
        with contextlib.suppress(self.client.exceptions.BucketAlreadyExists):
            self.client.create_bucket(Bucket=BUCKET)

    def answers(self):
        with contextlib.suppress(OSError):
            socket.create_connection(("127.0.0.1", self.port), 1).close()
            return True
        return False

    def hang(self):
        self.process.send_signal(signal.SIGSTOP)

    def go_on(self):
        self.process.send_signal(signal.SIGCONT)

    def end(self):
        self.process.kill()
        self.process.wait()

    def names(self, part):
        pages = self.client.get_paginator("list_objects_v2").paginate(Bucket=BUCKET)
        names = [found["Key"] for page in pages for found in page.get("Contents", [])]
        return [name for name in names if part in name]

    def flip(self, name):
        """Flips one bit in the middle of an object."""
        data = bytearray(self.client.get_object(Bucket=BUCKET, Key=name)["Body"].read())
        data[len(data) // 2] ^= 1
        self.client.put_object(Bucket=BUCKET, Key=name, Body=bytes(data))


class Server:
    """A service; with a store it shares its bucket."""

    def __init__(self, binary, folder, store=None, bucket=BUCKET):
        self.log = pathlib.Path(tempfile.mkstemp(dir=folder)[1])
        flags = ["--listen", "127.0.0.1:0", "--data-dir", tempfile.mkdtemp(dir=folder), "--log", "debug"]
        flags += ["--cache-bytes", "0"] if store is None else ["--cache-store", "s3", "--s3-bucket", bucket]
        flags += [] if store is None else ["--s3-endpoint", store.url]
        keys = {"AWS_ACCESS_KEY_ID": "farm", "AWS_SECRET_ACCESS_KEY": SECRET, "AWS_REGION": "us-east-1"}
        with self.log.open("wb") as out:
            command = [binary, "serve", *flags]
            self.process = subprocess.Popen(command, env=os.environ | keys, stdout=out, stderr=out)

    def said(self):
        return self.log.read_text(errors="replace")

    def started(self):
        listens = "is listening on http://127.0.0.1:"
        until("the service listens", lambda: listens in self.said() or self.process.poll() is not None)
        check(self.process.poll() is None, f"the service did not start: {self.said()}")
        self.port = int(self.said().partition(listens)[2].split()[0])
        return self

    def ask(self, method, path, body=None, kind="application/json"):
        """Status, headers and all bytes of an answer; an answer that breaks off is an error."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=120)
        with contextlib.closing(connection):
            connection.request(method, path, body, {"Content-Type": kind} if body else {})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()

    def render(self, wanted):
        status, headers, body = self.ask("POST", "/v1/render", json.dumps(wanted))
        check(status == 200, f"render: {status} {body[:300]}")
        return headers["Cache-Status"], body, headers

    def metric(self, name):
        text = self.ask("GET", "/metrics")[2].decode()
        found = [line.split()[-1] for line in text.splitlines() if line.startswith(name + " ")]
        check(len(found) == 1, f"no metric {name}")
        return int(found[0])

    def event(self, name):
        return self.metric(f'planish_disk_events_total{{event="{name}"}}')

    def is_away(self):
        return self.metric('planish_store_away{store="disk"}') == 1

    def written(self, count):
        until(f"{count} results are in the bucket", lambda: self.event("written") >= count)

    def end(self):
        check(SECRET not in self.said(), "the secret stands in the log")
        self.process.kill()
        self.process.wait()


class Farm:
    """Everything that the stories need."""

    def __init__(self, binary, store, folder):
        self.binary, self.store, self.folder = binary, store, folder
        alone = Server(binary, folder).started()
        self.truth = [self.digest(alone.render(job(number))[1]) for number in range(JOBS)]
        check(len(set(self.truth)) == JOBS, "the jobs are not different")
        alone.end()

    def server(self):
        return Server(self.binary, self.folder, self.store).started()

    @staticmethod
    def digest(body):
        return hashlib.sha256(body).hexdigest()

    def right(self, server, number):
        """Renders a job, compares every byte, and says how it came about."""
        cache, body, _ = server.render(job(number))
        check(self.digest(body) == self.truth[number], f"job {number} has wrong bytes ({cache})")
        return cache


def shares(farm):
    """What one has made or was sent, the other has."""
    a, b = farm.server(), farm.server()
    cache, body, headers = a.render(job(0, 7))
    check("stored" in cache, f"made by the first: {cache}")
    a.written(1)
    cache, again, _ = b.render(job(0, 7))
    check("hit" in cache and again == body and len(body) > 3 << 20, f"found by the second: {cache}")
    third = farm.server()
    place = urllib.parse.urlparse(headers["Content-Location"]).path
    status, _, got = third.ask("GET", place)
    check((status, got) == (200, body), f"{place} at a third: {status}")
    status, _, told = a.ask("POST", "/v1/blobs", TETRAHEDRON, "model/obj")
    check(status == 201, f"upload: {status} {told}")
    named = {"input": {"blob": json.loads(told)["id"]}, "plan": {"preset": "loop"}, "levels": 2}
    named["outputs"] = [{"format": "stl"}]
    check(b.render(named)[1] == a.render(named)[1], "a job of an upload that another server has")
    check(b.ask("GET", json.loads(told)["href"])[2].decode() == TETRAHEDRON, "the upload itself")
    status, _, body = b.ask("GET", "/v1/blobs/b3-" + "0" * 64)
    check(status == 404, f"an upload that nobody has sent: {status}")
    for server in (a, b, third):
        server.end()


def killed(farm):
    """One of two is killed under load: the other answers, and no answer is wrong."""
    a, b = farm.server(), farm.server()
    answers = {"hit": 0, "miss": 0, "lost": 0}

    def asked(turn):
        for server in (a, b) if turn % 2 else (b, a):
            try:
                return "hit" if "hit" in farm.right(server, turn * 7 % JOBS) else "miss"
            except (OSError, http.client.HTTPException):
                check(server is a, "the one that lives broke an answer off")
        return "lost"

    with concurrent.futures.ThreadPoolExecutor(8) as clients:
        turns = [clients.submit(asked, turn) for turn in range(4 * JOBS)]
        concurrent.futures.wait(turns[: 2 * JOBS])
        a.process.kill()
        for turn in turns:
            answers[turn.result()] += 1
    check(answers["lost"] == 0 and answers["hit"] > JOBS, f"under load: {answers}")
    late = farm.server()
    found = sum("hit" in farm.right(late, number) for number in range(JOBS))
    check(found > JOBS / 2, f"a new server finds {found} of {JOBS}")
    for server in (a, b, late):
        server.end()
    return f"{answers}, a new server found {found} of {JOBS}"


def damaged(farm):
    """Objects with a flipped bit are never given; they are dropped, counted and made again."""
    parts, manifests = farm.store.names("results/parts"), farm.store.names("results/manifests")
    for name in parts[::2] + manifests[::3]:
        farm.store.flip(name)
    server = farm.server()
    made = sum("hit" not in farm.right(server, number) for number in range(JOBS))
    dropped = server.metric('planish_store_damaged_total{store="disk"}')
    check(made > 10 and dropped > 10, f"{made} made again, {dropped} dropped")
    server.written(made)
    server.end()
    server = farm.server()
    check(all("hit" in farm.right(server, number) for number in range(JOBS)), "what was made again is found")
    check(server.metric('planish_store_damaged_total{store="disk"}') == 0, "and sound")
    server.end()
    return f"{dropped} dropped, {made} made again"


def hangs_and_ends(farm):
    """The store hangs, goes on, ends and comes back empty: answers go on, metrics say so."""
    server, store = farm.server(), farm.store
    slowest = 0.0
    for stop, back in ((store.hang, store.go_on), (store.end, store.start)):
        away, dropped = server.event("reads_away"), server.event("dropped_away")
        stop()
        try:
            for number in range(1000, 1030):
                begun = time.monotonic()
                cache = server.render(job(number + 100 * dropped, 1))[0]
                slowest = max(slowest, time.monotonic() - begun)
                check("miss" in cache, f"nobody has made it: {cache}")
            check(all(farm.right(server, number) for number in range(10)), "results of before")
            until("it is told that the store is away", server.is_away)
            check(server.event("reads_away") > away, "reads that found nobody are counted")
            until("writes that found nobody are counted", lambda: server.event("dropped_away") > dropped)
            status, _, body = server.ask("GET", "/readyz")
            told = json.loads(body)
            check(status == 200 and "disk" in told["stores_away"], f"readyz: {status} {body}")
            status, headers, body = server.ask("GET", "/v1/blobs/b3-" + "1" * 64)
            check((status, headers["Retry-After"]) == (503, "5"), f"an upload meanwhile: {status} {body}")
            status, headers, body = server.ask("POST", "/v1/blobs", TETRAHEDRON + f"# {dropped}\n", "model/obj")
            check((status, headers["Retry-After"]) == (503, "5"), f"a new upload meanwhile: {status} {body}")
            check(str(store.port) not in body.decode(), f"where the store is is nobody's business: {body}")
        finally:
            back()
        written = server.event("written")
        number = iter(range(5000 + 100 * dropped, 6000 + 100 * dropped))
        until("it is used again", lambda: server.render(job(next(number), 1)) and server.event("written") > written)
        until("and said so", lambda: not server.is_away())
        last = next(number) - 1
        other = farm.server()
        until("the other finds it", lambda: "hit" in other.render(job(last, 1))[0])
        other.end()
    server.end()
    return f"slowest answer {slowest:.1f} s"


def refused(farm):
    """A bucket that is not there is refused at the start; a store that is not there is waited for."""
    if not farm.store.is_folder:
        server = Server(farm.binary, farm.folder, farm.store, "nowhere")
        check(server.process.wait(60) != 0 and "there is no such bucket" in server.said(), server.said())
    farm.store.end()
    server = farm.server()
    farm.right(server, 0)
    check(server.is_away(), "it starts without its store")
    farm.store.start()
    until("it finds it", lambda: "miss" in server.render(job(time.monotonic_ns(), 1))[0] and not server.is_away())
    server.end()


def main():
    binary, s3 = (str(pathlib.Path(path).resolve()) for path in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        store = Store(s3, folder)
        try:
            farm = Farm(binary, store, folder)
            for story in (shares, killed, damaged, hangs_and_ends, refused):
                told = story(farm)
                print(f"{story.__name__}: passed" + (f" ({told})" if told else ""), flush=True)
        finally:
            store.process.kill()


if __name__ == "__main__":
    main()
