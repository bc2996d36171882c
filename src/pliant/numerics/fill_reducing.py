"""The order in which unknowns are eliminated decides how much a sparse factor fills up."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

Order = NDArray[np.int64]

_SMALL = 200  # unknowns: below, nested dissection gains nothing


def nested_dissection(matrix: Any) -> Order | None:
    """(n,) an elimination order from METIS: new place → unknown; None where METIS is missing, or not worth its time.

    Parameters
    ----------
    matrix
        (n, n) sparse, of symmetric pattern: the very one that will be factored.
    """
    if matrix.shape[0] < _SMALL:
        return None
    try:
        import pymetis
    except ImportError:
        return None
    graph = csr_array(matrix)
    rows = np.repeat(np.arange(graph.shape[0]), np.diff(graph.indptr))
    off = rows != graph.indices
    starts = np.concatenate([[0], np.cumsum(np.bincount(rows[off], minlength=graph.shape[0]))])
    adjacency = pymetis.CSRAdjacency(starts.astype(np.int32), graph.indices[off].astype(np.int32))
    return np.asarray(pymetis.nested_dissection(adjacency)[0], np.int64)
