r"""A scene under an adhesive law in, the contact on the branch that is asked for out.

Contact with adhesion has several equilibria under one load. The unknowns are the ends s of
intervals. The residual r(s, value) of an end says how strongly it is driven outward under a value
of the control, and J = dr/ds how that changes.

    curve.py             `State`: intervals, r, J, load, level; `Curve`: the states of a problem
    gradient_flow.py     from given intervals to an equilibrium, at a held value of the control
    energy_descent.py    the same where ends may drive each other back
    nucleation.py        zones that begin at first touch, or by overlap
    arc_length.py        along r(s, value) = 0, round turning points
    events.py            `Events`: what interrupts a curve
    loading_path.py      up and down the values of a control, through all events
    pull_off.py          where the last contact is lost
    full_contact.py      early test for contacts that close altogether
    branch.py            entry for one solution; path_start.py: entry for a path

Two laws differ in what the intervals are and what drives their ends:

    edge intensity (JKR)      `Curve`: the intervals are the zones of contact, r = 1 - K/K*
    cohesive zone (Dugdale)   `CohesiveCurve`: the intervals are where the gap is below the reach,
                              r = 1 - gap/reach; the contact inside them is frictionless

The arc-length follower, the loading path and the pull-off work on a `Curve` and its `Events` and do
not ask which law it is. Files that begin with `cohesive_` override what differs: the intervals
change (cohesive_flow.py), zones inside them change smoothly (cohesive_events.py), the last zone may
shrink to a point (cohesive_pull_off.py). The tension itself is in uniform_tension.py and the
deformed surface under it in deformed_profile.py.
"""
