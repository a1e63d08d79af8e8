"""Methods of Bruneton and others as published: tables and textbook rules.

`precompute` makes the tables; `pipeline` and `gpu_pipeline` are the published precomputation, on
CPU and GPU. `single_scattering` integrates light scattered once by Gauss-Legendre's rule or by
`classical_rules`, `gpu_single_scattering` does so in a shader.
"""
