"""What others have published about the time of a Hosek-Wilkie cube map."""

# Table 5.1 of the daylight thesis (Hvezda 2020): milliseconds by size, on an i7-8750H and a
# GTX 1060.
THESIS_MS = {
    "thesis, CPU": {256: 108.5, 512: 383.65, 1024: 1564.39, 2048: 6360.62, 4096: 26079.375},
    "thesis, GPU": {256: 1.74, 512: 3.07, 1024: 6.96, 2048: 6.01, 4096: 9.65},
}
