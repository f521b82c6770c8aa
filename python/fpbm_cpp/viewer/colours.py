"""Colours of the page: those of the figures, told apart by colour-blind readers (Okabe and Ito)."""

LINES = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#000000", "#F0E442")
TIP, TARGET = (213, 94, 0), (40, 40, 40)
LINK, JOINT, BASE = (196, 203, 212), (62, 84, 112), (110, 116, 124)
START = (170, 176, 184)
NOW = "#888888"
