"""What the product is checked against; nothing of the product needs it.

`pipeline` and `gpu_pipeline` are the published precomputation, on CPU and GPU; `monte_carlo` is a
path tracer, the truth for multiple scattering; `classical_rules` and `gpu_single_scattering`
integrate light scattered once by textbook rules and as a shader. The product imports it
inside two functions only: for `precompute(backend="gpu")`, and for the classical rules of
`single_scattering`.
"""
