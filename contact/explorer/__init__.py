"""A page with sliders for a scene, served to this machine only.

It shows the surfaces, the pressure, the load curve, the stated error and the scene file.
"""
