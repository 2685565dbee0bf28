"""What is asked: kernel, right side with its jumps, columns of unknown amplitude, and side
conditions, checked once.
"""
