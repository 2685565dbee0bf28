r"""A context under an adhesive law in, the contact on the branch that it asks for out.

Contact with adhesion has several equilibria under one load. The unknowns are the ends s of
intervals. At every end a residual r(s, value) says how strongly the end is driven outward, and
J = dr/ds how that changes. Everything here works on r and J, whatever the law:

    curve.py             a state: intervals, r, J, load, level; the curve r(s, value) = 0
    gradient_flow.py     from given intervals to an equilibrium, at a held value of the control
    arc_length.py        along the curve, round its turning points
    events.py            what interrupts the curve: birth, merge, split, death, full contact
    pull_off.py          where the last contact is lost
    loading_path.py      up and down the values of a control, through all events

Two laws differ in what the intervals are and what drives their ends. Each is a `Curve` with the
same methods (`at`, `under`, `again`, `settled`, `fields`, `formally`, `vanishes`):

    edge intensity (JKR)      the intervals are the zones of contact; r = K/|K*| + 1
    cohesive zone (Dugdale)   the intervals are where the gap is below the reach of the tension;
                              r = 1 - gap/reach; the contact inside them is frictionless

Files whose names begin with `cohesive` belong to the second law alone.
"""
