"""The arcsine and the arccosine in arithmetic alone, so that loops over them run in vector registers."""

from __future__ import annotations

import math

from .kernel import kernel_relaxed


@kernel_relaxed("contract")
def arc(x: float) -> tuple[float, bool]:
    """For 0 <= x <= 1: arcsin x and False where x <= 1/2, else half of arccos x and True.

    arcsin x = x + x^3 P(x^2) for x <= 1/2, and above arccos x = 2 arcsin sqrt((1 - x)/2). P interpolates at Chebyshev
    nodes, relative error 5e-18.
    """
    far = x > 0.5
    z = 0.5 * (1.0 - x) if far else x * x
    s = math.sqrt(z) if far else x
    p = 0.028757851367421566
    p = p * z - 0.014851887071247204
    p = p * z + 0.01740087944269402
    p = p * z + 0.005457506718640358
    p = p * z + 0.01032281435018578
    p = p * z + 0.011479177415184906
    p = p * z + 0.013971212973552933
    p = p * z + 0.017352392720869973
    p = p * z + 0.02237217294214989
    p = p * z + 0.030381944138531247
    p = p * z + 0.04464285714635543
    p = p * z + 0.07499999999998433
    p = p * z + 0.16666666666666669
    return s + s * z * p, far
