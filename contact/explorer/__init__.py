"""A page with sliders for a scene, served to this machine only.

The input is a scene. The output is a page with both bodies, the pressure, the stress below the
surface, the load curve, numbers and the scene file. The page itself is plain HTML, CSS and
JavaScript in `web/`.
"""
