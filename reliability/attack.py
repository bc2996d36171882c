"""A studio under attack: `python -m reliability.attack --count 20000`.

Half of the attackers have no key and send requests of HTTP; the others have one, as a page gone mad would, and send
frames: commands with values that are nearly right, wrong, or damaged. Beside the studio's folder lies another one, that
Linux watches: nobody may open a file there. Meanwhile an honest page asks again and again, and its answers are timed.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import http.client
import json
import random
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import numpy as np
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

import pliant as pl
from pliant.studio.frames import Frame
from reliability.canary import Canary
from reliability.hostile import asked, frame, request
from reliability.ledger import publish

PATIENCE = 20  # seconds that an attacker waits for an answer
ROUND = 25  # frames that an attacker sends through one connection
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


@dataclass
class Tally:
    """What an attacker has seen."""

    sent: collections.Counter[str] = field(default_factory=collections.Counter)
    answers: collections.Counter[str] = field(default_factory=collections.Counter)
    bugs: dict[str, str] = field(default_factory=dict)
    slow: dict[str, float] = field(default_factory=dict)
    leaked: int = 0


def knock(target: Studio, count: int, seed: int) -> Tally:
    """Send requests of HTTP, each through a connection of its own."""
    tally, rng = Tally(), random.Random(f"{seed}/requests")
    for _ in range(count):
        data = request(rng, target.port, target.cookie if rng.random() < 0.7 else "", target.secret)
        tally.sent["requests"] += 1
        try:
            with socket.create_connection(("127.0.0.1", target.port), timeout=PATIENCE) as link:
                link.sendall(data)
                link.shutdown(socket.SHUT_WR)
                answer = b""
                while piece := link.recv(1 << 16):
                    answer += piece
        except OSError as error:
            tally.answers[f"HTTP {type(error).__name__}"] += 1
            continue
        tally.leaked += MARK in answer or b"root:x:0" in answer
        status = answer[9:12].decode("latin-1") if answer.startswith(b"HTTP/") else "none"
        tally.answers[f"HTTP {status}"] += 1
    return tally


def rave(target: Studio, count: int, seed: int) -> Tally:
    """Send frames with a page's key, a few through each connection."""
    tally, rng, commands = Tally(), random.Random(f"{seed}/frames"), asked()
    while tally.sent["frames"] < count:
        try:
            with target.connect() as link:
                for _ in range(min(ROUND, count - tally.sent["frames"])):
                    data = frame(rng, tally.sent["frames"] + 1, target.secret, commands)
                    tally.sent["frames"] += 1
                    begin = time.monotonic()
                    link.send(data)
                    _hear(link, tally, data)
                    name = _command(data)
                    tally.slow[name] = max(tally.slow.get(name, 0.0), time.monotonic() - begin)
        except (ConnectionClosed, InvalidStatus):
            tally.answers["closed"] += 1
        except (OSError, TimeoutError) as error:
            tally.answers[type(error).__name__] += 1
    return tally


def _hear(link: ClientConnection, tally: Tally, data: bytes) -> None:
    """Receive until an answer has come; a damaged frame's may have another number."""
    while True:
        said = link.recv(timeout=PATIENCE)
        assert isinstance(said, bytes)
        tally.leaked += MARK in said or b"root:x:0" in said
        answer = Frame.decode(said).head
        if "answer" not in answer:
            continue
        kind = answer["error"]["kind"] if "error" in answer else "done"
        tally.answers[kind] += 1
        if kind in ("Bug", "OSError"):
            tally.bugs.setdefault(f"{_command(data)}: {answer['error']['message']}"[:200], data[:300].hex())
        return


def _ask(link: ClientConnection, data: bytes, number: int) -> None:
    link.send(data)
    while _heard(link).get("answer") != number:
        pass


def _heard(link: ClientConnection) -> Mapping[str, Any]:
    said = link.recv(timeout=PATIENCE)
    assert isinstance(said, bytes)
    return Frame.decode(said).head


def _command(data: bytes) -> str:
    try:
        return str(Frame.decode(data).head.get("do"))[:40]
    except Exception:
        return "no frame"


def _attacker(way: Callable[..., Tally], target: Studio, count: int, seed: int, talk: Connection) -> None:
    talk.send(way(target, count, seed))


