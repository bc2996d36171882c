"""A studio in a process of its own, secrets beside its folder, and what can be seen of it from outside."""

from __future__ import annotations

import collections
import contextlib
import http.client
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from websockets.sync.client import ClientConnection, connect

import pliant as pl

PATIENCE = 20  # seconds that anybody waits for an answer
MARK = b"the-canary-that-nobody-may-see"


@dataclass
class Studio:
    """A studio in a process of its own, and what lies around it."""

    folder: Path
    process: subprocess.Popen[bytes]
    port: int
    token: str
    cookie: str = ""

    @property
    def secret(self) -> str:
        """The file that must not be read."""
        return str(self.folder / "secret" / "key.off")

    def memory(self, name: str = "VmRSS") -> float:
        """What the process has of memory, or has had at most (VmHWM), in MB."""
        lines = Path(f"/proc/{self.process.pid}/status").read_text().splitlines()
        return int(next(line for line in lines if line.startswith(name)).split()[1]) / 1024

    def get(self, path: str) -> http.client.HTTPResponse:
        """An honest request's answer."""
        link = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        link.request("GET", path, headers={"cookie": self.cookie} if self.cookie else {})
        answer = link.getresponse()
        answer.read()
        link.close()
        return answer

    def complaints(self) -> collections.Counter[str]:
        """What its log says of errors that nobody caught, and how often."""
        lines = (self.folder / "log").read_text(errors="replace").splitlines()
        found, within = collections.Counter[str](), False
        for line in lines:
            if within and line and not line.startswith((" ", "\t")):
                found[line[:160]] += 1
            within = line.startswith("Traceback") or (within and line.startswith(" "))
        return found

    def connect(self) -> ClientConnection:
        """A page's connection."""
        head = {"cookie": self.cookie, "origin": f"http://127.0.0.1:{self.port}"}
        return connect(f"ws://127.0.0.1:{self.port}/socket", additional_headers=head, max_size=None, open_timeout=60)


@contextlib.contextmanager
def studio() -> Iterator[Studio]:
    """A studio whose folder lies beside secrets, with a link to them inside."""
    with tempfile.TemporaryDirectory(prefix="pliant-attack-") as place:
        folder = Path(place)
        for name in ("root", "secret", "state"):
            (folder / name).mkdir()
        (folder / "root" / "folder").mkdir()
        pl.write(pl.shapes.box().mesh, folder / "root" / "box.off")
        pl.write(pl.shapes.box().mesh, folder / "secret" / "key.off")
        pl.save_project(pl.Scene(pl.shapes.box().mesh, pl.Stack([])), folder / "secret" / "key.pliant")
        with (folder / "secret" / "key.off").open("ab") as stream:
            stream.write(b"# " + MARK + b"\n")
        (folder / "root" / "link.off").symlink_to(folder / "secret" / "key.off")
        (folder / "root" / "outside").symlink_to(folder / "secret")
        command = [sys.executable, "-m", "reliability.besieged", str(folder / "root"), str(folder / "state")]
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=log)
        assert process.stdout is not None
        assert process.stdin is not None
        told = json.loads(process.stdout.readline())
        found = Studio(folder, process, told["port"], parse_qs(urlsplit(told["url"]).query)["token"][0])
        found.cookie = str(found.get(f"/?token={found.token}").getheader("set-cookie")).split(";")[0]
        try:
            yield found
        finally:
            process.stdin.close()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            process.stdout.close()
