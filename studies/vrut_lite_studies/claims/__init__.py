"""What the two papers claim and the study's page does not show: each measured by itself.

`python -m vrut_lite_studies.claims` prints the numbers that docs/study.md quotes.
"""
