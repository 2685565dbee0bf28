"""Compiled loops over numbers and arrays, for large sums; they import nothing else of the package.

The loops take arrays of floats and integers, and write to arrays that the caller has made.
`sie.basis.compiled` loads a file of this folder if a sum is so large that loading saves time.
"""
