"""Polarised light of real air, by optics and transfer that share nothing with the product.

`gases` and `particles` compute the optics anew from publications, with sasktran2's Mie code; `airs`
puts them into the product's conditions (depths, heights, planet). The vector Monte Carlo
(`vrut_lite_lab.monte_carlo`) traces the air, `by_sasktran` solves it with sasktran2. It needs the
laboratory's extra `truth`. The command

    python -m vrut_lite_lab.polarised_truth [--quick] [--shared-optics] [--sasktran] [--out FOLDER]

compares a solved sky with them (`__main__`).
"""
