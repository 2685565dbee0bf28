"""From a scene to the zones of its contact.

`find` tries strategies in order, `refine` solves the result to the wanted error. Both use
`topology`, `grid` and `strategies`.
"""
