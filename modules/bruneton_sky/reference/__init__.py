"""The references of the product's tests; the product does not need them.

`pipeline` and `gpu_pipeline` are the published precomputation, on CPU and GPU; `monte_carlo` is a
path tracer, the reference for multiple scattering; `classical_rules` and `gpu_single_scattering`
integrate light scattered once by textbook rules and as a shader. The product imports it
inside two functions only: for `precompute(backend="gpu")`, and for the classical rules of
`single_scattering`.
"""
