"""Eight doubles at a time: a vector type for numba kernels.

Numba leaves straight-line code over a few values scalar. ``Lanes`` is an LLVM vector of eight doubles that kernels
add and multiply like numbers; a float operand is spread over all lanes, and a product that is added becomes one
fused multiply-add. Where the processor has AVX-512 a value is one register, elsewhere LLVM splits it.

What kernels need of it is handed on here; angles, logarithms and the like are in
:mod:`pliant.numerics.compute.lane_functions`.
"""

from __future__ import annotations

from pliant.numerics.compute.lane_arithmetic import affine as affine
from pliant.numerics.compute.lane_arithmetic import clamp as clamp
from pliant.numerics.compute.lane_arithmetic import cubic as cubic
from pliant.numerics.compute.lane_arithmetic import fused as fused
from pliant.numerics.compute.lane_arithmetic import root as root
from pliant.numerics.compute.lane_arithmetic import spread as spread
from pliant.numerics.compute.lane_arithmetic import spread_halves as spread_halves
from pliant.numerics.compute.lane_arithmetic import total as total
from pliant.numerics.compute.lane_arithmetic import weighted as weighted
from pliant.numerics.compute.lane_arithmetic import where_between as where_between
from pliant.numerics.compute.lane_arithmetic import whole as whole
from pliant.numerics.compute.lane_memory import add_triple as add_triple
from pliant.numerics.compute.lane_memory import clear as clear
from pliant.numerics.compute.lane_memory import get as get
from pliant.numerics.compute.lane_memory import load as load
from pliant.numerics.compute.lane_memory import load_triples as load_triples
from pliant.numerics.compute.lane_memory import put as put
from pliant.numerics.compute.lane_memory import store as store
from pliant.numerics.compute.lane_memory import store_sum_of_halves as store_sum_of_halves
from pliant.numerics.compute.lane_memory import store_triples as store_triples
from pliant.numerics.compute.lane_type import WIDTH as WIDTH
from pliant.numerics.compute.lane_type import Lanes as Lanes
from pliant.numerics.compute.lane_type import lanes as lanes
