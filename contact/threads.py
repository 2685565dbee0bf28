"""One thread for the many small matrices of adhesive equilibria and of curves.

Of matrices of some hundred rows the threads of BLAS wait for one another longer than they work: a way of 87 zones down to where they come
apart takes twice as long with two threads as with one, and four times the processor time.
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


# While it lasts in any thread of this process, BLAS has one of its own; as many as before thereafter.
one_of_blas = WhileUsed(_begun, lambda limits: limits.restore_original_limits())
