"""A process that reads mutants one after another within a share of memory, and says how each one went.

Called by :mod:`reliability.fuzz` as ``python -m reliability.child FOLDER``; takes lines of JSON, each a seed and
a run of numbers, and answers each mutant with a line of JSON. What does not end, or ends this process, the parent sees.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import traceback
from pathlib import Path

from reliability.limits import MEMORY, SECONDS
from reliability.mutate import mutants
from reliability.readers import ACCEPTED, attempt
from reliability.seeds import corpus


def main(folder: str) -> None:
    """Warm up, shut the door to more memory, and read."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # libraries print what they think of a file
    os.dup2(1, 2)
    for name, data in corpus().items():
        found = _outcome(name, data, folder)
        if found["outcome"] != ACCEPTED:
            print(json.dumps({"unsound": name, **found}), file=answers)
    limit = _address_space() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))
    print(json.dumps({"ready": os.getpid()}), file=answers)
    for line in sys.stdin:
        job = json.loads(line)
        seed, others = corpus()[job["name"]], list(corpus().values())
        for number, data in enumerate(mutants(seed, others, job["count"], job["name"], job["start"]), job["start"]):
            found = _outcome(job["name"], data, folder)
            print(json.dumps({"number": number, **found}), file=answers)
            if "leave" in found:  # the most that a process has taken is remembered for ever
                return


def _outcome(name: str, data: bytes, folder: str) -> dict[str, str]:
    begin = _processor_time()
    try:
        outcome = attempt(name, data, Path(folder))
        used = _processor_time() - begin
        if used > SECONDS:
            raise TimeoutError(f"it took {used:.1f} s of the processor")
        if resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss > MEMORY >> 10:
            return {
                "outcome": "broken",
                "kind": "memory: a process that reads for this one took too much",
                "leave": "yes",
            }
        return {"outcome": outcome}
    except BaseException as error:  # also SystemExit, or whatever a library ends with
        where = traceback.extract_tb(error.__traceback__)[-1]
        trace = "".join(traceback.format_exception(error)[-6:])
        kind = f"{type(error).__name__} in {Path(where.filename).name}:{where.name}"
        return {"outcome": "broken", "kind": kind, "trace": trace[-2500:]}


def _processor_time() -> float:
    """Seconds that this process and those that it started have computed."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def _address_space() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    return pages * resource.getpagesize()


if __name__ == "__main__":
    main(sys.argv[1])
