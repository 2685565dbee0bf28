"""Compiled loops over numbers and arrays, for large sums; they import nothing else of the package.

In go arrays of floats and integers; the results are added to arrays that the caller has made.
`sie.basis.compiled` loads a file of this folder when a sum is so large that this pays.
"""
