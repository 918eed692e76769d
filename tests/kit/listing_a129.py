"""Cards A 129 to A 161 of the listing, statement by statement; GO TO is the loop's next label.

Not written from `vopd.program.ignored`: this is what that module is held to.
"""

from __future__ import annotations

from collections.abc import Sequence


def mark(numbers: Sequence[int]) -> list[int]:
    """A 74 to A 76 and A 80 to A 81: what is below one becomes 101."""
    return [101 if number < 1 else number for number in numbers]


def drop(ifram: int, ifm: Sequence[int], jout: Sequence[Sequence[int]]) -> bool:
    """A 129 to A 137: whether the frame ends with FORMAT 88."""
    nout = len(ifm)
    if nout < 1:
        return False  # GO TO 25
    for i in range(nout):  # DO 24
        if ifram != ifm[i]:
            continue  # GO TO 24
        return mark(jout[i])[0] == 100  # if not GO TO 25; if so WRITE (6,88), GO TO 21
    return False


def taken(
    ifram: int,
    itgts: Sequence[int],
    ifm: Sequence[int],
    jout: Sequence[Sequence[int]],
    iout: Sequence[int],
) -> list[bool]:
    """A 138 to A 161: for each landmark read, whether it reaches label 30."""
    nj, nk, nout, nt = len(itgts), 0, len(ifm), len(iout)
    reached: list[bool] = []
    for itgt in itgts:  # DO 31
        label, i, m = (28 if nout < 1 else 270), 0, 0
        while label != 31:
            if label == 270:  # head of DO 27
                if i == nout:
                    label = 28
                elif ifram != ifm[i]:
                    label = 27
                else:
                    label, m = 260, 0
            elif label == 260:  # head of DO 26
                if m == 6:
                    label = 27
                elif itgt != mark(jout[i])[m]:
                    m += 1
                else:
                    nk += 1
                    label = 28 if nj - nk < 2 else 90
            elif label == 27:
                i += 1
                label = 270
            elif label == 28:
                label, i = 290, 0
            elif label == 290:  # head of DO 29
                if i == nt:
                    label = 30
                elif mark(iout)[i] != itgt:
                    i += 1
                else:
                    nk += 1
                    label = 30 if nj - nk < 2 else 90
            else:  # 90 is WRITE (6,90), 30 takes the landmark in
                reached.append(label == 30)
                label = 31
    return reached
