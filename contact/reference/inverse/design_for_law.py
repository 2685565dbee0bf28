"""`design`: the exact contact of given zones under any law that has an inverse design."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from contact.errors import SceneError
from contact.model.laws import JKR, Dugdale, Frictionless, Law
from contact.reference.inverse.adhesive import AdhesiveDesign
from contact.reference.inverse.cohesive import CohesiveDesign
from contact.reference.inverse.designed import DesignedContact


def design(
    zones: ArrayLike,
    E_star: float,
    load: float,
    period: float | None = None,
    law: Law | None = None,
    cohesive: ArrayLike | None = None,
) -> Any:
    """The exact contact with given zones and load under a contact law, as an inverse design.
    The profile of the body follows from the zones.

    Parameters
    ----------
    zones : array_like, (n, 2)
        Ends of the zones [m], ascending; within one period if there is one.
    E_star : float
        Reduced modulus [Pa].
    load : float
        P of all zones per unit thickness, per period if there is one [N/m]; positive without
        adhesion.
    period : float or None
        Period L [m]; None: the body is isolated.
    law : Law or None
        `contact.JKR`, `contact.Dugdale`, or `contact.Frictionless` (None).
    cohesive : array_like, (m, 2), or None
        Ends of the cohesive intervals [m] under `contact.Dugdale`, each around one zone or more;
        the body is isolated.

    Returns
    -------
    DesignedContact, AdhesiveDesign or CohesiveDesign
        With its `profile`, to be given to `contact.Scene`.

    Raises
    ------
    SceneError
        If a number is not positive and finite, the zones are not strictly ascending and within one
        period, or the law has no inverse design.

    Examples
    --------
    The solver finds the zones that were asked for.

    >>> import contact
    >>> import numpy as np
    >>> from contact.inverse import design
    >>> zones = [[-2.0, -1.0], [0.5, 3.0]]
    >>> made = design(zones, E_star=1.0, load=0.1)
    >>> found = contact.solve(contact.Scene(made.profile, 1.0, contact.Isolated(), load=0.1))
    >>> bool(np.allclose(found.zones, zones, atol=1e-7))
    True

    Under JKR adhesion p sqrt(d) tends to -sqrt(E* w/pi) at every end.

    >>> made = design(zones, E_star=1.0, load=0.1, law=contact.JKR(1e-4))
    >>> p = made.pressure_at(1 - 1e-9, 1) * np.sqrt(1.25e-9)
    >>> bool(np.isclose(p, -made.intensity, rtol=1e-4))
    True
    """
    zones = np.asarray(zones)
    if cohesive is not None and not isinstance(law, Dugdale):
        raise SceneError.of(
            "cohesive", cohesive, "left out, as only Dugdale's law has cohesive intervals"
        )
    if law is None or isinstance(law, Frictionless):
        return DesignedContact(zones, E_star, load, period)
    if isinstance(law, JKR):
        return AdhesiveDesign(zones, E_star, load, law.work, period)
    if not isinstance(law, Dugdale):
        raise SceneError.of("law", law, "Frictionless, JKR or Dugdale")
    if cohesive is None or period is not None:
        raise SceneError.of(
            "cohesive",
            cohesive,
            "a table of intervals around the zones, and `period` must be left out: a design for "
            "Dugdale's law is that of an isolated body",
        )
    rise = law.stress / E_star
    return CohesiveDesign(
        zones, np.asarray(cohesive), E_star, law.work, law.stress, rise, given_load=load
    )
