"""Contact under a limit of the pressure: from a scene to the solved zones.

spots    contacts and plateaus as tables, and as zones of `sie` with the values at their ends
grid     the first spots, from a grid with 0 <= p <= H
fields   the fields, whose zones contain their plateaus
check    the certificate: signs on elastic intervals, plateaus and gaps
loop     Newton on the ends, check, correction of the spots
widths   the load of a given contact fraction or half width
search   all of these steps, in order
"""
