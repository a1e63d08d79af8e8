"""The precomputation of the daylight thesis (Hvezda 2020, chapter 4), plainly in float64.

Each of its algorithms 2 to 7 is a file of its own; `pipeline` is algorithm 1. Sample counts,
trapezoid rules and look-ups are those of Bruneton's implementation of 2017, to which the
results agree in every digit that matters; the printed algorithms' errors are not copied. This
is the twin that shaders are held to, and what the fast solver is compared with: slow, and no
truth. In daylight its multiple scattering errs by up to 11 % at its full sizes.
"""
