"""Batches: one deformation for many files, on all processors or a cluster, and points that no memory holds."""

from pliant.batch.mesh_streaming import box_of as box_of
from pliant.batch.mesh_streaming import stream_mesh as stream_mesh
from pliant.batch.outcome import Outcome as Outcome
from pliant.batch.running import run_batch as run_batch
from pliant.batch.sampling import sample as sample
from pliant.batch.streaming import stream as stream
from pliant.batch.streaming import stream_file as stream_file
