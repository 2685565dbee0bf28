"""Scenes that the page offers: each has a name, a sentence, and the text of a scene file."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Preset:
    """A scene that the page offers. about: a short description; text: the scene file."""

    about: str
    text: str


_STEEL = """
[material]            # steel on a rigid body
E1 = 210e9
nu1 = 0.3
"""
_RUBBER = """
[material]            # soft rubber on a rigid body
E1 = 3e6
nu1 = 0.5
"""
_PERIODIC = """
[interaction]
model = "periodic"
"""
_ROUGH = """
[profile]             # 24 waves, similar to a ground surface
shape = "fourier"
period = 1e-3
cosine = [{cosine}]
sine = [{sine}]
"""
# Cosine amplitudes [m] of a rough profile. They fall like k^-1.3, and their random phases were
# drawn once.
_COSINE = (
    "0, 1.1e-7, -2.4e-7, 6.2e-8, 9.8e-8, -7.4e-8, 3.3e-8, 5.9e-8, -3.1e-8, 4.4e-8, -1.2e-8,"
    " 2.5e-8, 2.1e-8, -2.6e-8, 7e-9, 1.8e-8, -1.5e-8, 1.1e-8, 1.4e-8, -6e-9, -1.2e-8, 9e-9, 4e-9,"
    " -8e-9"
)
_SINE = (
    "0, 2.2e-7, 5e-8, -1.5e-7, 4.1e-8, 6.6e-8, -7.7e-8, 1.4e-8, 4.9e-8, 1e-8, 3.6e-8, -2.2e-8,"
    " 2e-8, 6e-9, -2.4e-8, 9e-9, 1.1e-8, -1.4e-8, 3e-9, 1.3e-8, -5e-9, -8e-9, 1e-8, 4e-9"
)
_ROUGH = _ROUGH.format(cosine=_COSINE, sine=_SINE)

PRESETS = {
    "wave": Preset(
        "A wavy steel surface, pressed on a rigid flat face",
        f"""
[profile]
shape = "sinusoid"
amplitude = 2e-7
period = 1e-4
{_STEEL}{_PERIODIC}
[control]
mean_pressure = 4e8
""",
    ),
    "wedge": Preset(
        "A row of steel wedges: the pressure at a sharp tip is infinite",
        f"""
[profile]
shape = "wedge"
slope = 0.01
period = 1e-4
{_STEEL}{_PERIODIC}
[control]
mean_pressure = 2.5e8
""",
    ),
    "two tips": Preset(
        "Two tips in each period that share the load",
        f"""
[profile]
shape = "biquadratic"
radius = 1e-3
spacing = 4e-5
period = 1e-4
{_STEEL}{_PERIODIC}
[control]
mean_pressure = 1.2e8
""",
    ),
    "rough": Preset(
        "A rough steel surface: more of it touches as the load grows",
        f"""
{_ROUGH}{_STEEL}{_PERIODIC}
[control]
mean_pressure = 1.2e8
""",
    ),
    "JKR": Preset(
        "A rubber cylinder that adheres: it jumps into contact, and out of it when it is pulled",
        f"""
[profile]
shape = "parabola"
radius = 0.01
{_RUBBER}
[interaction]
model = "isolated"
datum = 1e-3          # at this distance a line load causes no displacement

[law]                 # adhesion of zero range
model = "jkr"
work = 0.05           # [J/m^2]

[control]
approach = 1e-6
""",
    ),
    "Dugdale": Preset(
        "A wavy rubber surface that adheres, with a tension of finite range",
        f"""
[profile]
shape = "sinusoid"
amplitude = 1e-6
period = 1e-4
{_RUBBER}{_PERIODIC}
[law]                 # adhesion of finite range
model = "dugdale"
work = 0.02
stress = 1e5

[control]
approach = 2e-7
""",
    ),
    "layer": Preset(
        "A cylinder on a polymer layer, a twentieth of a millimetre thick",
        """
[profile]             # a cylinder on a thin polymer layer on a rigid base
shape = "parabola"
radius = 0.01

[material]
E1 = 3e9
nu1 = 0.4

[interaction]
model = "isolated"

[substrate]
model = "layer"
thickness = 5e-5
nu = 0.4
base = "bonded"

[control]
load = 2e4
""",
    ),
    "sliding": Preset(
        "A cylinder slides over rubber: friction shifts the contact",
        """
[profile]             # a steel cylinder sliding on rubber
shape = "parabola"
radius = 0.01

[material]
E1 = 5e6
nu1 = 0.35
E2 = 210e9
nu2 = 0.3

[interaction]
model = "isolated"

[law]
model = "sliding"
friction = 0.5

[control]
load = 500.0
""",
    ),
    "plastic": Preset(
        "The rough steel surface: where it yields, the pressure equals the hardness",
        f"""
{_ROUGH}{_STEEL}{_PERIODIC}
[law]                 # the pressure is at most the hardness
model = "plastic"
hardness = 2e9

[control]
mean_pressure = 2e8
""",
    ),
}
