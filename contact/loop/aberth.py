"""Aberth's iteration for all zeros of S + sum a/(s - p) at once, compiled (Math. Comp. 27, 1973, 339)."""

from __future__ import annotations

from contact.base.arrays import Array
from contact.jit.compiled import jit_entry

AWAY = 1e300  # position of a zero, without contribution, while the others are divided out of its own step


@jit_entry
def first_guess(
    p_re: Array, p_im: Array, a_re: Array, a_im: Array, S: float, s_re: Array, s_im: Array
) -> None:  # fmt: skip
    """First guess of each zero: the zero of S + (sum over the other poles, at this pole) + a/(s - p).

    All p are different.
    """
    for i in range(p_re.size):
        f_re, f_im = S, 0.0
        for part in range(2):  # those before it, those after it
            first, last = (0, i) if part == 0 else (i + 1, p_re.size)
            for j in range(first, last):
                u, v = p_re[i] - p_re[j], p_im[i] - p_im[j]
                q = 1.0 / (u * u + v * v)
                f_re += (a_re[j] * u + a_im[j] * v) * q
                f_im += (a_im[j] * u - a_re[j] * v) * q
        q = 1.0 / (f_re * f_re + f_im * f_im)
        s_re[i] = p_re[i] - (a_re[i] * f_re + a_im[i] * f_im) * q
        s_im[i] = p_im[i] - (a_im[i] * f_re - a_re[i] * f_im) * q


@jit_entry
def aberth(
    p_re: Array, p_im: Array, a_re: Array, a_im: Array, S: float, s_re: Array, s_im: Array, steps: Array,
    most: int, settled: float,
) -> bool:  # fmt: skip
    """Move s (n,) to the zeros, with poles p and residues a (n,); returns whether all steps are below `settled`.

    `steps` (n,) starts above `settled`. A zero whose step is below it is final. Returns False if a step is not finite,
    and after `most` iterations.
    """
    for _ in range(most):
        moving = 0
        for i in range(s_re.size):
            if not steps[i] > settled:
                continue
            moving += 1
            x, y = s_re[i], s_im[i]
            s_re[i] = s_im[i] = AWAY
            f_re, f_im, d_re, d_im, n_re, n_im = S, 0.0, 0.0, 0.0, 0.0, 0.0
            for j in range(p_re.size):
                u, v = x - p_re[j], y - p_im[j]
                q = 1.0 / (u * u + v * v)
                w_re, w_im = u * q, -v * q
                t_re, t_im = a_re[j] * w_re - a_im[j] * w_im, a_re[j] * w_im + a_im[j] * w_re
                f_re += t_re
                f_im += t_im
                d_re += t_re * w_re - t_im * w_im
                d_im += t_re * w_im + t_im * w_re
                u, v = x - s_re[j], y - s_im[j]
                q = 1.0 / (u * u + v * v)
                n_re += w_re - u * q
                n_im += w_im + v * q
            size = f_re * f_re + f_im * f_im
            g_re = n_re - (d_re * f_re + d_im * f_im) / size
            g_im = n_im - (d_im * f_re - d_re * f_im) / size
            size = g_re * g_re + g_im * g_im
            h_re, h_im = g_re / size, -g_im / size
            steps[i] = (h_re * h_re + h_im * h_im) ** 0.5
            s_re[i], s_im[i] = x - h_re, y - h_im
            if not steps[i] < AWAY:
                return False
        if moving == 0:
            return True
    return False
