"""The kernel for products of tensor-product polynomials in Bernstein form: the determinant of three columns.

A coefficient times its binomial coefficient is "scaled"; scaled coefficients multiply by plain convolution. All
polynomials stand in the strides of the result (Kronecker's substitution), so that a convolution in three dimensions
is one in one dimension: sums of shifted rows.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@inlined
def _add_product(sums, terms, offsets, row, sign):
    """sums += sign * terms * row, as polynomials."""
    for n in range(len(terms)):
        factor, at = sign * terms[n], offsets[n]
        for m in range(len(row)):
            sums[at + m] += factor * row[m]


@kernel
def determinants(start, stop, first, second, third, offsets_first, offsets_third, scale, out):
    """out (k, p) = det(first, second, third) in cells [start, stop).

    ``first`` and ``third`` (k, 3, n) are scaled coefficients, which belong at ``offsets_...`` in the result;
    ``second`` (k, 3, m) the same, in place already; ``scale`` (p,) turns scaled coefficients of the result into
    plain ones.
    """
    length = offsets_third[-1] + second.shape[2]
    cross, sums = np.empty(length), np.empty(len(scale))
    for cell in range(start, stop):
        sums[:] = 0.0
        for c in range(3):
            d, e = (c + 1) % 3, (c + 2) % 3
            cross[:] = 0.0
            _add_product(cross, third[cell, e], offsets_third, second[cell, d], 1.0)
            _add_product(cross, third[cell, d], offsets_third, second[cell, e], -1.0)
            _add_product(sums, first[cell, c], offsets_first, cross, 1.0)
        for n in range(len(scale)):
            out[cell, n] = sums[n] * scale[n]
