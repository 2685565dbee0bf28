"""The reason why a solution cannot be pickled: a function that has no name in a module."""

import pickle
import sys

from sie.equation.equation import Equation

# Packages that can also pickle functions without a name, such as lambdas. If one of them is loaded,
# it may be the one that pickles. Then nothing is refused.
ABLE = ("cloudpickle", "dill")


def check(equation: Equation) -> None:
    """Raise PicklingError, with the name of the part, if part of an equation cannot be pickled."""
    if any(name in sys.modules for name in ABLE):
        return
    parts = [
        ("the kernel", equation.kernel),
        ("the right side", equation.forcing),
        *((f"column {k}", column) for k, column in enumerate(equation.columns)),
        *(
            (f"the condition {type(condition).__name__}", condition)
            for condition in (*equation.conditions, *equation.end_conditions)
        ),
    ]
    for name, part in parts:
        try:
            pickle.dumps(part)
        except Exception as error:
            raise pickle.PicklingError(
                f"a sie.Solution is pickled with its equation, but {name} cannot be pickled: "
                f"{error}. Python pickles functions by name: define them by `def` at the top level "
                "of a module, not by lambda or inside a function; or use cloudpickle"
            ) from error
