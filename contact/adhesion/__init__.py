r"""Adhesive contact: finds the contact of a scene with an adhesive law, on one of two branches.

Contact with adhesion has several equilibria under one load. The branch, advancing or receding,
selects one of them. The unknowns are the ends s of intervals. The residual r(s, value) of an end
says how strongly it is driven outward under a value of the control. J = dr/ds is the Jacobian.

    curve.py             `State`: intervals, r, J, load, level (minus the approach);
                         `Curve`: the states of a problem
    gradient_flow.py     from given intervals to an equilibrium, at a fixed value of the control
    energy_descent.py    from intervals to an equilibrium where ends may drive each other back
    nucleation.py        zones that begin at first touch, or by overlap
    arc_length.py        follows the curve r(s, value) = 0 round turning points
    events.py            `Events`: jumps and other events that interrupt a curve
    loading_path.py      follows the contact as a control rises and falls, through all events
    pull_off.py          finds where the last contact is lost
    full_contact.py      early test for contacts that close altogether
    branch.py            entry for one solution; path_start.py: entry for a path
    options.py           options that several of these files share

Two kinds of law differ in the meaning of the intervals and in the residual of their ends:

    edge intensity (JKR)      `Curve`: the intervals are the zones of contact; r = 1 - K/K*, with
                              the edge intensity K of the pressure and the law's intensity K*
    cohesive zone (Dugdale)   `CohesiveCurve`: the intervals are where the gap is below the reach
                              of the tension; r = 1 - gap/reach; the contact inside the intervals
                              is frictionless

The arc-length follower and the loading path work on a `Curve` and its `Events` and do not depend on
the law. Files that begin with `cohesive_` hold what differs: a loop of the gradient flow in which
intervals begin, merge and are cut (cohesive_flow.py); events at which zones inside the intervals
change smoothly (cohesive_events.py, derived from `Events`); and a pull-off at which the last zone
may shrink to a point (cohesive_pull_off.py, which uses pull_off.py). The tension itself is in
uniform_tension.py, and the surface that it deforms in deformed_profile.py.
"""
