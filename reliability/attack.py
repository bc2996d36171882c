"""A studio under attack: `python -m reliability.attack --count 20000`.

Half of the attackers have no key and send requests of HTTP; the others have one, as a page gone mad would, and send
frames: commands with values that are nearly right, wrong, or damaged. Beside the studio's folder lies another one, that
Linux watches: nobody may open a file there. Meanwhile an honest page asks again and again, and its answers are timed.
"""

from __future__ import annotations

import argparse
import collections
import contextlib
import itertools
import os
import random
import re
import socket
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

from pliant.studio.serving.frames import Frame, MalformedFrame
from reliability.canary import Canary
from reliability.hostile import asked, frame, request
from reliability.ledger import Ledger, publish
from reliability.siege import MARK, PATIENCE, Studio, studio

_PLACE = re.compile(r"(?:/[^\s/]+)+/")
ROUND = 25  # frames that an attacker sends through one connection
ROUND_OF = 2500  # requests and frames that one studio gets


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
        try:
            answer = Frame.decode(said).head
        except MalformedFrame:  # numbers beyond single precision: the page would refuse them too
            tally.answers["no frame"] += 1
            return
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
    try:
        return Frame.decode(said).head
    except MalformedFrame:  # what the attackers have made of the shape
        return {}


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


def round_of(count: int, seed: int) -> dict[str, Any]:
    """Attack a studio for so long, and tell what came of it."""
    with studio() as target:
        quiet, before = calm(target, 3.0), target.memory()
        canary = Canary(target.folder / "secret")
        begin = time.monotonic()
        honest, tallies = attack(target, count, seed)
        seconds, touched = time.monotonic() - begin, canary.touched()
        canary.close()
        lives = target.process.poll() is None and target.get("/alive").status == 204
        memory = [before, target.memory(), target.memory("VmHWM")] if lives else [before, 0.0, 0.0]
        complaints = target.complaints()
    slow: dict[str, float] = {}
    for tally in tallies:
        slow |= {name: round(max(worst, slow.get(name, 0.0)), 2) for name, worst in tally.slow.items()}
    return {
        "sent": sum((tally.sent for tally in tallies), collections.Counter[str]()),
        "answers": sum((tally.answers for tally in tallies), collections.Counter[str]()),
        "seconds": round(seconds), "touched": len(touched), "leaked": sum(tally.leaked for tally in tallies),
        "lives": lives, "memory": [round(each) for each in memory], "slow": slow, "complaints": complaints,
        "bugs": {cause: where for tally in tallies for cause, where in tally.bugs.items()},
        "calm": quiet.asked, "attacked": honest.asked, "load": round(os.getloadavg()[0], 1),
    }  # fmt: skip


def run(count: int, ledger: Ledger, seconds: float) -> None:
    """Attack one studio after another until so much has been sent, or the time is up."""
    end = time.monotonic() + seconds
    rounds = list(ledger)
    sent = sum(sum(entry["sent"].values()) for entry in rounds)
    seed = len(rounds)
    while sent < count and time.monotonic() < end:
        found = round_of(min(ROUND_OF, count - sent), 1000 * seed)
        ledger.add(**found)
        sent += sum(found["sent"].values())
        seed += 1


def summary(ledger: Ledger) -> dict[str, Any]:
    """The figures of all that a ledger holds."""
    rounds = list(ledger)
    sent, answers, complaints = (
        sum((collections.Counter(entry[name]) for entry in rounds), collections.Counter[str]())
        for name in ("sent", "answers", "complaints")
    )
    timing = {}
    for when, kind in itertools.product(("calm", "attacked"), ("requests", "frames")):
        asked = [each for entry in rounds for each in entry[when].get(kind, [])] or [0.0]
        for name, share in (("median", 50), ("p99", 99)):
            timing[f"honest {kind}, {when}: {name} ms"] = round(float(np.percentile(asked, share)), 1)
    slow: dict[str, float] = {}
    for entry in rounds:
        slow |= {name: max(worst, slow.get(name, 0.0)) for name, worst in entry["slow"].items()}
    worst = sorted(slow.items(), key=lambda each: -each[1])[:8]
    bugs = {cause: where for entry in rounds for cause, where in entry["bugs"].items()}
    loads = [entry["load"] for entry in rounds]
    return {"studios": len(rounds), "hostile requests": sent["requests"], "hostile frames": sent["frames"],
            "seconds": sum(entry["seconds"] for entry in rounds), "loads": f"{min(loads)} to {max(loads)}",
            "opened outside the root": sum(entry["touched"] for entry in rounds),
            "answers with secrets": sum(entry["leaked"] for entry in rounds),
            "studios that lived": sum(entry["lives"] for entry in rounds),
            "MB before": min(entry["memory"][0] for entry in rounds),
            "MB at most": max(entry["memory"][2] for entry in rounds),
            "honest answers": sum(len(times) for entry in rounds for times in entry["attacked"].values()), **timing,
            "bugs": [{"cause": _PLACE.sub("", cause)[:120], "frame": where} for cause, where in bugs.items()],
            "uncaught": [
                {"error": _PLACE.sub("", error), "times": times} for error, times in complaints.most_common()],
            "answers": [{"answer": name, "times": times} for name, times in answers.most_common()],
            "slowest commands": [{"command": name, "s": seconds} for name, seconds in worst]}  # fmt: skip


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no round after so long")
    parser.add_argument("--ledger", type=Path, default=Path("attack-ledger.jsonl"))
    options = parser.parse_args()
    ledger = Ledger(options.ledger)
    run(options.count, ledger, options.seconds)
    publish("attack", summary(ledger))


if __name__ == "__main__":
    main()
