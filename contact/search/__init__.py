"""From a scene to the zones of its contact.

`find` tries strategies in order, `refine` makes the result as precise as wanted. Both rest on
`topology`, `grid` and `strategies`.
"""
