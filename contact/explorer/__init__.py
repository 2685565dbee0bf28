"""A page with sliders for a scene, served to this machine only.

What comes in is a scene; what goes out is a page with both bodies, pressure, stress below, load
curve, numbers and the scene file. The page itself is plain HTML, CSS and JavaScript in `web/`.
"""
