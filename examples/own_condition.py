"""A side condition of your own, brought by an interaction: what surrounds a strip carries a share of its pressure."""

from dataclasses import dataclass

import numpy as np

import contact
import sie


@dataclass(frozen=True)
class Share(sie.Condition):
    """The amplitude of column 0 is a factor times the integral of the density over all zones: one row."""

    factor: float

    def count(self, zones):
        return 1

    def rows(self, system):
        (column, offset), (totals, constants), times = system.amplitude(0), system.totals(), system.multiplicity()
        return column - self.factor * (times @ totals), offset - self.factor * (times @ constants), np.zeros(1)


@contact.register_interaction("surrounded")
@dataclass(frozen=True)
class Surrounded(contact.Interaction):
    """One strip among lower ones, which carry a share of its mean pressure; share 1 is the self-consistent localization."""

    share: float
    needs_period, strip, exact, allows = True, True, False, ("load", "mean_pressure")

    def side_conditions(self, period):
        return (Share(self.share / period),)


def main():
    wave, models = contact.Sinusoid(1e-6, 1e-4), (Surrounded(0.4), Surrounded(1.0), contact.Localized("self-consistent"))
    return [contact.solve(contact.Scene(wave, 1e11, model, mean_pressure=1e9), tol=1e-10) for model in models]
