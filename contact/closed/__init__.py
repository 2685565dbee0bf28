"""One symmetric zone in closed form: in, a symmetric profile and loads; out, its Solution."""
