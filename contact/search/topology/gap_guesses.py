"""First guesses of the gaps in nearly full contact: where full contact would be in tension."""

from functools import cached_property

import numpy as np

from contact.formulation.relief import ScaledRelief
from contact.formulation.roots import maximum
from contact.formulation.tables import runs_of
from contact.formulation.tolerances import TOLERANCES
from contact.search.topology.failure import WrongTopology
from contact.search.topology.intervals import NARROW, united
from sie import Array, Index, Mask, record


@record
class GapGuesses:
    """First guesses of the gaps, which lie where full contact would need tension.
    There the relief R exceeds the mean pressure.

    R is minus the pressure of full contact, without its mean.
    """

    relief: ScaledRelief

    @property
    def period(self) -> float:
        """The period in scaled variables."""
        return self.relief.period

    @property
    def x(self) -> Array:
        """Scaled places at which the relief R is sampled."""
        return self.relief.samples[0]

    @property
    def value(self) -> Array:
        """Values of the relief R (minus the pressure of full contact, without its mean) at `x`."""
        return self.relief.samples[1]

    @property
    def step(self) -> float:
        """Distance between neighbouring samples of the relief."""
        return self.period / len(self.x)

    def gaps(self, mean: float) -> Array:
        """First guesses (n, 2) of the gaps under a mean pressure.

        They are the runs of samples at which the relief R exceeds the mean pressure, and single
        gaps over kinks. Each run is widened by the factor sqrt(2), which is exact for a single gap
        if R is a parabola.
        """
        valleys = self._over_kinks(mean)
        above = self.value > mean
        if above.all():
            raise WrongTopology(
                "under this mean pressure, full contact would be under tension everywhere", None
            )
        if above.any():
            runs = self._runs(above, mean)
            half = 0.5 * self.period
            apart = np.abs(
                (runs.mean(axis=1)[:, None] - valleys.mean(axis=1) + half) % self.period - half
            )
            over_kink = (apart < 2 * self.step).any(axis=1) & (
                runs[:, 1] - runs[:, 0] < 2 * NARROW * self.step
            )
            return united(
                np.concatenate((self._placed(runs[~over_kink], mean), valleys)),
                self.period,
                True,
                "gap",
            )
        if len(valleys):
            return united(valleys, self.period, True, "gap")
        # No sample of the relief R is above the mean pressure. The only gap lies about the maximum
        # of R, between two samples.
        return self._about(*maximum(self.relief, np.append(self.x, self.x[0] + self.period)), mean)

    def mean_of(self, width: float) -> float:
        """The mean pressure at which the first guess of the gaps leaves this width in contact."""
        finite = self.value[np.isfinite(self.value)]
        low, high = float(finite.min()), float(finite.max())
        while self._open(high) > self.period - width and high < 1e3 * (1 + float(finite.max())):
            high += high - low
        while low < (middle := 0.5 * (low + high)) < high:
            if self._open(middle) > self.period - width:
                low = middle
            else:
                high = middle
        return middle

    def _open(self, mean: float) -> float:
        """Total width of the first guess of the gaps; the period if the gaps fill the period."""
        try:
            table = self.gaps(mean)
        except WrongTopology:
            return self.period
        return float(np.sum(table[:, 1] - table[:, 0]))

    def _about(self, place: float, highest: float, mean: float) -> Array:
        """The gap (1, 2) about a maximum of R; empty if R is flat or below the mean pressure."""
        sides = np.asarray(self.relief(np.array([place - self.step, place + self.step])))
        bend = 2 * highest - float(sides.sum())
        if highest <= mean or not bend > 0:
            return np.zeros((0, 2))
        half = 2 * self.step * np.sqrt((highest - mean) / bend)
        return np.array([[place - half, place + half]])

    def _placed(self, runs: Array, mean: float) -> Array:
        """The gaps `runs` on samples; a gap narrower than `NARROW` samples is replaced.
        Its replacement lies about the nearby maximum of the relief R.
        """
        out = []
        for row in runs:
            if row[1] - row[0] < NARROW * self.step:
                middle = int(round((0.5 * float(row.sum()) - self.x[0]) / self.step)) % len(self.x)
                found = self._about(*self._top(middle), mean)
                row = (
                    found[0]
                    if len(found) and found[0, 1] - found[0, 0] < 2 * NARROW * self.step
                    else row
                )
            out.append(row)
        return np.array(out).reshape(-1, 2)

    def _top(self, sample: int) -> tuple[float, float]:
        """Place and value of the maximum of the relief R near a sample."""
        if sample not in self._tops:
            around = self.x[0] + self.step * (sample + np.arange(-3.0, 4.0))
            self._tops[sample] = maximum(self.relief, around)
        return self._tops[sample]

    @cached_property
    def _tops(self) -> dict[int, tuple[float, float]]:
        return {}

    def _over_kinks(self, mean: float) -> Array:
        """The gaps that are too narrow for the samples, one over each kink in a valley.

        Gaps too narrow to have two different ends in double precision are left out.
        """
        kinks, rest = self._valleys
        at, heights = self.relief.at[kinks], self.relief.heights[kinks]
        half = self.period / np.pi * np.exp(np.pi * np.minimum((mean - rest) / heights, 9.0))
        which = (half < 0.5 * NARROW * self.step) & (half > TOLERANCES.narrowest_gap * self.period)
        return np.column_stack((at - half, at + half))[which]

    @cached_property
    def _valleys(self) -> tuple[Index, Array]:
        """Indices of the kinks in valleys; R at each kink, without the logarithm of this kink."""
        kinks = np.flatnonzero(self.relief.heights < 0)
        return kinks, self.relief.without_own(kinks)

    def _runs(self, above: Mask, mean: float) -> Array:
        """Intervals on which the relief R exceeds the mean pressure, widened by the factor sqrt(2).

        Each run extends from one crossing of the mean pressure to the next.
        """
        shift = int(np.argmin(above))  # start in contact, so that no run crosses the border
        x = np.concatenate((self.x[shift:], self.x[:shift] + self.period))
        highest = 2 * np.abs(self.value[np.isfinite(self.value)]).max(initial=abs(mean))
        above, value = (
            np.roll(above, -shift),
            np.clip(np.roll(self.value, -shift), -highest, highest),
        )
        first, last = np.array(runs_of(above)).T
        # The relief crosses the mean pressure between two samples. The place of the crossing is
        # interpolated.
        before, after = value[first - 1] - mean, value[(last + 1) % len(x)] - mean
        a = x[first] - self.step * (value[first] - mean) / (value[first] - mean - before)
        b = x[last] + self.step * (value[last] - mean) / (value[last] - mean - after)
        middle, half = 0.5 * (a + b), 0.5 * np.sqrt(2) * (b - a)
        return united(np.column_stack((middle - half, middle + half)), self.period, True, "gap")
