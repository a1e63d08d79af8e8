"""The laboratory: truths, measurements, fits and pictures that the product is made and judged by.

`study` compares sky models with each other and with measurements (`vrut-lite study`), `bench`
measures run times (`vrut-lite bench`). The truths: `monte_carlo` and `air_exact` of the air,
`cloud_monte_carlo` of clouds, `path_traced` and `radiance` of scenes. The makers: of data
(`bruneton_truth`, `twilight_fit`, `colour_fit`, `extract_*`), of scenes (`scenes`,
`scene_samples`) and of the documentation's pictures (`pictures`). The product imports none of it.
"""
