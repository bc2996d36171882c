"""What a worker does with a job: read, deform, write; what it has read and bound it remembers by content."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

from pliant.batch.outcome import Job, Outcome, failed
from pliant.batch.parcel import Parcel
from pliant.io.files import read_bytes
from pliant.io.meshes import read_mesh_bytes, write
from pliant.mesh import PolygonMesh
from pliant.numerics.compute.chunks import in_this_thread
from pliant.numerics.compute.one_thread import one_blas_thread
from pliant.scene.cache import Cache
from pliant.scene.stack import Stack
from pliant.scene.stack_binding import StackBinding

_ROOM = 1 << 20
_memory = Cache()


@dataclass
class Known:
    """A mesh that this worker has read, and the last stack that it has bound to it."""

    mesh: PolygonMesh
    binding: StackBinding | None = None

    def deformed(self, stack: Stack) -> PolygonMesh:
        """The mesh, deformed: only what differs from the last time is bound anew."""
        mesh = self.mesh
        known = self.binding
        binding = StackBinding(stack, mesh, cache=Cache(self.room)) if known is None else known.updated(stack)
        self.binding = binding  # several threads may be here; each goes on with its own
        points = binding.result
        return mesh.with_points(points, normals=stack._normals(mesh, points))

    @property
    def room(self) -> int:
        """Bytes that its bindings and results may take."""
        return _ROOM + 32 * self.mesh.points.nbytes


def carry_out_here(parcel: Parcel, jobs: Sequence[Job], strict: bool) -> list[Outcome]:
    """Do jobs one after another, on all processors."""
    return [carry_out(parcel, job, strict) for job in jobs]


def carry_out_elsewhere(parcel: Parcel, jobs: Sequence[Job], strict: bool) -> list[Outcome]:
    """Do jobs one after another, on one processor: the others have jobs of their own."""
    with in_this_thread(), one_blas_thread():
        return carry_out_here(parcel, jobs, strict)


def carry_out(parcel: Parcel, job: Job, strict: bool) -> Outcome:
    """Do a job. Whatever goes wrong is its outcome."""
    start = time.perf_counter()
    try:
        plan = parcel.plan()
        known = _known(job)
        stack = plan.stack(known.mesh, job.controls)
        with one_blas_thread():  # jobs are what runs at once; and sums come out alike wherever they are done
            moved = known.deformed(stack)
        report = write(moved, job.output, strict=strict)
    except Exception as error:  # one bad mesh is a failed outcome, whatever is bad about it
        return failed(job, error, time.perf_counter() - start)
    count, seconds = len(known.mesh.points), time.perf_counter() - start
    return Outcome(job.index, job.input, job.output, "ok", losses=tuple(report.losses), points=count, seconds=seconds)


def _known(job: Job) -> Known:
    """The mesh of a job; files of equal bytes are read once, if textures would be found in the same folder."""
    data = read_bytes(job.input)
    key = data, str(job.input.parent), tuple(job.input.suffixes)
    known: Known | None = _memory.get(key)
    if known is None:
        known = Known(read_mesh_bytes(data, job.input, folder=job.input.parent))
        _memory.put(key, known, len(data) + known.room)
    return known
