"""`Decision`: one choice between methods, with the number on which it was based."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Decision:
    """One choice between methods, with the reason for the choice.

    Parameters
    ----------
    way : str
        The chosen method, such as "gaps", "a grid" or "full contact".
    because : str
        The reason. `{}` stands for the measured number: "contact is {} of the period".
    measured : float or None
        The number that decided, in the units that `because` names.
    threshold : float or None
        The number that `measured` was compared with.
    """

    way: str
    because: str
    measured: float | None = None
    threshold: float | None = None

    @property
    def reason(self) -> str:
        """The reason with its numbers, as in "contact is 0.81 of the period, above 0.7"."""
        if self.measured is None:
            return self.because
        reason = self.because.replace("{}", f"{self.measured:.3g}")
        if self.threshold is None:
            return reason
        if self.measured == self.threshold:
            return f"{reason}, equal to {self.threshold:.3g}"
        side = "above" if self.measured > self.threshold else "below"
        return f"{reason}, {side} {self.threshold:.3g}"

    def __str__(self) -> str:
        return f"{self.way}, since {self.reason}"
