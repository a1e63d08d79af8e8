"""The precomputation of the daylight thesis (Hvezda 2020, chapter 4), plainly in float64.

Each of its algorithms 2 to 7 has a file; `pipeline` is algorithm 1. Sample counts,
trapezoid rules and look-ups are those of Bruneton's implementation of 2017, with which the results
agree to 1e-6; the printed algorithms' errors are not copied. It is the reference for the shaders
and a comparison for the fast solver: slow, and not exact. In daylight its multiple scattering errs
by up to 11 % at its full sizes.
"""
