"""One thread for the many small matrices of adhesive equilibria.

Of matrices of some hundred rows the threads of BLAS wait for one another longer than they work: a way of 87 zones down to where they come
apart takes twice as long with two threads as with one, and four times the processor time.
"""

from typing import Any

from contact.extras import require
from contact.users import WhileUsed


def _begun() -> Any:
    return require("threadpoolctl").threadpool_limits(1, "blas")


# While it lasts in any thread of this process, BLAS has one of its own; as many as before thereafter.
one_of_blas = WhileUsed(_begun, lambda limits: limits.restore_original_limits())
