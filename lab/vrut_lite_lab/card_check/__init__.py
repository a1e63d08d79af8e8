"""Tries the program on a machine with a graphics card: tests, parity, times and pictures.

Such a machine may reach no network and be ours for minutes only. So everything is prepared here:

    python -m vrut_lite_lab.card_check prepare
    sh .card/run.sh FOLDER
    python -m vrut_lite_lab.card_check page FOLDER

`prepare` fills `.card` in the checkout, which git ignores: wheels of what a machine with PyTorch
lacks, our own two wheels, the loaders of EGL and OpenGL, and `run.sh`. That one is called on the
machine with the card, in the checkout; it does the work in parts, each a process with a limit of
time and results that are written at once, and writes FOLDER/card.md; `page` writes it again.
"""
