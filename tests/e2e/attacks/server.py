"""The server under attack, with a folder and a port of its own, and a disk that can be made slow."""

import os
import pathlib
import subprocess
import time

MIB = 1 << 20
MAX_MEMORY_BYTES = 2048 * MIB  # the limit given to the server

SLOW_DISK = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <unistd.h>
static int slowly(const char *name, int file) {
  sleep(1);
  return ((int (*)(int))dlsym(RTLD_NEXT, name))(file);
}
int fsync(int file) { return slowly("fsync", file); }
int fdatasync(int file) { return slowly("fdatasync", file); }
"""


class Server:
    def __init__(self, binary, folder, preload=None):
        log = pathlib.Path(folder, "log")
        limits = ["--listen", "127.0.0.1:0", "--data-dir", f"{folder}/data", "--max-memory-bytes", str(MAX_MEMORY_BYTES)]
        environment = os.environ | {"PLANISH_LOG": "error"} | ({"LD_PRELOAD": preload} if preload else {})
        with log.open("wb") as out:
            command = [binary, "serve", *limits]
            self.process = subprocess.Popen(command, env=environment, stdout=out, stderr=out)
        self.port = self.announced(log)

    def announced(self, log):
        """The port that the server says it listens on."""
        for _ in range(200):
            said = log.read_text(errors="replace").partition("http://127.0.0.1:")[2]
            if "\n" in said:
                return int(said.split()[0])
            if self.process.poll() is not None:
                break
            time.sleep(0.1)
        self.process.kill()
        raise SystemExit(f"the server did not start: {log.read_text(errors='replace')}")

    def memory(self, field):
        """Resident bytes: VmRSS now, VmHWM at most so far; none when the process has gone."""
        for line in pathlib.Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith(field):
                return int(line.split()[1]) * 1024
        return 0

    def cpu_s(self):
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self):
        self.process.kill()
        self.process.wait()
