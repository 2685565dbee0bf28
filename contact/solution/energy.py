"""The energy of a contact, in parts."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Energy:
    """What pressing has stored, and what closing has released; their changes add up to the work of the load.

    Parameters
    ----------
    elastic : float
        (1/2) int p u dx, u the displacement of which `Solution.approach` is one [J/m], per period where there is one.
    surface : float
        -w times the width in contact, w the law's work of adhesion [J/m]; 0 without adhesion.

    Examples
    --------
    A wave in full contact: pi E* amplitude^2/4 - w period (K. L. Johnson, Int. J. Solids Struct. 32, 1995, 423).

    >>> import contact
    >>> import numpy as np
    >>> wave = contact.Scene(contact.Sinusoid(1e-2, 1.0), 1.0, contact.Periodic(), law=contact.JKR(1e-5), load=1.0)
    >>> energy = contact.solve(wave).energy
    >>> bool(np.isclose(energy.elastic, np.pi * 1e-4 / 4)), energy.surface, bool(energy.total == energy.elastic - 1e-5)
    (True, -1e-05, True)
    """

    elastic: float
    surface: float

    @property
    def total(self) -> float:
        return self.elastic + self.surface
