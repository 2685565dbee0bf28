"""One thread of BLAS for the many small matrices of rough scenes, of adhesive equilibria and of
curves.

Of matrices of some hundred rows the threads of BLAS wait for one another as long as they work, and
where another program takes the cores far longer: a rough trace of 200 zones takes the same time of
the clock with one thread and with two on a quiet machine, and a third of it with one on a busy
machine.
"""

import sys
from functools import cache
from typing import Any

from contact.extras import require
from contact.users import WhileUsed


@cache
def _libraries(scipys: bool) -> Any:
    return require("threadpoolctl").ThreadpoolController()


def _begun() -> Any:
    # numpy and scipy may each bring one of their own; looking for them takes milliseconds.
    return _libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas")


# While it lasts in any thread of this process, BLAS has one of its own; as many as before
# thereafter.
one_of_blas = WhileUsed(_begun, lambda limits: limits.restore_original_limits())