@dataclass
class Honest:
    """A page that asks one thing after another, and how long each answer took, in milliseconds."""

    target: Studio
    asked: dict[str, list[float]] = field(default_factory=lambda: collections.defaultdict(list))

    def ask_until(self, over: threading.Event, pause: float = 0.02) -> None:
        """Ask for the page, for a sign of life, and through the socket for a list of files and for control points."""
        while not over.is_set():
            with contextlib.suppress(ConnectionClosed, OSError), self.target.connect() as link:  # then once more
                while not over.wait(pause):
                    for path in ("/alive", "/"):
                        self._timed("requests", lambda path=path: self.target.get(path))  # type: ignore[misc]
                    for command, values in (("folder.list", {}), ("points.get", {"layer": "Lattice"})):
                        number = len(self.asked["frames"]) + 1
                        data = Frame({"id": number, "do": command, "with": values}).encode()
                        self._timed("frames", lambda data=data, number=number: _ask(link, data, number))  # type: ignore[misc]

    def _timed(self, kind: str, work: Callable[[], object]) -> None:
        begin = time.perf_counter()
        try:
            work()
        finally:  # what failed, or never came, counts with the time that was waited for it
            self.asked[kind].append(1e3 * (time.perf_counter() - begin))

    def percentile(self, kind: str, share: float) -> float:
        """A percentile of the milliseconds."""
        return float(np.percentile(self.asked[kind] or [0.0], share))


def calm(target: Studio, seconds: float) -> Honest:
    """How fast the studio answers while nobody attacks."""
    honest, over = Honest(target), threading.Event()
    thread = threading.Timer(seconds, over.set)
    thread.start()
    honest.ask_until(over)
    return honest


def attack(target: Studio, count: int, seed: int, attackers: int = 2) -> tuple[Honest, list[Tally]]:
    """Let attackers loose, and an honest page ask meanwhile."""
    context, tallies, honest, over = get_context("spawn"), list[Tally](), Honest(target), threading.Event()
    thread = threading.Thread(target=honest.ask_until, args=(over,))
    thread.start()
    plain = Studio(target.folder, None, target.port, target.token, target.cookie)  # type: ignore[arg-type]
    links = []
    for number in range(attackers):
        for way in (knock, rave):
            ours, theirs = context.Pipe()
            arguments = (way, plain, -(-count // (2 * attackers)), seed + number, theirs)
            process = context.Process(target=_attacker, args=arguments, daemon=True)
            process.start()
            theirs.close()
            links.append((ours, process))
    for ours, process in links:
        tallies.append(ours.recv())
        process.join()
    over.set()
    thread.join()
    return honest, tallies


def figures(count: int, seed: int = 0) -> dict[str, Any]:
    """Attack a studio, and tell what came of it."""
    with studio() as target:
        quiet, before = calm(target, 5.0), target.memory()
        canary = Canary(target.folder / "secret")
        begin = time.monotonic()
        honest, tallies = attack(target, count, seed)
        seconds, touched = time.monotonic() - begin, canary.touched()
        canary.close()
        alive = target.process.poll() is None and target.get("/alive").status == 204
        code = target.process.poll()
        after, peak = (target.memory(), target.memory("VmHWM")) if alive else (0.0, 0.0)
        complaints = target.complaints()
    sent = sum((tally.sent for tally in tallies), collections.Counter[str]())
    answers = sum((tally.answers for tally in tallies), collections.Counter[str]())
    slow = collections.Counter[str]()
    for tally in tallies:
        for name, worst in tally.slow.items():
            slow[name] = max(slow[name], round(worst, 2))
    bugs = {cause: where for tally in tallies for cause, where in tally.bugs.items()}
    timing = {
        f"honest {kind}: {share} ms, {when}": round(page.percentile(kind, value), 1)
        for kind in ("requests", "frames")
        for when, page in (("calm", quiet), ("attacked", honest))
        for share, value in (("median", 50), ("p99", 99))
    }
    return {"hostile requests": sent["requests"], "hostile frames": sent["frames"], "seconds": round(seconds),
            "opened outside the root": len(touched), "answers with secrets": sum(tally.leaked for tally in tallies),
            "lives": alive, "exit code": code, "MB before": round(before), "MB after": round(after),
            "MB at most": round(peak),
            "honest answers": sum(map(len, honest.asked.values())), **timing, "bugs": [
                {"cause": cause, "frame": where} for cause, where in bugs.items()], "uncaught": [
                {"error": error, "times": times} for error, times in complaints.most_common()],
            "answers": [{"answer": name, "times": times} for name, times in answers.most_common()],
            "slowest commands": [{"command": name, "s": worst} for name, worst in slow.most_common(8)]}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    publish("attack", figures(options.count, options.seed))


if __name__ == "__main__":
    main()
