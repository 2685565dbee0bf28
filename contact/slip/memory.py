"""The memory of a contact with friction: a function h of the load, with |h| <= mu.

Under any history of the load P(t) and the tangential load Q(t), the shear is

    q(x) = int_0^P h(P') dp(x; P')/dP' dP',        Q = int_0^P h dP',

where p(x; P') is the pressure under the load P'. h is constant on layers: intervals of the load. A
straight segment of the history changes h in one of two ways (J. Jaeger, J. Appl. Mech. 65, 1998,
255-263; M. Ciavarella, Int. J. Solids Struct. 35, 1998, 2349-2362):

- If P grows and |dQ| <= mu dP, nothing slips, and the layer that is added has h = dQ/dP.
- Otherwise h is set to s mu from the load P down to a load S, until the integral of h is Q again. s
  is the sign of the missing part of Q. The zones of contact under the load S stick. Around them the
  surfaces slip.

While S falls by dS, the surfaces slip outside the zones of S where |q| = mu p(x; P). This slip
dissipates the energy

    dW = mu |s mu - h(S)| [(P - S) C(S) - delta(P) + delta(S)] |dS|,

with the approach delta and the compliance C = d delta / dP. The formula follows from the symmetry
of the work of two contacts on each other's displacements.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

# Two loads count as equal if their relative difference is below this value, a few units in the last
# digit.
SAME_LOAD = 8 * float(np.finfo(float).eps)


class Layer(NamedTuple):
    """An interval of loads P' [N/m] up to `top` in which h(P') is constant.
    It begins at the top of the layer below. The shear is q = int h dp(x; P').
    """

    top: float
    h: float


class SlipStep(NamedTuple):
    """A part of a segment of loading in which slip spreads through one layer of loads.
    In this layer h changes by the absolute value `change`.

    The stick load S falls from `stick[0]` to `stick[1]` while P goes from `load[0]` to `load[1]`,
    in proportion. Loads are in N/m.
    """

    change: float
    stick: tuple[float, float]
    load: tuple[float, float]


@dataclass(frozen=True)
class Segment:
    """A straight segment of the loading history.
    It stores the state at its end, and the steps of slip on the way.

    Parameters
    ----------
    layers : tuple of Layer
        The function h at the end, from the lowest layer to the highest.
    stick : float
        Load whose zones stick at the end [N/m].
    steps : tuple of SlipStep
        The steps of slip in the segment, in order.
    """

    layers: tuple[Layer, ...]
    stick: float
    steps: tuple[SlipStep, ...]


class Memory:
    """The memory of a contact with friction: a function h(P') of the load P', |h| <= mu.
    Each segment of the history (P, Q) of normal and tangential load updates h.

    Parameters
    ----------
    friction : float
        Coefficient of friction mu [1].
    """

    def __init__(self, friction: float) -> None:
        self.friction = friction
        self.layers: list[Layer] = []
        self.tangential_load = 0.0

    @property
    def load(self) -> float:
        """The present normal load P [N/m]."""
        return self.layers[-1].top if self.layers else 0.0

    def go_to(self, load: float, tangential_load: float) -> Segment:
        """Update h by a straight segment of loading, to P = `load` > 0 and Q = `tangential_load`.
        Q must satisfy |Q| <= mu P.
        """
        start, rise = self.load, load - self.load
        turn = tangential_load - self.tangential_load
        self.tangential_load = tangential_load
        if abs(rise) <= SAME_LOAD * load:
            rise = 0.0
        if rise >= 0.0 and abs(turn) <= self.friction * rise * (1.0 + SAME_LOAD):
            if rise > 0.0:
                self._push(load, max(-self.friction, min(turn / rise, self.friction)))
            return Segment(tuple(self.layers), self.load, ())
        steps: list[SlipStep] = []
        done, stick = 0.0, start
        while done < 1.0:
            done, stick = self._advance(_Path(start, rise, turn, done), steps)
        return Segment(tuple(self.layers), stick, tuple(steps))

    def _push(self, top: float, h: float) -> None:
        """Add a layer (interval of loads with constant h) on top.
        The layer below is absorbed if it has the same h.
        """
        if self.layers and self.layers[-1].h == h:
            self.layers.pop()
        self.layers.append(Layer(top, h))

    def _advance(self, path: "_Path", steps: list[SlipStep]) -> tuple[float, float]:
        """Follow the segment until S or P leaves a layer, P meets S, or the segment ends.
        S is the load whose zones still stick, P the load.

        Returns the part of the path that is done, and the load S whose zones stick.
        """
        mu, top = self.friction, self.layers[-1]
        missing = path.turn - top.h * path.rise if path.rise < 0.0 else path.turn
        if abs(missing) <= SAME_LOAD * (abs(path.turn) + mu * abs(path.rise)):
            return self._cut(path)
        sign = math.copysign(1.0, missing)
        is_written = top.h == sign * mu
        if is_written:
            self.layers.pop()
            if not self.layers:  # the whole contact slides
                self.layers.append(Layer(path.load_at(1.0), top.h))
                return 1.0, 0.0
        under = self.layers.pop()
        stick, bottom = under.top, self.load
        # The load S, whose zones stick, falls through the layer `under`, where h = `under.h`. With
        # s = `sign`, s dQ = mu dP - (mu - s h) dS. `falls` is the rate at which S falls along the
        # segment.
        change = mu - sign * under.h
        falls = (sign * path.turn - mu * path.rise) / change
        closing = -(path.rise + falls)  # rate at which P comes down to S
        load = path.load_at(path.done)
        to_bottom = (stick - bottom) / falls
        to_meet = (load - stick) / closing if is_written and closing > 0.0 else math.inf
        part = min(to_bottom, to_meet, 1.0 - path.done)
        if to_bottom - part <= SAME_LOAD * load / falls:
            part = to_bottom  # what would be left of the layer is round-off
        done = min(path.done + part, 1.0)
        if 1.0 - done <= SAME_LOAD:
            done = 1.0
        end_load = path.load_at(done)
        end_stick = bottom if part == to_bottom else max(stick - part * falls, bottom)
        if part == to_meet:
            end_stick = end_load
        steps.append(SlipStep(change, (stick, end_stick), (load, end_load)))
        if end_stick > bottom:
            self._push(end_stick, under.h)
        if end_load > end_stick:
            self._push(end_load, sign * mu)
        return done, end_stick

    def _cut(self, path: "_Path") -> tuple[float, float]:
        """Follow the segment while the load P falls and nothing slips.
        At most the top layer (interval of loads with constant h) is cut off.
        """
        h = self.layers.pop().h
        reached = min(1.0, (self.load - path.start) / path.rise)
        load = path.load_at(reached)
        if reached == 1.0 and load > self.load:
            self._push(load, h)
        return reached, load


class _Path(NamedTuple):
    """A straight segment of loading from P = `start`: the load P changes by `rise`, Q by `turn`.
    Q is the tangential load.

    done: the fraction of the segment that is already followed.
    """

    start: float
    rise: float
    turn: float
    done: float

    def load_at(self, part: float) -> float:
        """The normal load P [N/m] at the fraction `part` (0 to 1) of a segment of loading."""
        return self.start + part * self.rise
