"""The 1974 computation: one original routine a file, the original's names in lower case.

`vopd.py` is the main program, and is read first. Letters of cards are those of the listing in
Appendix B of the report: A is the main program, B is TGTCAM, C is ALPBET. MATINV and FTLUP are
described in the report's Appendices C and D, and not listed. The listing as repaired, with all card
numbers, is tools/oracle/vopd.f. docs/names.md is the one table of names: every name of the listing
with the one here, and by itself what yaw, pitch and roll are called from step to step.
"""
