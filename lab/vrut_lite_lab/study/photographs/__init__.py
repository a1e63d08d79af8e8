"""Sky models beside photographs of the sky: `python -m vrut_lite_lab.study.photographs`."""
