"""How a plan reaches the workers: once each, not once a job."""

from __future__ import annotations

import pickle
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from threading import Lock
from uuid import uuid4

from pliant.batch.plans import Plan
from pliant.errors import InvalidParameter, UnreadableFile
from pliant.io.files import read_bytes, write_bytes

_SMALL = 1 << 15  # bytes that travel with each job
_KEPT = 4
_lock = Lock()
_plans: OrderedDict[bytes, Plan] = OrderedDict()


@dataclass(frozen=True)
class Parcel:
    """A plan on its way.

    Parameters
    ----------
    key
        Of this plan in this run.
    data
        The plan itself, where it is small.
    path
        A file that holds it, where it is large; the key is the digest of its bytes.
    """

    key: bytes
    data: bytes = b""
    path: Path | None = None

    def plan(self) -> Plan:
        """The plan, unpacked once a process.

        Raises
        ------
        UnreadableFile
            The file is not the one that was sent.
        """
        with _lock:
            if self.key not in _plans:
                _remember(self.key, pickle.loads(self._bytes()))  # noqa: S301 -- the run's own bytes, by their digest
            return _plans[self.key]

    def _bytes(self) -> bytes:
        data = self.data if self.path is None else read_bytes(self.path)
        if blake2b(data, digest_size=16).digest() != self.key:
            raise UnreadableFile(self.path or "the plan", "it is not what this run has sent", "start the run again")
        return data


@contextmanager
def sent(plan: Plan, folder: Path, *, elsewhere: bool) -> Iterator[Parcel]:
    """A plan, ready for workers in this process, or ``elsewhere``; for them a large one waits in the folder.

    Raises
    ------
    InvalidParameter
        It cannot be sent to other processes.
    """
    if not elsewhere:
        key = uuid4().bytes
        with _lock:
            _remember(key, plan)
        yield Parcel(key)
        return
    try:
        data = pickle.dumps(plan, pickle.HIGHEST_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise InvalidParameter(
            f"the deformation cannot be sent to other processes: {error} (replace what is local to a function, or pass "
            "executor=ThreadPoolExecutor())"
        ) from error
    key = blake2b(data, digest_size=16).digest()
    if len(data) <= _SMALL:
        yield Parcel(key, data)
        return
    path = folder.absolute() / f".{key.hex()}.plan"
    write_bytes(path, data)
    try:
        yield Parcel(key, path=path)
    finally:
        path.unlink(missing_ok=True)


def _remember(key: bytes, plan: Plan) -> None:
    _plans[key] = plan
    while len(_plans) > _KEPT:
        _plans.popitem(last=False)
