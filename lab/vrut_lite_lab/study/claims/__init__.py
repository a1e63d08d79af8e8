"""Measurements of those claims of the two papers that the study's page does not show.

`python -m vrut_lite_lab.study.claims` prints the numbers that docs/study.md quotes.
"""
