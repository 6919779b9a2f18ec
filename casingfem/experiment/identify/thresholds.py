"""Constants of the identification, in one value."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Thresholds:
    """Constants of the identification; none is adjusted to a set of data.

    Parameters
    ----------
    prominence_db, above_noise_db
        A peak of the mode indicator that a person can see is 6 dB above its surroundings (half-power bandwidths are
        read at 3 dB) and 20 dB above the noise of a line. Every such peak has a mode.
    peaks_a_band, order_a_peak, order_extra, order_most
        The p-LSCF estimator fits bands of at most 8 peaks with orders up to 3 a peak (a pair and a computational pole)
        plus 10 for modes outside; beyond 40 the powers of z lose their digits.
    recurs
        A pole is a candidate when it recurs in this share of the orders: a computational pole changes with the order.
    same_freq, same_zeta
        A pole recurs when its frequency agrees within a quarter of the half-power bandwidth and its damping within 30
        %: twice the scatter over orders that 20 dB of signal over noise leaves.
    zeta_most
        Poles above this damping ratio are residuals of other bands, or several modes: no candidates, and doubtful.
    reach, reach_lines
        A window has this many half-power bandwidths, and at least this many lines, on each side of its modes: the
        skirts then determine the residual terms.
    overlap, overlap_lines
        Modes are fitted together when they are closer than this many bandwidths or lines: their estimates correlate.
    together
        Most modes of one fit.
    terms, terms_most
        Polynomial terms for the modes outside a window: constant, slope, curvature, and more where the residual asks
        for them; beyond 8 a term follows the skirts of the modes inside.
    chance
        Probability at which noise alone adds a pole: 1e-6 for some 1e4 places in a test where it could.
    much_left
        Variance of the residual about a pole, in that of the noise, from which two poles are tried where one is not
        justified: 15 dB, more than coloured noise gives.
    known_freq, known_zeta
        Largest standard deviations, of the frequency in bandwidths and of ln zeta, of a pole without a visible peak:
        twice those of a sure mode.
    floor
        A modal model is not better than this part of a window's rms: gains of sensors are not linear beyond 70 dB.
    same_shape
        Modal assurance criterion above which two poles within `near` bandwidths are one mode seen twice.
    near
        Bandwidths within which two poles must differ in shape.
    misfit
        Part of a peak that no model explains: measured resonances leave 1 to 5 % of their peak.
    inexact
        Sum of squares, over that of the noise, above which a fit shows an error of its model; noise alone stays below.
    sure_freq
        Largest standard deviation of the frequency of a sure mode, in bandwidths; that of ln zeta is `known_zeta`, for
        damping ratios of repeated tests scatter by as much.
    above_zero
        Standard deviations by which a damping ratio must be above zero.
    sure_peak
        Least ratio of the peak to what the fit leaves there: 10 dB.
    in_phase
        Least share of a sure mode's energy in phase: below it the residues of an isolated mode are not a shape.
    narrow
        Bandwidth in lines below which damping cannot be estimated.
    local
        Share of the channels below which a mode is local; of 8 channels, one is more.
    ended
        Ringing left when the record ends (of its start) from which it is reported.
    """

    prominence_db: float = 6.0
    above_noise_db: float = 20.0
    peaks_a_band: int = 8
    order_a_peak: int = 3
    order_extra: int = 10
    order_most: int = 40
    recurs: float = 0.35
    same_freq: float = 0.25
    same_zeta: float = 0.3
    zeta_most: float = 0.1
    reach: float = 5.0
    reach_lines: int = 12
    overlap: float = 3.0
    overlap_lines: int = 4
    together: int = 10
    terms: int = 3
    terms_most: int = 8
    chance: float = 1e-6
    much_left: float = 30.0
    known_freq: float = 0.2
    known_zeta: float = 0.2
    floor: float = 3e-4
    same_shape: float = 0.9
    near: float = 1.0
    misfit: float = 0.03
    inexact: float = 2.0
    sure_freq: float = 0.1
    above_zero: float = 2.0
    sure_peak: float = 3.0
    in_phase: float = 0.6
    narrow: float = 0.5
    local: float = 0.12
    ended: float = 0.2


USUAL = Thresholds()
