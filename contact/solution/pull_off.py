"""Where a contact comes apart as its control falls."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact.errors import SceneError
from contact.formulation.controls import scaled_control
from contact.formulation.equilibria import kind_of
from contact.formulation.fields import ZoneFields
from contact.model.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PullOff:
    """The last equilibrium before the surfaces come apart altogether, as the control falls: load [N/m] (per period where there is one),
    approach [m] (None without), zones [m] there."""

    load: float
    approach: float | None
    zones: Array = field(repr=False)


def pull_off(scene: Scene, fields: ZoneFields) -> PullOff:
    """From the fields of an equilibrium."""
    if scene.law.bare is None or scene.half_width is not None:
        what = f"the law {scene.law.name}" if scene.law.bare is None else "a given half width"
        raise SceneError(f"there is no pull-off under {what}: it is that of adhesion under a load or an approach", "pull_off")
    problem = fields.problem
    last = fields.pull_off(kind_of(scaled_control(scene, problem.units)))
    units = problem.units
    approach = -last.level * units.height if problem.operator.has_approach else None
    return PullOff(float(last.load * units.load), None if approach is None else float(approach), np.asarray(units.x(last.contact)))
